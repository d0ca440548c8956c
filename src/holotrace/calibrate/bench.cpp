#include "holotrace/calibrate/bench.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "holotrace/base/complex_arrays.h"
#include "holotrace/base/units.h"
#include "holotrace/calibrate/patterns.h"
#include "holotrace/data/params/show.h"
#include "holotrace/slm/panel/crosstalk.h"
#include "holotrace/slm/panel/panel_model.h"
#include "holotrace/slm/panel/static_errors.h"

namespace holotrace {
namespace {

// Over [−1, 1].
double legendre(int degree, double x) {
  double before = 1, now = x;
  if (degree == 0) return 1;
  for (int n = 1; n < degree; ++n) {
    const double next = ((2 * n + 1) * x * now - n * before) / (n + 1);
    before = now;
    now = next;
  }
  return now;
}

}  // namespace

UnknownsBasis make_basis(const std::vector<TestPattern>& patterns, const CalibrateParams& params) {
  UnknownsBasis basis;
  const Hologram& first = patterns.front().hologram;
  basis.slm = with_effects(*first.slm, {});
  basis.wavelength = first.wavelength;
  std::set<int> levels{0};
  for (const TestPattern& pattern : patterns)
    for (const uint16_t level : pattern.hologram.level.values) levels.insert(level);
  basis.levels.assign(levels.begin(), levels.end());
  for (int n = 1; n <= params.light_order; ++n)
    for (int x = n; x >= 0; --x) basis.light.push_back({x, n - x});
  for (int n = 2; n <= params.aberration_order; ++n)
    for (int m = -n; m <= n; m += 2) basis.aberration.push_back({n, m, 0});
  basis.amplitude_order = std::min(params.amplitude_order, int(basis.levels.size()) - 2);
  return basis;
}

Unknowns first_guess(const UnknownsBasis& basis, const Slm& assumed, size_t photographs) {
  Unknowns u;
  u.light.assign(basis.light.size(), 0);
  u.aberration.assign(basis.aberration.size(), 0);
  const double zero = assumed_phase(assumed, 0, basis.wavelength);
  for (const int level : basis.levels) u.phases.push_back(assumed_phase(assumed, level, basis.wavelength) - zero);
  u.amplitude.assign(size_t(std::max(0, basis.amplitude_order)), 0);
  u.crosstalk = 0.25;  // a middling panel of liquid crystal
  u.gap = 0;
  u.exposures.assign(photographs, {});
  return u;
}

double& value_of(Unknowns& u, const Unknown& unknown) {
  const size_t k = unknown.index;
  switch (unknown.kind) {
    case UnknownKind::camera:
      return *std::array<double*, 4>{&u.camera.a, &u.camera.b, &u.camera.x, &u.camera.y}[k];
    case UnknownKind::blur:
      return u.blur;
    case UnknownKind::light:
      return u.light[k];
    case UnknownKind::aberration:
      return u.aberration[k];
    case UnknownKind::phase:
      return u.phases[k];
    case UnknownKind::amplitude:
      return u.amplitude[k];
    case UnknownKind::crosstalk:
      return u.crosstalk;
    case UnknownKind::gap:
      return reinterpret_cast<double(&)[2]>(u.gap)[k];
    case UnknownKind::exposure:
      break;
  }
  return k % 2 == 0 ? u.exposures[k / 2].gain : u.exposures[k / 2].offset;
}

double amplitude_term(const UnknownsBasis& basis, size_t k, double level) {
  const int degree = int(k) + 1;
  return legendre(degree, 2 * level / (basis.slm.levels - 1) - 1) - legendre(degree, -1);
}

double amplitude_of(const UnknownsBasis& basis, const Unknowns& unknowns, double level) {
  double log = 0;
  for (size_t k = 0; k < unknowns.amplitude.size(); ++k) log += unknowns.amplitude[k] * amplitude_term(basis, k, level);
  return std::exp(log);
}

Array2D<float> light_term_on(const Grid& grid, const LightTerm& term) {
  Array2D<float> values(grid.ny, grid.nx);
  for (int j = 0; j < grid.ny; ++j)
    for (int i = 0; i < grid.nx; ++i)
      values(j, i) =
          float(legendre(term.x, (2 * i + 1.0) / grid.nx - 1) * legendre(term.y, 1 - (2 * j + 1.0) / grid.ny));
  return values;
}

Array2D<float> zernike_on(const Grid& grid, const ZernikeTerm& term) {
  Array2D<float> values(grid.ny, grid.nx);
  const double radius = std::hypot(grid.width(), grid.height()) / 2;
  for (int j = 0; j < grid.ny; ++j)
    for (int i = 0; i < grid.nx; ++i) {
      const double x = grid.x(i) - grid.centre_x, y = grid.y(j) - grid.centre_y;
      values(j, i) = float(zernike(term.n, term.m, std::hypot(x, y) / radius, std::atan2(y, x)));
    }
  return values;
}

GapFigures gap_figures(double assumed_fill, std::complex<double> gap) {
  const double strength = std::abs(gap);
  if (strength == 0) return {assumed_fill, 0, 0};
  const double fill = std::min(assumed_fill, 1 / (1 + strength));
  return {fill, std::min(1.0, strength * fill / (1 - fill)), std::arg(gap)};
}

namespace {

using Complex = std::complex<float>;

// Of the finest fringe, between the light of opposite borders of the panel. Pixels of a camera are interpolated between them.
// With samples on the panel's own pixels, a fit ended at a crosstalk that was a tenth too small.
constexpr double samples_per_fringe = 4;
constexpr double least_crosstalk = 0.02;  // [pixels]: no effect below

// The window has the panel's size, and samples that represent the irradiance.
PropagateParams window_of(const Grid& grid, double wavelength, double distance) {
  const double side = std::max(grid.width(), grid.height());
  PropagateParams params;
  params.pitch = std::min(grid.pitch, wavelength * distance / (samples_per_fringe * side));
  params.columns = int(std::lround(grid.width() / params.pitch));
  params.rows = int(std::lround(grid.height() / params.pitch));
  return params;
}

bool changes_light(const Unknown& of) {
  return of.kind != UnknownKind::camera && of.kind != UnknownKind::blur && of.kind != UnknownKind::exposure;
}

// The derivative of a picture by the variance of a small blur: ½(∂²/∂x² + ∂²/∂y²). 0 at its border.
Channel blur_slope(const Channel& picture) {
  Channel out(picture.ny, picture.nx);
  for (int j = 1; j + 1 < picture.ny; ++j)
    for (int i = 1; i + 1 < picture.nx; ++i)
      out(j, i) =
          (picture(j - 1, i) + picture(j + 1, i) + picture(j, i - 1) + picture(j, i + 1) - 4 * picture(j, i)) / 2;
  return out;
}

// The picture after a small blur.
Channel blurred(Channel picture, double variance) {
  if (variance == 0) return picture;
  const Channel slope = blur_slope(picture);
  for (size_t i = 0; i < picture.values.size(); ++i) picture.values[i] += float(variance) * slope.values[i];
  return picture;
}

// The step of a difference quotient: large beside the rounding of single precision, small beside the unknown's scale.
double step_of(const Unknown& of) { return of.kind == UnknownKind::crosstalk ? 0.01 : 0.003; }

Channel squares_of(const Field& field) {
  Channel out(field.grid.ny, field.grid.nx);
  for (size_t i = 0; i < out.values.size(); ++i) out.values[i] = std::norm(field.samples.values[i]);
  return out;
}

}  // namespace

CalibrationBench::CalibrationBench(UnknownsBasis basis, double distance)
    : basis_(std::move(basis)),
      propagator_(make_propagator<float>(basis_.slm.grid, basis_.wavelength, distance,
                                         window_of(basis_.slm.grid, basis_.wavelength, distance))) {
  for (const LightTerm& term : basis_.light) light_.push_back(light_term_on(basis_.slm.grid, term));
  for (const ZernikeTerm& term : basis_.aberration) aberration_.push_back(zernike_on(basis_.slm.grid, term));
}

// Phases and amplitudes go to the panel model as a drive and a modulus, so that the phases need not ascend while they
// are sought.
Field CalibrationBench::leave(const Hologram& pattern, const Unknowns& u) const {
  Slm slm = basis_.slm;
  const GapFigures gap = gap_figures(slm.fill_factor, u.gap);
  const bool is_square = slm.fill_x == 0 || gap.fill_factor < slm.fill_factor;
  slm.fill_factor = gap.fill_factor;
  if (is_square) slm.fill_x = slm.fill_y = 0;
  slm.effects.gap_amplitude = gap.amplitude;
  slm.effects.gap_phase = gap.phase;
  slm.effects.crosstalk = std::max(u.crosstalk, least_crosstalk);
  slm.phase_range = 2 * pi;
  slm.design_wavelength = 0;
  const int steps = 256;
  const PanelModel model(slm, ShowParams{}, Modulation::complex, steps, 0, {basis_.wavelength});
  std::vector<float> drive_of(size_t(slm.levels)), modulus_of(size_t(slm.levels));
  for (size_t k = 0; k < basis_.levels.size(); ++k) {
    const size_t level = size_t(basis_.levels[k]);
    drive_of[level] = float(u.phases[k] * steps / (2 * pi));
    modulus_of[level] = float((steps - 1) * amplitude_of(basis_, u, double(level)));
  }
  Array2D<float> drive(pattern.level.ny, pattern.level.nx), modulus(pattern.level.ny, pattern.level.nx);
  for (size_t i = 0; i < drive.size(); ++i) {
    drive.values[i] = drive_of[pattern.level.values[i]];
    modulus.values[i] = modulus_of[pattern.level.values[i]];
  }
  return model.leave(drive, &modulus);
}

Array2D<Complex> CalibrationBench::smooth_factor(const Unknowns& u) const {
  Array2D<Complex> factor(basis_.slm.grid.ny, basis_.slm.grid.nx);
  for (size_t i = 0; i < factor.size(); ++i) {
    double log = 0, phase = 0;
    for (size_t k = 0; k < light_.size(); ++k) log += u.light[k] * light_[k].values[i];
    for (size_t k = 0; k < aberration_.size(); ++k) phase += u.aberration[k] * aberration_[k].values[i];
    factor.values[i] = Complex(std::polar(std::exp(log / 2), phase));
  }
  return factor;
}

Field CalibrationBench::at_sensor(const Field& left, const Array2D<Complex>& factor) const {
  Field field = left;
  multiply(field.samples.values.data(), field.samples.values.data(), factor.values.data(), factor.size());
  return propagate(field, propagator_);
}

Channel CalibrationBench::irradiance(const Hologram& pattern, const Unknowns& unknowns) const {
  return blurred(squares_of(at_sensor(leave(pattern, unknowns), smooth_factor(unknowns))), unknowns.blur);
}

// ∂(light that leaves)/∂unknown, without the smooth factor.
Field CalibrationBench::slope_of(const Hologram& pattern, const Unknowns& unknowns, const Unknown& of,
                                 const Field& left) const {
  Field slope;
  if (of.kind == UnknownKind::light || of.kind == UnknownKind::aberration) {
    const bool is_light = of.kind == UnknownKind::light;
    const Array2D<float>& term = (is_light ? light_ : aberration_)[of.index];
    const Complex unit = is_light ? Complex(0.5F, 0) : Complex(0, 1);
    slope = left;
    for (size_t i = 0; i < slope.samples.size(); ++i) slope.samples.values[i] *= unit * term.values[i];
    return slope;
  }
  Unknowns moved = unknowns;
  const double step = step_of(of);
  value_of(moved, of) += step;
  slope = leave(pattern, moved);
  const float scale = float(1 / step);
  for (size_t i = 0; i < slope.samples.size(); ++i)
    slope.samples.values[i] = scale * (slope.samples.values[i] - left.samples.values[i]);
  return slope;
}

CalibrationBench::Response CalibrationBench::respond(const Hologram& pattern, const Unknowns& unknowns,
                                                     const std::vector<Unknown>& of) const {
  const Field left = leave(pattern, unknowns);
  const Array2D<Complex> factor = smooth_factor(unknowns);
  const Field field = at_sensor(left, factor);
  std::vector<bool> is_shown(size_t(basis_.slm.levels));
  for (const uint16_t level : pattern.level.values) is_shown[level] = true;
  const Channel sharp = squares_of(field);
  Response response{blurred(sharp, unknowns.blur), std::vector<Channel>(of.size())};
  for (size_t n = 0; n < of.size(); ++n) {
    if (of[n].kind == UnknownKind::blur) response.slopes[n] = blur_slope(sharp);
    if (!changes_light(of[n])) continue;
    if (of[n].kind == UnknownKind::phase && !is_shown[size_t(basis_.levels[of[n].index])]) continue;
    const Field slope = at_sensor(slope_of(pattern, unknowns, of[n], left), factor);
    Channel out(field.grid.ny, field.grid.nx);
    for (size_t i = 0; i < out.values.size(); ++i) {
      const Complex u = field.samples.values[i], du = slope.samples.values[i];
      out.values[i] = 2 * (u.real() * du.real() + u.imag() * du.imag());
    }
    response.slopes[n] = blurred(std::move(out), unknowns.blur);
  }
  return response;
}

}  // namespace holotrace
