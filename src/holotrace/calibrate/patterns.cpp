#include "holotrace/calibrate/patterns.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>

#include "holotrace/base/cycles.h"
#include "holotrace/base/error.h"
#include "holotrace/base/random.h"
#include "holotrace/base/threads.h"
#include "holotrace/base/units.h"
#include "holotrace/data/params/parameter.h"

namespace holotrace {
namespace {

constexpr int least_side = 64;          // of the panel [pixels]
constexpr double shortest_period = 3;   // of the zones of a lens [pixels]
constexpr double least_step = pi / 4;   // between the phases of a pair of levels [rad]
constexpr double pairs_per_level = 12;  // over all patterns, at least
constexpr int spots_in_focus = 16;      // of a pattern `focus`

// A cell of the panel and the place on the sensor where its lens focuses [m].
struct Lens {
  int first_column = 0, end_column = 0, first_row = 0, end_row = 0;
  double x = 0, y = 0;
};

struct Bench {
  Slm slm;
  double wavelength, distance;

  double half_width() const { return slm.grid.width() / 2; }
  double half_height() const { return slm.grid.height() / 2; }
  // Cells along a side of the panel of that length.
  int cells(double length) const {
    return std::max(2, int(std::lround(length / std::sqrt(6 * wavelength * distance))));
  }
  double cycles_to(double x, double y, double z_x, double z_y) const {
    return std::sqrt((x - z_x) * (x - z_x) + (y - z_y) * (y - z_y) + distance * distance) / wavelength;
  }
};

// A place on the sensor for a cell: at a random distance from it, toward the panel's middle if it would leave the
// shadow of the panel.
void place_spot(const Bench& bench, CounterRandom& random, Lens& lens) {
  const Grid& grid = bench.slm.grid;
  const double x = grid.x((lens.first_column + lens.end_column - 1) / 2.0),
               y = grid.y((lens.first_row + lens.end_row - 1) / 2.0);
  const double longest = std::max(2 * shortest_period, (lens.end_column - lens.first_column) / 3.0);
  const double room_x = 0.92 * bench.half_width(), room_y = 0.92 * bench.half_height();
  for (int attempt = 0; attempt < 200; ++attempt) {
    const double period = shortest_period * std::pow(longest / shortest_period, random.uniform()) * grid.pitch;
    const double away = bench.distance * bench.wavelength / period, angle = 2 * pi * random.uniform();
    lens.x = x + away * std::cos(angle);
    lens.y = y + away * std::sin(angle);
    if (std::abs(lens.x) < room_x && std::abs(lens.y) < room_y) return;
  }
  lens.x = -x / 2;
  lens.y = -y / 2;
}

std::vector<Lens> make_lenses(const Bench& bench, CounterRandom& random) {
  const Grid& grid = bench.slm.grid;
  const int across = bench.cells(grid.width()), down = bench.cells(grid.height());
  std::vector<Lens> lenses;
  for (int j = 0; j < down; ++j)
    for (int i = 0; i < across; ++i) {
      Lens lens{grid.nx * i / across, grid.nx * (i + 1) / across, grid.ny * j / down, grid.ny * (j + 1) / down};
      place_spot(bench, random, lens);
      lenses.push_back(lens);
    }
  return lenses;
}

using Pair = std::array<int, 2>;  // lower and upper level

Hologram blank(const Bench& bench) {
  Hologram h;
  h.grid = bench.slm.grid;
  h.level = Array2D<uint16_t>(h.grid.ny, h.grid.nx);
  h.levels = bench.slm.levels;
  h.wavelength = bench.wavelength;
  h.image = ImageSide::real_image;
  h.encoder = test_pattern_encoder;
  h.slm = bench.slm;
  return h;
}

Hologram lens_array(const Bench& bench, const std::vector<Lens>& lenses, const std::vector<Pair>& pairs) {
  Hologram h = blank(bench);
  const Grid& grid = h.grid;
  parallel_for(0, int64_t(lenses.size()), [&](int64_t n) {
    const Lens& lens = lenses[size_t(n)];
    for (int j = lens.first_row; j < lens.end_row; ++j)
      for (int i = lens.first_column; i < lens.end_column; ++i) {
        const double cycles = bench.cycles_to(grid.x(i), grid.y(j), lens.x, lens.y);
        const bool is_upper = std::cos(2 * pi * (cycles - std::floor(cycles))) >= 0;
        h.level(j, i) = uint16_t(pairs[size_t(n)][is_upper ? 1 : 0]);
      }
  });
  return h;
}

Hologram focus_pattern(const Bench& bench, const Pair& pair, CounterRandom& random) {
  Hologram h = blank(bench);
  const Grid& grid = h.grid;
  // From every pixel of the panel the zones must be longer than two pixels, with some margin.
  const double reach = 0.8 * bench.distance * bench.wavelength / (2 * grid.pitch);
  const auto room = [&](double half) { return std::clamp(reach - half, 0.1 * half, 0.9 * half); };
  struct Spot {
    double x, y, cycles;
  };
  std::vector<Spot> spots(spots_in_focus);
  for (Spot& s : spots)
    s = {room(bench.half_width()) * (2 * random.uniform() - 1), room(bench.half_height()) * (2 * random.uniform() - 1),
         random.uniform()};
  parallel_for(0, grid.ny, [&](int64_t j) {
    for (int i = 0; i < grid.nx; ++i) {
      double sum = 0;
      for (const Spot& s : spots)
        sum += cis_cycles(s.cycles - bench.cycles_to(grid.x(i), grid.y(double(j)), s.x, s.y)).real();
      h.level(int(j), i) = uint16_t(pair[sum >= 0 ? 1 : 0]);
    }
  });
  return h;
}

std::vector<int> measured_levels(const Slm& slm, int count) {
  std::vector<int> levels;
  for (int k = 0; k < count; ++k) levels.push_back(int(std::lround(double(k) * (slm.levels - 1) / (count - 1))));
  return levels;
}

// The distance of two phases around the circle, in [0, π].
double step_between(double p, double q) { return std::abs(std::remainder(p - q, 2 * pi)); }

// The measured level whose assumed phase is nearest to half a wave from that of level 0, and level 0.
Pair strongest_pair(const std::vector<int>& levels, const std::vector<double>& phases) {
  size_t best = 1;
  for (size_t k = 1; k < levels.size(); ++k)
    if (step_between(phases[k], phases[0]) > step_between(phases[best], phases[0])) best = k;
  return {levels[0], levels[best]};
}

// A pair for each cell: every level as often as any other, beside a random one that differs by enough.
std::vector<Pair> random_pairs(const std::vector<int>& levels, const std::vector<double>& phases, size_t cells,
                               size_t first, CounterRandom& random) {
  std::vector<Pair> pairs;
  for (size_t n = 0; n < cells; ++n) {
    const size_t k = (first + n) % levels.size();
    std::vector<size_t> others;
    for (size_t other = 0; other < levels.size(); ++other)
      if (step_between(phases[k], phases[other]) >= least_step) others.push_back(other);
    size_t other = k == 0 ? levels.size() - 1 : 0;
    if (!others.empty()) other = others[size_t(random.uniform() * double(others.size()))];
    pairs.push_back({levels[std::min(k, other)], levels[std::max(k, other)]});
  }
  for (size_t n = pairs.size(); n > 1; --n) std::swap(pairs[n - 1], pairs[size_t(random.uniform() * double(n))]);
  return pairs;
}

}  // namespace

double assumed_phase(const Slm& slm, double level, double wavelength) {
  const double stretch = slm.design_wavelength > 0 ? slm.design_wavelength / wavelength : 1;
  if (!slm.effects.calibration.empty()) return stretch * calibration_at(slm.effects.calibration, level).phase;
  return stretch * slm.phase_range * level / slm.levels;
}

std::vector<TestPattern> make_test_patterns(const Slm& slm, double wavelength, double distance,
                                            const TestPatternParams& params) {
  check_slm(slm);
  check_ranges(params);
  check_wavelength(wavelength);
  require(std::isfinite(distance) && distance > 0, "expected a distance above 0 m, got {}", format_length(distance));
  require(slm.modulation == Modulation::phase,
          "expected a phase panel, whose phases are to be measured, got \"{}\", which modulates {}; name a phase panel",
          slm.name, slm.modulation == Modulation::amplitude ? "amplitude" : "phase and amplitude");
  require(std::min(slm.grid.nx, slm.grid.ny) >= least_side,
          "expected a panel of at least {0} × {0} pixels, for lenses of many zones, got {1} × {2}", least_side,
          slm.grid.nx, slm.grid.ny);
  require(params.measured_levels <= slm.levels,
          "expected at most {} measured levels, as many as the panel \"{}\" has, got {}; lower measured_levels",
          slm.levels, slm.name, params.measured_levels);

  const Bench bench{slm, wavelength, distance};
  const std::vector<int> levels = measured_levels(slm, params.measured_levels);
  std::vector<double> phases;
  for (const int level : levels) phases.push_back(assumed_phase(slm, level, wavelength));
  const Pair strongest = strongest_pair(levels, phases);

  std::vector<TestPattern> patterns;
  const auto add = [&](PatternKind kind, const char* kind_name, Hologram hologram) {
    patterns.push_back({fmt::format("{:02}_{}", patterns.size() + 1, kind_name), kind, std::move(hologram)});
  };
  const auto random_of = [&](size_t pattern) { return CounterRandom(uint64_t(params.pattern_seed), 0, pattern); };

  CounterRandom first = random_of(0);
  const std::vector<Lens> lenses = make_lenses(bench, first);
  add(PatternKind::spots, "spots", lens_array(bench, lenses, std::vector<Pair>(lenses.size(), strongest)));
  const double wanted = std::ceil(pairs_per_level * double(levels.size()) / double(lenses.size()));
  const int count = params.level_patterns > 0 ? params.level_patterns : int(std::clamp(wanted, 3.0, 16.0));
  for (int n = 0; n < count; ++n) {
    CounterRandom random = random_of(patterns.size());
    const std::vector<Lens> own = make_lenses(bench, random);
    add(PatternKind::levels, "levels",
        lens_array(bench, own, random_pairs(levels, phases, own.size(), size_t(n) * own.size(), random)));
  }
  for (int n = 0; n < params.focus_patterns; ++n) {
    CounterRandom random = random_of(patterns.size());
    add(PatternKind::focus, "focus", focus_pattern(bench, strongest, random));
  }
  return patterns;
}

}  // namespace holotrace
