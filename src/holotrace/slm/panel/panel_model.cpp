#include "holotrace/slm/panel/panel_model.h"

#include <numeric>

#include "holotrace/base/error.h"
#include "holotrace/slm/panel/panel_parts.h"
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
  if (!fits) field.samples = Array2D<std::complex<float>>(parts.out.ny, parts.out.nx);
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

// The blur of crosstalk counts neither for the processor nor for the device.
PanelWork PanelModel::work() const {
  const Parts& p = *parts_;
  const double n = p.params.subpixels, nx = p.nx(), ny = p.ny(), pixels = nx * ny;
  const double points = p.expansion.points, terms = p.expansion.terms, pairs = p.expansion.pairs();
  const double samples = n * n * pixels, in_rows = n * pixels;
  constexpr double sample_bytes = sizeof(std::complex<float>);
  PanelWork work;
  work.on_processor.fft_operations = ny * (pairs * fft_operations(nx) + terms * fft_operations(n * nx)) +
                                     n * nx * (terms * fft_operations(ny) + fft_operations(n * ny));
  // Light of the points and its projections, products with weights, and copies of columns.
  work.on_processor.samples =
      pixels * points * (points + terms) + pairs * (pixels + in_rows) + terms * (2 * in_rows + samples) + samples;
  // Of each row of points: their light, added to the terms. Of each pair of terms: its copy and transforms along x; of each
  // row of terms two transpositions and a transform along y.
  work.moved = sample_bytes * (points * (pixels + 2 * pairs * pixels) + pairs * 5 * in_rows +
                               terms * (3 * in_rows + 4 * samples) + 2 * samples + 2 * pixels);
  work.sent = sample_bytes * pixels;
  work.fetched = sample_bytes * samples;
  return work;
}

}  // namespace holotrace
