#include "holotrace/slm/panel/crystal.h"

#include <algorithm>
#include <cmath>
#include <complex>

#include "holotrace/base/units.h"
#include "holotrace/slm/panel/jones.h"

namespace holotrace {
namespace {

// Σ (v − shift)·(v − shift)† over vectors.
struct Spread {
  double xx = 0, yy = 0;
  jones::Complex xy = 0;

  void add(const jones::Vector& v) {
    xx += std::norm(v.x);
    yy += std::norm(v.y);
    xy += v.x * std::conj(v.y);
  }
  double trace() const { return xx + yy; }

  // The direction in which the spread is largest, of length 1; its larger component is real and positive.
  jones::Vector principal() const {
    const double mean = (xx + yy) / 2, half = std::hypot((xx - yy) / 2, std::abs(xy));
    jones::Vector v = xx >= yy ? jones::Vector{mean + half - yy, std::conj(xy)} : jones::Vector{xy, mean + half - xx};
    const double length = std::sqrt(std::norm(v.x) + std::norm(v.y));
    if (!(length > 0)) return {1, 0};
    const jones::Complex larger = std::norm(v.x) >= std::norm(v.y) ? v.x : v.y;
    const jones::Complex unit = std::conj(larger) / (std::abs(larger) * length);
    return {v.x * unit, v.y * unit};
  }
};

jones::Matrix plates_matrix(const std::vector<WavePlate>& plates, double stretch) {
  jones::Matrix all;
  for (const WavePlate& plate : plates) all = jones::retarder(plate.axis, stretch * plate.delay) * all;
  return all;
}

// A crystal between its plates, at one wavelength and one instant.
class Optics {
 public:
  Optics(const Slm& slm, double stretch, double ripple)
      : slm_(slm),
        crystal_(*slm.effects.crystal),
        turns_(stretch * (1 + ripple)),
        before_(plates_matrix(crystal_.plates_before, stretch)),
        behind_(plates_matrix(crystal_.plates_behind, stretch)) {
    for (int level = 0; level < slm.levels; ++level) of_levels_.push_back(matrix_at(level));
  }

  /// Delay at the wavelength.
  double delay_at(double place) const {
    const std::vector<CalibrationPoint>& calibration = slm_.effects.calibration;
    double delay = 0;
    if (!crystal_.delays.empty()) {
      const std::vector<double>& delays = crystal_.delays;
      const size_t below = std::min(size_t(place), delays.size() - 2);
      delay = delays[below] + (place - double(below)) * (delays[below + 1] - delays[below]);
    } else {
      delay = calibration.empty() ? slm_.phase_range * place / slm_.levels : calibration_at(calibration, place).phase;
    }
    return turns_ * delay;
  }

  double amplitude_at(double place) const {
    const std::vector<CalibrationPoint>& calibration = slm_.effects.calibration;
    return calibration.empty() ? 1 : calibration_at(calibration, place).amplitude;
  }

  jones::Matrix matrix_at(double place) const {
    const double delay = delay_at(place);
    const bool is_reflective = crystal_.pass == CrystalPass::reflective;
    const jones::Matrix pass =
        jones::twisted_cell(crystal_.director, crystal_.twist, is_reflective ? delay / 2 : delay);
    return behind_ * (is_reflective ? jones::reflected(pass) : pass) * before_;
  }

  /// What comes from the lamp, and what of the light that leaves counts.
  struct Component {
    jones::Vector in, out;
  };

  std::vector<Component> components() const {
    std::vector<Component> all;
    for (const jones::Vector& in : inputs()) {
      const jones::Vector out = crystal_.analyser ? jones::linear(*crystal_.analyser) : most_modulated(in);
      all.push_back({in, out});
      if (!crystal_.analyser) all.push_back({in, jones::orthogonal(out)});
    }
    return all;
  }

  /// Mean irradiance of a component over the levels.
  double irradiance(const Component& component) const {
    double sum = 0;
    for (const jones::Matrix& m : of_levels_) sum += std::norm(jones::dot(component.out, m * component.in));
    return sum / double(of_levels_.size());
  }

