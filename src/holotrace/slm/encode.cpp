#include "holotrace/slm/encode.h"

#include <algorithm>
#include <cmath>

#include "holotrace/base/error.h"
#include "holotrace/base/threads.h"
#include "holotrace/base/units.h"
#include "holotrace/slm/checks.h"
#include "holotrace/slm/level_table.h"
#include "holotrace/slm/off_axis.h"
#include "holotrace/slm/pixel_kernel.h"

namespace holotrace {
namespace {

const char* name_of(Encoding method) {
  switch (method) {
    case Encoding::phase:
      return "phase";
    case Encoding::amplitude:
      return "amplitude";
    case Encoding::off_axis:
      return "off-axis";
    case Encoding::complex:
      return "complex";
    case Encoding::double_phase:
      return "double-phase";
    case Encoding::error_diffusion:
      return "error-diffusion";
    case Encoding::gerchberg_saxton:
      return "gerchberg-saxton";
    case Encoding::weighted_gerchberg_saxton:
      return "weighted-gerchberg-saxton";
    case Encoding::sgd:
      return "sgd";
    case Encoding::binary:
      return "binary";
  }
  fail("expected an encoding that this version knows, got number {}", int(method));
}

void check_samples(const Field& field) {
  require(field.samples.nx == field.grid.nx && field.samples.ny == field.grid.ny,
          "expected {} × {} samples, as the field's grid says, got {} × {}", field.grid.nx, field.grid.ny,
          field.samples.nx, field.samples.ny);
  for (int j = 0; j < field.grid.ny; ++j)
    for (int i = 0; i < field.grid.nx; ++i) {
      const std::complex<float> u = field.samples(j, i);
      require(std::isfinite(u.real()) && std::isfinite(u.imag()),
              "expected finite samples in the field, got {}{:+}i at row {}, column {}", u.real(), u.imag(), j, i);
    }
}

void check_panel(const Slm& slm, Encoding method, const Observer& observer) {
  const bool encodes_phase = method == Encoding::phase;
  require(
      !encodes_phase || slm.modulation == Modulation::phase,
      "expected an encoding for an amplitude panel, which \"{}\" is, got \"phase\"; use \"amplitude\" or \"off-axis\"",
      slm.name);
  if (!encodes_phase && slm.modulation == Modulation::phase)
    observer.warn(
        fmt::format("the SLM \"{}\" modulates phase and the encoding \"{}\" amplitude: it is shown as if behind a "
                    "crossed polariser that turns phase into amplitude",
                    slm.name, name_of(method)));
}

// What level M would show at this wavelength, in turns.
double phase_range(const Slm& slm, double wavelength, const Observer& observer) {
  const double stretch = slm.design_wavelength > 0 ? slm.design_wavelength / wavelength : 1;
  const double range = stretch * slm.phase_range / (2 * pi);
  observer.fact("phase_range", Fact(2 * pi * range));
  if (range < 1 - 1e-6)
    observer.warn(fmt::format(
        "the SLM \"{}\" reaches a phase of {:.4g}π at {}, short of 2π: phases in the gap take its nearer end, which "
        "leaves {:.3g} % of the light in the image; give the panel a design wavelength of {} or more, now it is {}",
        slm.name, 2 * range, format_length(wavelength), 100 * short_range_efficiency(range), format_length(wavelength),
        format_length(slm.design_wavelength)));
  return range;
}

// The level for each phase of the field by the panel's calibration.
void encode_calibrated(const Field& field, ImageSide image, const LevelTable& table, Hologram& hologram) {
  const double sign = image == ImageSide::real_image ? -1 : 1;
  parallel_for(0, field.grid.ny, [&](int64_t j) {
    const std::complex<float>* u = field.samples.row(int(j));
    uint16_t* level = hologram.level.row(int(j));
    for (int i = 0; i < field.grid.nx; ++i)
      level[i] = u[i] == std::complex<float>()
                     ? 0
                     : uint16_t(table.level_of(std::atan2(sign * double(u[i].imag()), double(u[i].real())) / (2 * pi)));
  });
}

void encode_phase(const Field& field, ImageSide image, double range, Hologram& hologram) {
  double modulus = 0, square = 0;
  for (const auto& u : field.samples.values) {
    modulus += std::abs(std::complex<double>(u));
    square += std::norm(std::complex<double>(u));
  }
  hologram.illumination = modulus > 0 ? std::pow(square / modulus, 2) : 0;
  const float sign = image == ImageSide::real_image ? -1.0F : 1.0F;
  parallel_for(0, field.grid.ny, [&](int64_t j) {
    const std::complex<float>* u = field.samples.row(int(j));
    uint16_t* level = hologram.level.row(int(j));
    for (int i = 0; i < field.grid.nx; ++i)
      level[i] = uint16_t(phase_level(u[i].real(), sign * u[i].imag(), hologram.levels, range));
  });
}

// The conjugate has the same modulus, so both image sides have the same levels.
void encode_amplitude(const Field& field, const Observer& observer, Hologram& hologram) {
  double largest = 0, sum = 0;
  for (const auto& u : field.samples.values) {
    const double modulus = std::abs(std::complex<double>(u));
    largest = std::max(largest, modulus);
    sum += modulus;
  }
  const double scale = largest > 0 ? 1 / largest : 0;
  parallel_for(0, field.grid.ny, [&](int64_t j) {
    const std::complex<float>* u = field.samples.row(int(j));
    uint16_t* level = hologram.level.row(int(j));
    for (int i = 0; i < field.grid.nx; ++i)
      level[i] = uint16_t(amplitude_level(std::abs(std::complex<double>(u[i])) * scale, hologram.levels));
  });
  hologram.illumination = largest * largest;
  observer.fact("modulus_max", Fact(largest));
  observer.fact("mean_transmittance", Fact(sum * scale / double(field.grid.pixels())));
}

}  // namespace

double short_range_efficiency(double range) {
  const double amplitude = range < 1 ? range + std::sin(pi * range) / pi : 1;
  return amplitude * amplitude;
}

Hologram encode(const Field& field, const Slm& slm, const EncodeParams& params, const Observer& observer) {
  check_slm(slm);
  check_wavelength(field.wavelength);
  require_grid_of(slm, field.grid, "field");
  check_samples(field);
  check_panel(slm, params.method, observer);
  require(params.levels == 0 || (params.levels >= 2 && params.levels <= slm.levels),
          "expected 2 to {} levels, as many as the SLM \"{}\" has, or 0 for all of them, got {}", slm.levels, slm.name,
          params.levels);
  if (field.z != 0)
    observer.warn(fmt::format("the field is at z = {} and is shown at the panel, z = 0; propagate it there first",
                              format_length(field.z)));
  if (field.grid.centre_x != 0 || field.grid.centre_y != 0)
    observer.warn(fmt::format("the field is centred on ({}, {}) and is shown on the axis",
                              format_length(field.grid.centre_x), format_length(field.grid.centre_y)));
  const auto is_dark = [](const std::complex<float>& u) { return u == std::complex<float>(); };
  if (std::all_of(field.samples.values.begin(), field.samples.values.end(), is_dark))
    observer.warn("the field is dark everywhere and the hologram holds nothing; is a source inside the panel's view?");

  Hologram hologram;
  hologram.slm = slm;
  hologram.grid = slm.grid;
  hologram.level = Array2D<uint16_t>(slm.grid.ny, slm.grid.nx);
  hologram.levels = params.levels == 0 ? slm.levels : params.levels;
  hologram.wavelength = field.wavelength;
  hologram.image = params.image;
  hologram.name = field.name;
  hologram.frame = field.frame;
  hologram.encoder = name_of(params.method);
  hologram.modulation = params.method == Encoding::phase ? Modulation::phase : Modulation::amplitude;
  observer.fact("encoder", hologram.encoder);
  observer.fact("levels", hologram.levels);
  if (params.method == Encoding::phase) {
    const Slm known = with_effects(slm, params.effects);
    encode_phase(field, params.image, phase_range(slm, field.wavelength, observer), hologram);
    if (!known.effects.calibration.empty()) {
      const double stretch = slm.design_wavelength > 0 ? slm.design_wavelength / field.wavelength : 1;
      encode_calibrated(field, params.image, LevelTable(known, hologram.levels, stretch), hologram);
      observer.fact("calibrated", Fact(std::string("yes")));
    }
  } else if (params.method == Encoding::amplitude) {
    encode_amplitude(field, observer, hologram);
  } else {
    encode_off_axis(field, params, observer, hologram);
  }
  observer.fact("illumination", Fact(hologram.illumination));
  observer.progress(1);
  return hologram;
}

}  // namespace holotrace
