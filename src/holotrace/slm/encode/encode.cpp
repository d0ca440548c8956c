#include "holotrace/slm/encode/encode.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "holotrace/base/error.h"
#include "holotrace/base/units.h"
#include "holotrace/slm/encode/banded_levels.h"
#include "holotrace/slm/encode/binary.h"
#include "holotrace/slm/encode/blank_hologram.h"
#include "holotrace/slm/encode/double_phase.h"
#include "holotrace/slm/encode/encode_cost.h"
#include "holotrace/slm/encode/error_diffusion.h"
#include "holotrace/slm/encode/iterate/iterations.h"
#include "holotrace/slm/encode/kinoform.h"
#include "holotrace/slm/encode/off_axis.h"
#include "holotrace/slm/encode/phase_levels.h"
#include "holotrace/slm/encode/target.h"
#include "holotrace/slm/panel/checks.h"
#include "holotrace/slm/panel/static_errors.h"
#include "holotrace/wave/shared/device_room.h"
#include "holotrace/wave/shared/on_chosen_device.h"

namespace holotrace {
namespace {

// The encoders that run on the processor and on devices.
template <class AnyField>
void encode_anywhere(const ShownPixels<AnyField>& shown, const EncodeParams& params, const PhaseLevels& levels,
                     const Observer& observer, Hologram& hologram) {
  switch (params.method) {
    case Encoding::phase:
      return encode_phase(shown, levels, hologram);
    case Encoding::amplitude:
      return encode_amplitude(shown, observer, hologram);
    case Encoding::complex:
      return encode_complex(shown, levels, observer, hologram);
    case Encoding::off_axis:
      return encode_off_axis(shown, params, observer, hologram);
    case Encoding::double_phase:
      return encode_double_phase(shown, levels, params, observer, hologram);
    case Encoding::binary:
      return encode_binary(shown, levels, params, observer, hologram);
    default:
      fail("expected an encoding without iterations, got \"{}\"", name_of(params.method, encoding_names));
  }
}

// Whether the levels of a method are phases of every value, so that a calibration makes their steps uneven.
bool writes_phases(Encoding method) {
  return method != Encoding::amplitude && method != Encoding::off_axis && method != Encoding::binary;
}

// Factors that a field takes before it is encoded, so that the panel shows it in the light on each pixel, √m, and for
// methods that write fringes with its static phase errors: 1/√m, or exp(−iψ)/√m. Empty: all are 1. A pixel with less than
// a tenth of the brightest pixel's light counts as if it had a tenth: few dark pixels must not darken all others.
Array2D<std::complex<float>> factors_for_panel(const Slm& known, const EncodeParams& params, double wavelength) {
  const auto is_any = [&](std::initializer_list<Encoding> methods) {
    return std::find(methods.begin(), methods.end(), params.method) != methods.end();
  };
  Slm counted = known;
  const bool writes_fringes = is_any({Encoding::off_axis, Encoding::binary});
  if (!writes_fringes) {
    counted.effects.aberration.clear();
    counted.effects.phase_map = nullptr;
  }
  if (is_any({Encoding::phase, Encoding::binary})) counted.effects.light_map = nullptr;
  const double stretch = known.design_wavelength > 0 ? known.design_wavelength / wavelength : 1;
  Array2D<std::complex<float>> factors = static_phasors(counted, stretch);
  float brightest = 0;
  for (const std::complex<float>& factor : factors.values) brightest = std::max(brightest, std::norm(factor));
  for (std::complex<float>& factor : factors.values)
    factor = std::norm(factor) == 0
                 ? std::complex<float>(1)
                 : std::conj(factor) / std::abs(factor) / std::sqrt(std::max(std::norm(factor), 0.1F * brightest));
  return factors;
}

// A hologram of a field that was checked, the levels of its panel, and the factors that its field takes.
struct Begun {
  Hologram hologram;
  PhaseLevels levels;
  Array2D<std::complex<float>> factors;

