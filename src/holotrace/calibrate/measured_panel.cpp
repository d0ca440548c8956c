#include "holotrace/calibrate/measured_panel.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>

#include "holotrace/calibrate/patterns.h"

namespace holotrace {
namespace {

// Standard error of an unknown; 0 for one that was not fitted.
class Errors {
 public:
  explicit Errors(const FitResult& result) : result_(result) {}

  double covariance(UnknownKind kind, size_t p, size_t q) const {
    const Eigen::Index i = find(kind, p), j = find(kind, q);
    return i < 0 || j < 0 ? 0 : result_.covariance(i, j);
  }
  double of(UnknownKind kind, size_t index) const { return std::sqrt(std::max(0.0, covariance(kind, index, index))); }

 private:
  Eigen::Index find(UnknownKind kind, size_t index) const {
    for (size_t n = 0; n < result_.unknowns.size(); ++n)
      if (result_.unknowns[n].kind == kind && result_.unknowns[n].index == index) return Eigen::Index(n);
    return -1;
  }
  const FitResult& result_;
};

// The light map of the fitted polynomial, with mean 1.
std::shared_ptr<const Array2D<float>> light_map_of(const UnknownsBasis& basis, const Unknowns& u) {
  if (basis.light.empty()) return nullptr;
  const Grid& grid = basis.slm.grid;
  Array2D<double> log(grid.ny, grid.nx);
  for (size_t k = 0; k < basis.light.size(); ++k) {
    const Array2D<float> term = light_term_on(grid, basis.light[k]);
    for (size_t i = 0; i < log.size(); ++i) log.values[i] += u.light[k] * term.values[i];
  }
  double sum = 0;
  for (double& value : log.values) sum += value = std::exp(value);
  auto map = std::make_shared<Array2D<float>>(grid.ny, grid.nx);
  for (size_t i = 0; i < log.size(); ++i) map->values[i] = float(log.values[i] * double(log.size()) / sum);
  return map;
}

std::vector<CalibrationPoint> calibration_of(const UnknownsBasis& basis, const Unknowns& u) {
  const std::vector<double> phases = at_all_levels(basis.levels, never_falling(u.phases), basis.slm.levels);
  std::vector<CalibrationPoint> points;
  double most = 0;
  for (size_t level = 0; level < phases.size(); ++level) {
    points.push_back({phases[level], amplitude_of(basis, u, double(level))});
    most = std::max(most, points.back().amplitude);
  }
  for (CalibrationPoint& point : points) point.amplitude /= most;
  return points;
}

}  // namespace

std::vector<double> never_falling(const std::vector<double>& values) {
  struct Pool {
    double sum;
    size_t count;
    double mean() const { return sum / double(count); }
  };
  std::vector<Pool> pools;
  for (const double value : values) {
    pools.push_back({value, 1});
    while (pools.size() > 1 && pools[pools.size() - 2].mean() > pools.back().mean()) {
      pools[pools.size() - 2].sum += pools.back().sum;
      pools[pools.size() - 2].count += pools.back().count;
      pools.pop_back();
    }
  }
  std::vector<double> out;
  for (const Pool& pool : pools) out.insert(out.end(), pool.count, pool.mean());
  return out;
}

std::vector<double> at_all_levels(const std::vector<int>& levels, const std::vector<double>& values, int count) {
  const size_t n = levels.size();
  std::vector<double> step(n - 1), rise(n - 1), slope(n);
  for (size_t k = 0; k + 1 < n; ++k) {
    step[k] = levels[k + 1] - levels[k];
    rise[k] = (values[k + 1] - values[k]) / step[k];
  }
  slope.front() = rise.front();
  slope.back() = rise.back();
  for (size_t k = 1; k + 1 < n; ++k) {
    if (rise[k - 1] * rise[k] <= 0) continue;
    const double a = 2 * step[k] + step[k - 1], b = step[k] + 2 * step[k - 1];
    slope[k] = (a + b) / (a / rise[k - 1] + b / rise[k]);
  }
  std::vector<double> out;
  size_t k = 0;
  for (int level = 0; level < count; ++level) {
    if (level > levels.back()) {
      out.push_back(values.back() + slope.back() * (level - levels.back()));
      continue;
    }
    while (k + 2 < n && level > levels[k + 1]) ++k;
    const double h = step[k], t = (level - levels[k]) / h;
    out.push_back(values[k] * (1 + 2 * t) * (1 - t) * (1 - t) + values[k + 1] * t * t * (3 - 2 * t) +
                  h * slope[k] * t * (1 - t) * (1 - t) - h * slope[k + 1] * t * t * (1 - t));
  }
  return out;
}

PanelFit measured_panel(const CalibrationBench& bench, const Slm& assumed, const Unknowns& u, const FitResult& result) {
  const UnknownsBasis& basis = bench.basis();
  const Grid& window = bench.window();
  const Errors errors(result);
  PanelFit fit;
  fit.slm = basis.slm;
  fit.slm.design_wavelength = basis.wavelength;
  fit.slm.preset.clear();
  SlmEffects& effects = fit.slm.effects;
  effects.calibration = calibration_of(basis, u);
  effects.crosstalk = u.crosstalk;
  const GapFigures gap = gap_figures(basis.slm.fill_factor, u.gap);
  if (gap.fill_factor < fit.slm.fill_factor) {
    fit.slm.fill_factor = gap.fill_factor;
    fit.slm.fill_x = fit.slm.fill_y = 0;
  }
  effects.gap_amplitude = gap.amplitude;
  effects.gap_phase = gap.phase;
  for (size_t k = 0; k < basis.aberration.size(); ++k) {
    const ZernikeTerm& term = basis.aberration[k];
    effects.aberration.push_back({term.n, term.m, u.aberration[k]});
    fit.aberration.push_back({term.n, term.m, {u.aberration[k], errors.of(UnknownKind::aberration, k)}});
  }
  effects.light_map = light_map_of(basis, u);
  fit.slm.own_effects = effects_of(fit.slm);
  if (effects.light_map) {
    const auto [least, most] = std::minmax_element(effects.light_map->values.begin(), effects.light_map->values.end());
    fit.least_light = *least;
    fit.most_light = *most;
  }
  const double zero = assumed_phase(assumed, 0, basis.wavelength);
  for (size_t k = 0; k < basis.levels.size(); ++k) {
    const int level = basis.levels[k];
    fit.levels.push_back({level,
                          assumed_phase(assumed, level, basis.wavelength) - zero,
                          {u.phases[k], errors.of(UnknownKind::phase, k)},
                          effects.calibration[size_t(level)].amplitude});
  }
  fit.crosstalk = {u.crosstalk, errors.of(UnknownKind::crosstalk, 0)};
  const double strength = std::abs(u.gap), re = u.gap.real(), im = u.gap.imag();
  const double xx = errors.covariance(UnknownKind::gap, 0, 0), xy = errors.covariance(UnknownKind::gap, 0, 1),
               yy = errors.covariance(UnknownKind::gap, 1, 1);
  if (strength > 0) {
    const double square = strength * strength;
    fit.gap_light = {strength, std::sqrt(std::max(0.0, re * re * xx + 2 * re * im * xy + im * im * yy)) / strength};
    fit.gap_phase = {std::arg(u.gap),
                     std::sqrt(std::max(0.0, im * im * xx - 2 * re * im * xy + re * re * yy)) / square};
  }
  fit.camera_scale = basis.slm.grid.pitch / window.pitch / std::hypot(u.camera.a, u.camera.b);
  const double area = u.camera.a * u.camera.a + u.camera.b * u.camera.b;  // of a camera pixel [samples²]
  fit.camera_blur = {u.blur / area, errors.of(UnknownKind::blur, 0) / area};
  fit.camera_rotation = std::atan2(u.camera.b, u.camera.a);
  fit.iterations = result.iterations;
  fit.pixels = result.misfit.pixels;
  return fit;
}

}  // namespace holotrace
