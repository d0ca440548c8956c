#include "holotrace/slm/panel/pixel_response.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "holotrace/base/cycles.h"
#include "holotrace/base/threads.h"
#include "holotrace/base/units.h"
#include "holotrace/slm/panel/checks.h"
#include "holotrace/slm/panel/crystal.h"

namespace holotrace {
namespace {

float wrap(double cycles) {
  constexpr double magic = 6755399441055744;  // 1.5·2⁵²: adding it rounds to whole numbers
  return float(cycles - ((cycles + magic) - magic));
}

double part_along(std::complex<double> a, std::complex<double> b) { return a.real() * b.real() + a.imag() * b.imag(); }

}  // namespace

PixelResponse::PixelResponse(const Slm& slm, Modulation modulation, int levels, double stretch, double ripple,
                             int polarisation) {
  const bool shows_phase = modulation != Modulation::amplitude;
  const std::vector<CalibrationPoint>& points = slm.effects.calibration;
  const double turns = stretch * (1 + ripple);
  has_phase_ = shows_phase;
  has_amplitude_ = !shows_phase;
  const bool has_crystal = slm.effects.crystal.has_value();
  if (has_crystal || (!points.empty() && (shows_phase || slm.modulation == Modulation::amplitude))) {
    has_phase_ = has_amplitude_ = true;
    std::vector<double> places;
    for (int level = 0; level <= levels; ++level)
      places.push_back(shows_phase ? double(level) * slm.levels / levels
                                   : std::min(1.0, double(level) / (levels - 1)) * (slm.levels - 1));
    if (has_crystal)
      for (const CalibrationPoint& point : crystal_response(slm, places, stretch, ripple, polarisation))
        knots_.push_back({point.phase / (2 * pi), point.amplitude, 0, 0});
    else
      for (const double place : places) {
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

std::complex<double> PixelResponse::light_at(double drive) const {
  const double cycles = cycles_at(drive);
  if (knots_.empty()) return (has_amplitude_ ? amplitude_per_level_ * drive : 1) * cis_cycles(cycles);
  const Knot& knot = knot_at(drive);
  return (knot.amplitude + drive * knot.amplitude_slope) * cis_cycles(cycles);
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

LevelTable::LevelTable(const Slm& slm, int levels, double stretch) {
  check_levels(levels);
  const PixelResponse response(slm, Modulation::phase, levels, stretch, 0);
  double lowest = 0, highest = 0, dimmest = 1, brightest = 0;
  for (int level = 0; level < levels; ++level) {
    const double cycles = response.cycles_at(level);
    lowest = level == 0 ? cycles : std::min(lowest, cycles);
    highest = level == 0 ? cycles : std::max(highest, cycles);
    double shown = cycles - std::floor(cycles);
    light_.push_back(cis_cycles(shown));
    if (slm.effects.crystal) {
      light_.back() = response.light_at(level);
      shown = std::arg(light_.back()) / (2 * pi);  // of an amplitude of either sign
      shown -= std::floor(shown);
      dimmest = std::min(dimmest, std::abs(light_.back()));
      brightest = std::max(brightest, std::abs(light_.back()));
    }
    sorted_.push_back({shown, level});
  }
  range_ = highest - lowest;
  std::sort(sorted_.begin(), sorted_.end(), [](const Shown& a, const Shown& b) {
    return a.cycles < b.cycles || (a.cycles == b.cycles && a.level < b.level);
  });
  if (slm.effects.crystal) weigh(brightest - dimmest > 1e-9 * brightest);
}

// The gain, the nearest level for each of evenly spaced phases, and how much of the light shows them. Of more than 1024 levels
// some are enough for that; the others are looked at in the end.
void LevelTable::weigh(bool are_coupled) {
  constexpr int phases = 4096;
  const int stride = (levels() + 1023) / 1024;
  nearest_.assign(phases, 0);
  for (int round = 0; round < 8; ++round) {
    parallel_for(0, phases, [&](int64_t i) {
      // The first round does not know the gain yet, and takes the level with the most light along the phase.
      const std::complex<double> wanted = cis_cycles(double(i) / phases);
      double best = -std::numeric_limits<double>::infinity();
      for (int level = 0; level < levels(); level += stride) {
        const double score = round == 0 ? part_along(light_[size_t(level)], wanted) : closeness(level, wanted);
        if (score <= best) continue;
        best = score;
        nearest_[size_t(i)] = level;
      }
    });
    double along = 0, square = 0;
    for (int i = 0; i < phases; ++i) {
      const std::complex<double> t = light_[size_t(nearest_[size_t(i)])];
      along += part_along(t, cis_cycles(double(i) / phases)) / phases;
      square += std::norm(t) / phases;
    }
    if (!(along * gain_ > 1e-6)) {  // dark
      efficiency_ = purity_ = 0;
      break;
    }
    efficiency_ = std::pow(along * gain_, 2);
    purity_ = along * along / square;
    const double gain = square / along;
    gain_ *= gain;
    for (std::complex<double>& t : light_) t /= gain;
  }
  for (int i = 0; i < phases; ++i) {
    int& level = nearest_[size_t(i)];
    level = nearest_between(level - stride, level + stride, cis_cycles(double(i) / phases));
  }
  if (!are_coupled) nearest_.clear();
}

// The level from `first` to `last` whose light is nearest to a phasor.
int LevelTable::nearest_between(int first, int last, std::complex<double> wanted) const {
  int best = std::max(first, 0);
  for (int level = best + 1; level <= std::min(last, levels() - 1); ++level)
    if (closeness(level, wanted) > closeness(best, wanted)) best = level;
  return best;
}

double LevelTable::closeness(int level, std::complex<double> wanted) const {
  return 2 * part_along(light_[size_t(level)], wanted) - std::norm(light_[size_t(level)]);
}

int LevelTable::coupled_level_of(double cycles) const {
  const std::complex<double> wanted = cis_cycles(cycles);
  const double place = (cycles - std::floor(cycles)) * double(nearest_.size());
  const size_t below = std::min(size_t(place), nearest_.size() - 1);
  const auto [a, b] = std::minmax(nearest_[below], nearest_[(below + 1) % nearest_.size()]);
  // Neighbours on the curve, and all levels between them; or a jump to another part of the curve.
  if (b - a <= 256) return nearest_between(a, b, wanted);
  return closeness(a, wanted) >= closeness(b, wanted) ? a : b;
}

int LevelTable::level_of(double cycles) const {
  if (!nearest_.empty()) return coupled_level_of(cycles);
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

namespace {

// The first and last level of the shortest part of a curve between about its least and its largest amplitude. The curve of a
// crystal whose delays exceed a turn rises and falls several times, each time with other phases.
std::pair<int, int> rising_part(const std::vector<double>& amplitudes) {
  const auto [darkest, brightest] = std::minmax_element(amplitudes.begin(), amplitudes.end());
  const double margin = 0.02 * (*brightest - *darkest);
  const int count = int(amplitudes.size());
  std::pair<int, int> shortest{0, count - 1};
  std::array<int, 2> met{-1, -1};  // last levels that were dark and bright
  for (int level = 0; level < count; ++level)
    for (const size_t is_bright : {size_t(0), size_t(1)}) {
      const double amplitude = amplitudes[size_t(level)];
      if (is_bright ? amplitude < *brightest - margin : amplitude > *darkest + margin) continue;
      met[is_bright] = level;
      const int other = met[1 - is_bright];
      if (other >= 0 && level - other < shortest.second - shortest.first) shortest = {other, level};
    }
  // On to the ends of that part.
  auto& [first, last] = shortest;
  const bool rises = amplitudes[size_t(last)] >= amplitudes[size_t(first)];
  const auto goes_on = [&](int from, int to) {
    return rises ? amplitudes[size_t(to)] > amplitudes[size_t(from)]
                 : amplitudes[size_t(to)] < amplitudes[size_t(from)];
  };
  while (first > 0 && goes_on(first - 1, first)) --first;
  while (last + 1 < count && goes_on(last, last + 1)) ++last;
  return shortest;
}

}  // namespace

AmplitudeTable amplitude_table(const Slm& slm, int levels, double stretch) {
  const PixelResponse response(slm, Modulation::amplitude, levels, stretch, 0);
  AmplitudeTable table;
  for (int level = 0; level < levels; ++level) table.amplitudes.push_back(std::abs(response.light_at(level)));
  const auto [first, last] = rising_part(table.amplitudes);
  std::vector<std::pair<double, int>> used;  // by amplitude
  for (int level = first; level <= last; ++level) used.emplace_back(table.amplitudes[size_t(level)], level);
  std::sort(used.begin(), used.end());
  for (int step = 0; step < levels; ++step) {
    const double wanted = used.back().first * step / (levels - 1);
    auto nearest = std::lower_bound(used.begin(), used.end(), std::pair<double, int>(wanted, 0));
    if (nearest == used.end() || (nearest != used.begin() && wanted - (nearest - 1)->first < nearest->first - wanted))
      --nearest;
    table.level_of_step.push_back(nearest->second);
  }
  return table;
}

}  // namespace holotrace