  bool needs_processor(const EncodeParams& params) const {
    return (levels.has_table() && writes_phases(params.method)) || factors.size() > 0;
  }
};

// The field that is shown, U or its conjugate, times those factors.
Field shown_field(const Field& field, const Array2D<std::complex<float>>& factors, bool is_conjugate) {
  Field shown = is_conjugate ? conjugate(field) : field;
  for (size_t i = 0; i < factors.size(); ++i) shown.samples.values[i] *= factors.values[i];
  return shown;
}

Begun begin_hologram(const Field& head, const Slm& slm, const EncodeParams& params, const Observer& observer) {
  Hologram hologram = blank_hologram(head, slm, params, observer);
  const Slm known = known_panel(slm, params);
  PhaseLevels levels(known, hologram.levels, head.wavelength);
  if (hologram.modulation != Modulation::amplitude) tell_phase_range(known, levels.range(), head.wavelength, observer);
  return {std::move(hologram), std::move(levels), factors_for_panel(known, params, head.wavelength)};
}

// Levels of a DeviceField or BandedSamples; none if a sample is not finite, which the processor names.
template <class AnyField>
std::optional<Hologram> encode_there(const AnyField& field, const Begun& begun, const EncodeParams& params,
                                     const Observer& observer) {
  const ModulusMoments moments = modulus_moments(field);
  if (!std::isfinite(moments.largest)) return std::nullopt;
  Hologram hologram = begun.hologram;
  std::vector<std::pair<std::string, Fact>> facts;  // told when no device can fail any more
  Observer listener = observer;
  listener.on_fact = [&](const std::string& name, const Fact& value) { facts.emplace_back(name, value); };
  encode_anywhere(ShownPixels<AnyField>{field, moments, params.image == ImageSide::real_image}, params, begun.levels,
                  listener, hologram);
  if (observer.on_fact)
    for (const auto& [name, value] : facts) observer.on_fact(name, value);
  if (moments.largest == 0) warn_of_dark_field(observer);
  observer.fact("device", field.device->info().name);
  return hologram;
}

// The same on a device where the field is or goes: as a whole, or if there is not enough memory, band by band.
std::optional<Hologram> encode_on(Device& device, const PlacedField& field, const Begun& begun,
                                  const EncodeParams& params, const Observer& observer) {
  const Field& head = field.head();
  if (fits_whole(device, field, params)) {
    const auto there = field.on(device, observer);
    const auto lock = device.lock();
    make_room(device, encode_cost(params, head.grid, head.wavelength).memory);
    return encode_there(*there, begun, params, observer);
  }
  BandedSamples banded{&device, field.only_on_processor(observer), {}};
  const auto lock = device.lock();
  make_room(device, device.memory());
  const double left = std::max(0.0, device.memory_left());
  banded.bands = encode_bands(params, head.grid, head.wavelength, left, device.info().largest_buffer);
  require(
      banded.bands.fit(),
      "expected {} of memory for bands of a field of {} × {} samples on the device {}, got {}; use a smaller panel, or "
      "the device cpu",
      format_bytes(least_encode_memory(params, head.grid, head.wavelength)), head.grid.nx, head.grid.ny,
      device.info().name, format_bytes(left));
  return encode_there(banded, begun, params, observer);
}

}  // namespace

double short_range_efficiency(double range) {
  const double amplitude = range < 1 ? range + std::sin(pi * range) / pi : 1;
  return amplitude * amplitude;
}

Hologram encode(const PlacedField& field, const Slm& slm, const EncodeParams& given, const Observer& observer) {
  const Field& head = field.head();
  EncodeParams params = given;
  params.method = method_or(given.method, Encoding::phase);
  check_encode_params(slm, params);
  require_grid_of(slm, head.grid, "field");
  if (aims_at_targets(params.method)) {
    const auto here = field.on_processor(observer);
    Hologram found = encode_targets(targets_of(*here, params), *here, slm, params, observer);
    found.losses.by_cone = true;  // the targets are the field's own light
    return found;
  }
  check_encoding(slm, params, observer);
  const auto finished = [&](Hologram hologram) {
    observer.fact("illumination", Fact(hologram.illumination));
    observer.progress(1);
    return hologram;
  };
  check_head_to_show(head, slm, observer);
  Begun begun = begin_hologram(head, slm, params, observer);
  const bool needs_processor = begun.needs_processor(params);
  if (needs_processor && params.device.kind == DeviceKind::opencl)
    observer.warn(fmt::format(
        "the processor finds the levels, because those of the SLM \"{}\" have a calibration, or depend on the pixel",
        slm.name));
  if (encodes_on_devices(params.method) && !needs_processor) {
    Observer of_faults;  // the device is told if it has encoded
    of_faults.on_warning = observer.on_warning;
    auto there = on_chosen_device(
        params.device, of_faults, [&] { return fastest_to_encode(field, params); },
        [&](Device& device) { return encode_on(device, field, begun, params, observer); });
    if (there && *there) return finished(std::move(**there));
  }
  auto here = field.on_processor(observer);
  check_samples_to_show(*here, observer);
  bool is_conjugate = params.image == ImageSide::real_image;
  if (begun.factors.size() > 0 || (is_conjugate && params.method == Encoding::error_diffusion)) {
    here = std::make_shared<const Field>(shown_field(*here, begun.factors, is_conjugate));
    is_conjugate = false;
  }
  if (params.method == Encoding::error_diffusion)
    encode_error_diffusion(*here, begun.levels, params, observer, begun.hologram);
  else
    encode_anywhere(ShownPixels<Field>{*here, modulus_moments(*here), is_conjugate}, params, begun.levels, observer,
                    begun.hologram);
  return finished(std::move(begun.hologram));
}

Hologram encode(const Field& field, const Slm& slm, const EncodeParams& params, const Observer& observer) {
  return encode(PlacedField::of(field), slm, params, observer);
}

}  // namespace holotrace
