#include "holotrace/slm/panel/pixel_response.h"

#include <algorithm>
#include <cmath>

#include "holotrace/base/units.h"
#include "holotrace/slm/panel/checks.h"

namespace holotrace {
namespace {

float wrap(double cycles) {
  constexpr double magic = 6755399441055744;  // 1.5·2⁵²: adding it rounds to whole numbers
  return float(cycles - ((cycles + magic) - magic));
}

}  // namespace

PixelResponse::PixelResponse(const Slm& slm, Modulation modulation, int levels, double stretch, double ripple) {
  const bool shows_phase = modulation != Modulation::amplitude;
  const std::vector<CalibrationPoint>& points = slm.effects.calibration;
  const double turns = stretch * (1 + ripple);
  has_phase_ = shows_phase;
  has_amplitude_ = !shows_phase;
  if (!points.empty() && (shows_phase || slm.modulation == Modulation::amplitude)) {
    has_phase_ = has_amplitude_ = true;
    for (int level = 0; level <= levels; ++level) {
      const double place = shows_phase ? double(level) * slm.levels / levels
                                       : std::min(1.0, double(level) / (levels - 1)) * (slm.levels - 1);
      const CalibrationPoint point = calibration_at(points, place);
      knots_.push_back({turns * point.phase / (2 * pi), point.amplitude, 0, 0});
    }
    for (size_t k = 0; k + 1 < knots_.size(); ++k) {
      knots_[k].cycles_slope = knots_[k + 1].cycles - knots_[k].cycles;
      knots_[k].amplitude_slope = knots_[k + 1].amplitude - knots_[k].amplitude;
    }
  } else if (shows_phase) {
    cycles_per_level_ = turns * slm.phase_range / (2 * pi) / levels;
  } else {
    amplitude_per_level_ = 1.0 / (levels - 1);
  }
  table_ = {float(cycles_per_level_), float(amplitude_per_level_), {}};
  for (const Knot& knot : knots_)
    table_.knots.push_back(
        {float(knot.cycles), float(knot.amplitude), float(knot.cycles_slope), float(knot.amplitude_slope)});
}

const PixelResponse::Knot& PixelResponse::knot_at(double& drive) const {
  const size_t k = size_t(std::clamp(drive, 0.0, double(knots_.size() - 1)));
  drive = std::clamp(drive - double(k), 0.0, 1.0);
  return knots_[k];
}

void PixelResponse::cycles(const float* drive, int count, float* to) const {
  if (!knots_.empty()) return respond(knots(), drive, size_t(count), to, nullptr);
  for (int i = 0; i < count; ++i) to[i] = float(cycles_per_level_ * drive[i]);
}

double PixelResponse::cycles_at(double drive) const {
  if (knots_.empty()) return cycles_per_level_ * drive;
  const Knot& knot = knot_at(drive);
  return knot.cycles + drive * knot.cycles_slope;
}

void PixelResponse::wrapped_cycles(const float* drive, int count, float* to) const {
  if (knots_.empty()) {
    for (int i = 0; i < count; ++i) to[i] = wrap(cycles_per_level_ * drive[i]);
    return;
  }
  for (int i = 0; i < count; ++i) {
    double rest = drive[i];
    const Knot& knot = knot_at(rest);
    to[i] = wrap(knot.cycles + rest * knot.cycles_slope);
  }
}

void PixelResponse::amplitudes(const float* drive, int count, float* to) const {
  if (!knots_.empty()) return respond(knots(), drive, size_t(count), nullptr, to);
  for (int i = 0; i < count; ++i) to[i] = has_amplitude_ ? float(amplitude_per_level_ * drive[i]) : 1.0F;
}

void PixelResponse::pull_back(const float* drive, int count, const float* of_cycles, const float* of_amplitudes,
                              const float* modulus, float factor, float* of_drive) const {
  if (!knots_.empty())
    return respond_back(knots(), drive, size_t(count), of_cycles, of_amplitudes, modulus, factor, of_drive);
  const float per_level = factor * table_.amplitude_per_level;
  for (int i = 0; i < count; ++i) {
    of_drive[i] = table_.cycles_per_level * of_cycles[i];
    if (of_amplitudes) of_drive[i] += (modulus ? modulus[i] : 1) * per_level * of_amplitudes[i];
  }
}

LevelTable::LevelTable(const Slm& slm, int levels, double stretch) : cycles_(size_t(levels)) {
  check_levels(levels);
  const PixelResponse response(slm, Modulation::phase, levels, stretch, 0);
  double first = 0, last = 0;
  for (int level = 0; level < levels; ++level) {
    const double cycles = response.cycles_at(level);
    (level == 0 ? first : last) = cycles;
    cycles_[size_t(level)] = cycles - std::floor(cycles);
    sorted_.push_back({cycles_[size_t(level)], level});
  }
  range_ = last - first;
  std::sort(sorted_.begin(), sorted_.end(), [](const Shown& a, const Shown& b) {
    return a.cycles < b.cycles || (a.cycles == b.cycles && a.level < b.level);
  });
}

int LevelTable::level_of(double cycles) const {
  cycles -= std::floor(cycles);
  const auto above = std::lower_bound(sorted_.begin(), sorted_.end(), cycles,
                                      [](const Shown& shown, double c) { return shown.cycles < c; });
  const Shown& next = above == sorted_.end() ? sorted_.front() : *above;
  // Of the levels that show the phase below, take the first: levels of equal phase are sorted lowest first.
  const Shown& before = above == sorted_.begin() ? sorted_.back() : *(above - 1);
  const auto around = [](double difference) { return std::abs(difference - std::round(difference)); };
  const double off_next = around(next.cycles - cycles), off_before = around(before.cycles - cycles);
  if (off_next == off_before) return std::min(next.level, before.level);
  return off_next < off_before ? next.level : before.level;
}

}  // namespace holotrace