 private:
  std::vector<jones::Vector> inputs() const {
    if (crystal_.polariser) return {jones::linear(*crystal_.polariser)};
    // Unpolarised light: (J − J̄)†(J − J̄) is largest along the light that the levels change most.
    const jones::Matrix mean = mean_matrix();
    Spread spread;
    for (const jones::Matrix& m : of_levels_) {
      spread.add({std::conj(m.xx - mean.xx), std::conj(m.xy - mean.xy)});
      spread.add({std::conj(m.yx - mean.yx), std::conj(m.yy - mean.yy)});
    }
    const jones::Vector first = spread.trace() > 1e-20 ? spread.principal() : jones::linear(crystal_.director);
    const jones::Vector second = jones::orthogonal(first);
    const double half = std::sqrt(0.5);
    return {{half * first.x, half * first.y}, {half * second.x, half * second.y}};
  }

  jones::Matrix mean_matrix() const {
    jones::Matrix sum{0, 0, 0, 0};
    const double part = 1 / double(of_levels_.size());
    for (const jones::Matrix& m : of_levels_) {
      sum.xx += part * m.xx;
      sum.xy += part * m.xy;
      sum.yx += part * m.yx;
      sum.yy += part * m.yy;
    }
    return sum;
  }

  jones::Vector most_modulated(const jones::Vector& in) const {
    const jones::Vector mean = mean_matrix() * in;
    Spread modulated, light;
    for (const jones::Matrix& m : of_levels_) {
      const jones::Vector e = m * in;
      modulated.add({e.x - mean.x, e.y - mean.y});
      light.add(e);
    }
    return (modulated.trace() > 1e-20 * light.trace() ? modulated : light).principal();
  }

  const Slm& slm_;
  const Crystal& crystal_;
  double turns_;
  jones::Matrix before_, behind_;
  std::vector<jones::Matrix> of_levels_;
};

// Follows a complex number: its phase without jumps, and its modulus with a sign.
class Follower {
 public:
  CalibrationPoint operator()(jones::Complex light) {
    if (std::abs(light) < 1e-9) return {phase_, 0};
    const double phase = std::arg(light);
    const double half_turns = is_known_ ? std::round((phase_ - phase) / pi) : 0;
    is_known_ = true;
    phase_ = phase + half_turns * pi;
    const bool is_negative = std::fmod(half_turns, 2) != 0;
    return {phase_, is_negative ? -std::abs(light) : std::abs(light)};
  }
  bool is_known() const { return is_known_; }

 private:
  double phase_ = 0;
  bool is_known_ = false;
};

}  // namespace

std::vector<CalibrationPoint> crystal_response(const Slm& slm, const std::vector<double>& places, double stretch,
                                               double ripple, int component) {
  const Optics optics(slm, stretch, ripple);
  const std::vector<Optics::Component> all = optics.components();
  std::vector<CalibrationPoint> points;
  if (component >= int(all.size())) return std::vector<CalibrationPoint>(places.size(), {0, 0});
  const Optics::Component& of = all[size_t(component)];
  Follower follow;
  double at = places.empty() ? 0 : places.front();
  for (const double place : places) {
    // Between two places the phase may turn further than half a turn, so it is followed in small steps.
    const double turned = optics.delay_at(place) - optics.delay_at(at);
    const int steps = std::max(1, int(std::ceil(std::abs(turned) / (pi / 16))));
    CalibrationPoint point;
    for (int step = 1; step <= steps; ++step) {
      const bool was_known = follow.is_known();
      point = follow(jones::dot(of.out, optics.matrix_at(at + (place - at) * step / steps) * of.in));
      if (!was_known && follow.is_known())
        for (CalibrationPoint& dark : points) dark.phase = point.phase;
    }
    point.amplitude *= optics.amplitude_at(place);
    points.push_back(point);
    at = place;
  }
  return points;
}

std::vector<int> polarisation_components(const Slm& slm, double stretch) {
  if (!slm.effects.crystal) return {0};
  const Optics optics(slm, stretch, 0);
  const std::vector<Optics::Component> all = optics.components();
  std::vector<int> lit;
  for (size_t i = 0; i < all.size(); ++i)
    if (optics.irradiance(all[i]) > 1e-12) lit.push_back(int(i));
  return lit.empty() ? std::vector<int>{0} : lit;
}

}  // namespace holotrace
