#include "holotrace/slm/panel/panel_model.h"

#include <algorithm>
#include <numeric>

#include "holotrace/base/error.h"
#include "holotrace/base/machine.h"
#include "holotrace/base/threads.h"
#include "holotrace/data/params/parameter.h"
#include "holotrace/slm/panel/checks.h"
#include "holotrace/slm/panel/panel_parts.h"
#include "holotrace/slm/panel/static_errors.h"
#include "holotrace/wave/shared/cost_model.h"

namespace holotrace {

PanelModel::PanelModel(const Slm& slm, const ShowParams& params, Modulation modulation, int levels,
                       double design_wavelength, const IlluminationState& state)
    : PanelModel(slm, params, modulation, levels, design_wavelength, state, pixel_expansion(slm, params)) {}

PanelModel::PanelModel(const Slm& slm, const ShowParams& params, Modulation modulation, int levels,
                       double design_wavelength, const IlluminationState& state, const PixelExpansion& expansion)
    : parts_(std::make_shared<const Parts>(slm, params, modulation, levels, design_wavelength, state, expansion)) {}

void PanelModel::leave(const Array2D<float>& drive, Field& field, const Array2D<float>* modulus) const {
  const Parts& parts = *parts_;
  parts.check_pattern(drive, modulus);
  const bool fits = field.samples.nx == parts.out.nx && field.samples.ny == parts.out.ny;
  field.grid = parts.out;
  field.wavelength = parts.state.wavelength;
  field.z = 0;
  if (!fits) field.samples = Array2D<std::complex<float>>::unset(parts.out.ny, parts.out.nx);
  parts.leave(drive, modulus, field);
}

void PanelModel::check_pattern(const Array2D<float>& drive, const Array2D<float>* modulus) const {
  parts_->check_pattern(drive, modulus);
}

Field PanelModel::head() const {
  Field field;
  field.grid = parts_->out;
  field.wavelength = parts_->state.wavelength;
  return field;
}

Field PanelModel::leave(const Array2D<float>& drive, const Array2D<float>* modulus) const {
  Field field;
  leave(drive, field, modulus);
  return field;
}

void PanelModel::add_slopes(const Pattern& pattern, const Array2D<std::complex<float>>& gradient, double factor,
                            const Slopes& to) const {
  const Parts& parts = *parts_;
  parts.check_pattern(pattern.drive, pattern.modulus);
  require(gradient.nx == parts.out.nx && gradient.ny == parts.out.ny,
          "expected a gradient of {} × {} samples, as the field has, got {} × {}", parts.out.nx, parts.out.ny,
          gradient.nx, gradient.ny);
  parts.check_pattern(to.drive, to.modulus);
  parts.add_slopes(pattern, gradient, factor, to);
}

double PanelModel::power_in() const {
  const Parts& parts = *parts_;
  const Grid& grid = parts.slm.grid;
  double mean = mean_irradiance(parts.light);
  if (const auto& map = parts.slm.effects.light_map)
    mean *= std::accumulate(map->values.begin(), map->values.end(), 0.0) / double(map->size());
  return parts.params.irradiance * mean * grid.width() * grid.height();
}

// The blur of crosstalk does not count: its values stay in the cache.
SummationWork PanelModel::work() const {
  const Parts& p = *parts_;
  const double n = p.params.subpixels, nx = p.nx(), ny = p.ny(), pixels = nx * ny;
  const double points = p.expansion.points, terms = p.expansion.terms, pairs = p.expansion.pairs();
  const double samples = n * n * pixels, in_rows = n * pixels;
  SummationWork work;
  work.fft_operations = ny * (pairs * fft_operations(nx) + terms * fft_operations(n * nx)) +
                        n * nx * (terms * fft_operations(ny) + fft_operations(n * ny));
  // Light of the points and its projections, products with weights, and copies of columns.
  work.samples =
      pixels * points * (points + terms) + pairs * (pixels + in_rows) + terms * (2 * in_rows + samples) + samples;
  return work;
}

namespace {

const Slm& checked(const Slm& slm, const ShowParams& params, int levels, const PixelExpansion& expansion) {
  check_slm(slm);
  check_levels(levels);
  check_ranges(params);
  const double n = params.subpixels, points = expansion.points;
  const double in_rows = 8.0 * slm.grid.nx * (points * points + expansion.pairs() + n);  // of each thread
  require_memory(8.0 * double(slm.grid.pixels()) * n * (n + expansion.terms) + thread_count() * in_rows,
                 fmt::format("a panel of {} × {} pixels at {} samples per pixel and axis", slm.grid.nx, slm.grid.ny,
                             params.subpixels));
  return slm;
}

// The crystal over gaps is taken as that of a pixel at level 0.
std::complex<float> gap_light(const SlmEffects& effects, const PixelResponse& response) {
  const std::complex<float> gap = std::polar(float(effects.gap_amplitude), float(effects.gap_phase));
  return effects.crystal ? gap * std::complex<float>(response.light_at(0)) : gap;
}

double stretch_of(double design, const IlluminationState& m) {
  check_wavelength(m.wavelength);
  return design > 0 ? design / m.wavelength : 1;
}

}  // namespace

PanelModel::Parts::Parts(const Slm& panel, const ShowParams& p, Modulation modulation_, int levels_, double design,
                         const IlluminationState& m, const PixelExpansion& e)
    : slm(checked(panel, p, levels_, e)),
      params(p),
      modulation(modulation_),
      levels(levels_),
      state(m),
      out{p.subpixels * panel.grid.nx, p.subpixels * panel.grid.ny, panel.grid.pitch / p.subpixels},
      response(slm, modulation, levels, stretch_of(design, m), slm.effects.flicker * m.flicker, m.polarisation),
      has_crosstalk(slm.effects.crosstalk > 0),
      expansion(e),
      points(e.points, e.terms),
      blur(slm, points.places),
      row(panel.grid.nx, p.subpixels, e.terms, slm.lit_x(), std::sqrt(p.irradiance)),
      column(panel.grid.ny, p.subpixels, e.terms, slm.lit_y(), 1),
      light(illuminate(out, p, m)),
      static_errors(static_phasors(slm, stretch_of(design, m))),
      gap(gap_light(slm.effects, response)),
      stuck(stuck_pixels(slm)) {
  for (int j = 0; j <= slm.grid.ny; ++j)
    stuck_of_row.push_back(size_t(std::lower_bound(stuck.begin(), stuck.end(), int64_t(j) * slm.grid.nx,
                                                   [](const StuckPixel& p, int64_t i) { return p.pixel < i; }) -
                                  stuck.begin()));
  if (has_gap() && static_errors.size() > 0) gap_field = full_pixels(static_errors);
}

void PanelModel::Parts::check(const Array2D<float>& drive, const char* what) const {
  require(drive.nx == nx() && drive.ny == ny(), "expected a {} of {} × {} pixels, as the SLM \"{}\" has, got {} × {}",
          what, nx(), ny(), slm.name, drive.nx, drive.ny);
}

void PanelModel::Parts::check_pattern(const Array2D<float>& drive, const Array2D<float>* modulus) const {
  check(drive, "drive");
  require((modulus != nullptr) == (modulation == Modulation::complex),
          "expected levels of the modulus only for complex modulation");
  if (modulus) check(*modulus, "modulus");
}

// The drive of row j, with the levels of its dead pixels.
const float* PanelModel::Parts::drive_of_row(const Array2D<float>& drive, int j, AlignedVector<float>& copy,
                                             bool is_modulus) const {
  const size_t begin = stuck_of_row[size_t(j)], end = stuck_of_row[size_t(j) + 1];
  if (begin == end) return drive.row(j);
  copy.assign(drive.row(j), drive.row(j) + nx());
  const bool is_phase = modulation != Modulation::amplitude && !is_modulus;
  const double scale = is_phase ? double(levels) / slm.levels : (levels - 1.0) / (slm.levels - 1.0);
  for (size_t k = begin; k < end; ++k) copy[size_t(stuck[k].pixel - int64_t(j) * nx())] = float(stuck[k].level * scale);
  return copy.data();
}

// Phase and amplitude of the pixels of row j, before crosstalk.
void PanelModel::Parts::phases_of_row(const Array2D<float>& drive, int j, bool wraps, float* cycles) const {
  AlignedVector<float> copy;
  const float* level = drive_of_row(drive, j, copy, false);
  if (wraps)
    response.wrapped_cycles(level, nx(), cycles);
  else
    response.cycles(level, nx(), cycles);
}

void PanelModel::Parts::amplitudes_of_row(const Array2D<float>& drive, const Array2D<float>* modulus, int j,
                                          float* amplitude) const {
  AlignedVector<float> copy;
  response.amplitudes(drive_of_row(drive, j, copy, false), nx(), amplitude);
  if (!modulus) return;
  const float* level = drive_of_row(*modulus, j, copy, true);
  const float scale = 1.0F / float(levels - 1);
  for (int i = 0; i < nx(); ++i) amplitude[i] *= scale * level[i];
}

size_t PanelModel::Parts::blur_floats(const Array2D<float>* modulus) const {
  return has_crosstalk ? size_t(nx()) * size_t(ny()) * (has_amplitude(modulus) ? 2 : 1) : 0;
}

DrivenPixels PanelModel::Parts::driven(const Array2D<float>& drive, const Array2D<float>* modulus, float* space) const {
  if (!has_crosstalk) return {drive, modulus};
  float* cycles = space;
  float* amplitudes = has_amplitude(modulus) ? space + size_t(nx()) * size_t(ny()) : nullptr;
  parallel_for(0, ny(), [&](int64_t j) {
    const size_t at = size_t(j) * size_t(nx());
    phases_of_row(drive, int(j), false, cycles + at);
    if (amplitudes) amplitudes_of_row(drive, modulus, int(j), amplitudes + at);
  });
  return {drive, modulus, cycles, amplitudes};
}

PanelModel::Parts::RowSpace::RowSpace(const Parts& parts)
    : pixels_(size_t(parts.nx())), count_(parts.expansion.terms), loan_(parts.workspace, [&] {
        const size_t points = size_t(parts.expansion.points), terms = size_t(count_);
        return 2 * (pixels_ * (points * points + size_t(parts.expansion.pairs()) + size_t(parts.params.subpixels)) +
                    chunk * points * (1 + terms));
      }()) {
  const size_t points = size_t(parts.expansion.points);
  light = reinterpret_cast<Complex*>(loan_.data());
  along_x = light + points * chunk;
  terms_ = along_x + points * size_t(count_) * chunk;
  samples = terms_ + size_t(parts.expansion.pairs()) * pixels_;
  cycles = reinterpret_cast<float*>(samples + size_t(parts.out.nx));
  amplitudes = cycles + points * points * pixels_;
}

void PanelModel::Parts::points_of_row(const DrivenPixels& pixels, int j, RowSpace& space) const {
  if (!has_crosstalk) {
    phases_of_row(pixels.drive, j, true, space.cycles);
    if (has_amplitude(pixels.modulus)) amplitudes_of_row(pixels.drive, pixels.modulus, j, space.amplitudes);
    return;
  }
  for (int cy = 0; cy < expansion.points; ++cy) {
    const size_t at = size_t(cy * expansion.points) * size_t(nx());
    blur.to_points(pixels.cycles, j, cy, space.cycles + at);
    if (pixels.amplitudes) blur.to_points(pixels.amplitudes, j, cy, space.amplitudes + at);
  }
}

}  // namespace holotrace
