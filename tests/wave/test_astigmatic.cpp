#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "holotrace/base/error.h"
#include "holotrace/base/random.h"
#include "holotrace/base/units.h"
#include "holotrace/data/astigmatic_wave.h"
#include "holotrace/wave/bands.h"
#include "holotrace/wave/propagate/propagate.h"
#include "holotrace/wave/sum_exact.h"
#include "holotrace/wave/summation.h"
#include "holotrace/wave/synthesize.h"
#include "holotrace/wave/tiles/tile_sum.h"
#include "support/devices.h"
#include "support/fields.h"
#include "support/panels.h"
#include "support/wavelengths.h"

namespace holotrace {
namespace {

using namespace literals;
using test::make_random_sources;
using test::relative_error;

struct AstigmaticSource {
  Vec3 origin;
  SecondFocus second;
};

// A wave whose middle ray meets the panel at (x, y) in this direction, with these distances of its focal lines from there, > 0 behind
// the panel; its straight focal line is turned by `turn` about the ray.
AstigmaticSource wave_through(double x, double y, Vec3 direction, double first, double second, double turn) {
  const Vec3 d = normalize(direction), place{x, y, 0};
  const Frame across = frame_from_normal(d);
  return {place - d * first, {place - d * second, across.x * std::cos(turn) + across.y * std::sin(turn)}};
}

const AstigmaticSource all_sides[] = {
    wave_through(0.3_mm, -0.2_mm, {0.01, 0.02, 1}, 80_mm, 50_mm, 0.3),
    wave_through(0.3_mm, -0.2_mm, {0.01, 0.02, 1}, 50_mm, 80_mm, 0.3),
    wave_through(-0.1_mm, 0.1_mm, {-0.02, 0.01, 1}, 60_mm, -40_mm, 1.1),
    wave_through(-0.1_mm, 0.1_mm, {-0.02, 0.01, 1}, -60_mm, 40_mm, 2.0),
    wave_through(0, 0, {0, 0.01, 1}, -70_mm, -30_mm, -0.4),
    wave_through(0, 0, {0, 0.01, 1}, -30_mm, -70_mm, -0.4),
};

// The path to the place from the second focal line, a circle about the first one. A ray meets it at the point of the circle whose
// distance is stationary: the nearest one or, if the line lies between the place and that part of the circle, the farthest.
double path_by_search(const AstigmaticSource& s, Vec3 place) {
  const Vec3 way = s.second.place - s.origin;
  const double radius = length(way);
  const Vec3 u = way / radius, v = cross(s.second.line, u);
  const auto distance = [&](double angle) {
    return length(place - s.origin - u * (radius * std::cos(angle)) - v * (radius * std::sin(angle)));
  };
  const bool is_behind = s.origin.z < 0, is_second_behind = s.second.place.z < 0;
  const bool is_farther = is_behind == is_second_behind && std::abs(s.second.place.z) > std::abs(s.origin.z);
  double low = -0.2, high = 0.2;  // golden section
  for (int step = 0; step < 80; ++step) {
    const double a = high - (high - low) / std::numbers::phi, b = low + (high - low) / std::numbers::phi;
    (is_farther == (distance(a) > distance(b)) ? high : low) = is_farther == (distance(a) > distance(b)) ? b : a;
  }
  return (is_second_behind ? 1 : -1) * distance((low + high) / 2) + std::copysign(radius, way.z);
}

TEST(AstigmaticWave, HasThePathFromItsSecondFocalLine) {
  for (const AstigmaticSource& s : all_sides)
    for (const Vec3 place : {Vec3{}, Vec3{2_mm, 1_mm, 0}, Vec3{-1.5_mm, 2.5_mm, 0}}) {
      const AstigmaticWave wave(s.origin, s.second);
      EXPECT_NEAR(wave.at(place).path, path_by_search(s, place), 1e-13);  // roundings of 0.1 m, and of the search
    }
}

// Central differences over 1 µm: the third derivatives, below 10⁴/m², leave 1e-8 in the first and 1e-2/m in the second ones.
TEST(AstigmaticWave, HasTheSlopesOfItsPath) {
  constexpr double h = 1e-6, coarse = 1e-4;
  for (const AstigmaticSource& s : all_sides) {
    const AstigmaticWave wave(s.origin, s.second);
    const Vec3 place{1_mm, -0.7_mm, 0};
    const auto slopes = wave.slopes(place);
    const auto path = [&](double x, double y, double z) { return wave.at(place + Vec3{x, y, z}).path; };
    const Vec3 direction = wave.at(place).direction;
    EXPECT_NEAR(direction.x, (path(h, 0, 0) - path(-h, 0, 0)) / (2 * h), 1e-8);
    EXPECT_NEAR(direction.y, (path(0, h, 0) - path(0, -h, 0)) / (2 * h), 1e-8);
    EXPECT_NEAR(direction.z, (path(0, 0, h) - path(0, 0, -h)) / (2 * h), 1e-8);
    EXPECT_NEAR(length(direction), 1, 1e-12);
    EXPECT_NEAR(slopes.x, direction.x, 1e-15);
    EXPECT_NEAR(slopes.y, direction.y, 1e-15);
    const double c = coarse;
    EXPECT_NEAR(slopes.xx, (path(c, 0, 0) - 2 * path(0, 0, 0) + path(-c, 0, 0)) / (c * c), 1e-2);
    EXPECT_NEAR(slopes.yy, (path(0, c, 0) - 2 * path(0, 0, 0) + path(0, -c, 0)) / (c * c), 1e-2);
    EXPECT_NEAR(slopes.xy, (path(c, c, 0) - path(c, -c, 0) - path(-c, c, 0) + path(-c, -c, 0)) / (4 * c * c), 1e-2);
  }
}

// The middle ray has the two curvatures that were asked for, and the amplitude of |z₁z₂|/(R₁R₂).
TEST(AstigmaticWave, HasItsTwoCurvaturesOnTheMiddleRay) {
  const AstigmaticSource s =
      wave_through(0, 0, {0, 0, 1}, 80_mm, -50_mm, 0);  // the line along x: y has the first curvature
  const AstigmaticWave wave(s.origin, s.second);
  const double along_x = std::abs(s.second.line.x) > 0.5 ? -1 / 50_mm : 1 / 80_mm;
  const auto slopes = wave.slopes({});
  EXPECT_NEAR(slopes.xx, along_x, 1e-12);
  EXPECT_NEAR(slopes.yy, 1 / 80_mm - 1 / 50_mm - along_x, 1e-12);
  EXPECT_NEAR(slopes.xy, 0, 1e-12);
  EXPECT_NEAR(wave.at({}).modulus, 1, 1e-12);
}

// Almost equal foci: the spherical wave, but for their distance of 1 nm, 2e-8 of 50 mm.
TEST(AstigmaticWave, OfOneFocusIsSpherical) {
  for (const double side : {1.0, -1.0}) {
    const Vec3 origin{0.4_mm, 0.2_mm, -side * 50_mm};
    const AstigmaticWave wave(origin, {origin + Vec3{0, 0, 1e-9}, {0, 1, 0}});
    for (const Vec3 place : {Vec3{}, Vec3{2_mm, -3_mm, 0}}) {
      EXPECT_NEAR(wave.at(place).path, side * length(place - origin), 2e-9);
      EXPECT_NEAR(wave.at(place).modulus, 50_mm / length(place - origin), 1e-7);
    }
    const auto lit = wave.lit(0.1);
    EXPECT_NEAR(lit.along_y(2_mm).second, 5_mm, 1e-8);
    EXPECT_GT(lit.along_y(6_mm).first, lit.along_y(6_mm).second);
    EXPECT_NEAR(lit.foot.x, origin.x, 1e-9);
    EXPECT_NEAR(lit.foot.y, origin.y, 1e-9);
    EXPECT_NEAR(lit.reach_x, 5_mm, 1e-8);
    EXPECT_NEAR(lit.reach_y, 5_mm, 1e-8);
  }
}

// 300 waves of random phases: a third spherical, a third of these in front of the panel, the others astigmatic.
Sources mixed_waves(const Grid& grid) {
  Sources sources = make_random_sources(300, grid, green, 20_mm, 60_mm);
  sources.second_foci.resize(300);
  CounterRandom random(5, 0, 0);
  const auto within = [&](double from, double to) { return from + (to - from) * random.uniform(); };
  for (size_t i = 0; i < 300; ++i) {
    Source& wave = sources.waves[i];
    if (i % 3 == 0) {
      if (i % 9 == 0) wave.origin.z *= -1;
      continue;
    }
    const double first = within(20_mm, 60_mm), second = within(20_mm, 60_mm);
    const AstigmaticSource s =
        wave_through(within(-0.3_mm, 0.3_mm), within(-0.3_mm, 0.3_mm), {within(-0.02, 0.02), within(-0.02, 0.02), 1},
                     i % 2 == 0 ? first : -first, i % 5 == 0 ? -second : second, within(0, pi));
    wave.origin = s.origin;
    sources.second_foci[i] = s.second;
  }
  return sources;
}

Sources astigmatic_of(const Sources& sources) {
  std::vector<size_t> chosen;
  for (size_t i = 0; i < sources.waves.size(); ++i)
    if (sources.second_foci[i].is_astigmatic()) chosen.push_back(i);
  return some_of(sources, chosen);
}

// From the formula alone, in long double. A pixel is lit if the slopes of the path along x and y, linear from the place on where both
// are 0, are within the acceptance; they are differences of the path.
FieldDouble field_by_formula(const Sources& sources, const Grid& grid) {
  using Real = long double;
  FieldDouble field(grid, sources.wavelength);
  const Real tangent = std::tan(std::asin(sources.wavelength / (2 * (Real)grid.pitch)));
  for (size_t n = 0; n < sources.waves.size(); ++n) {
    const auto& [o, amplitude, phase] = sources.waves[n];
    const auto& [place, line] = sources.second_foci[n];
    const bool is_astigmatic = length(line) > 0;
    const Vec3 way = place - o;
    const Real apart = std::copysign(std::hypot((Real)way.x, (Real)way.y, (Real)way.z), (Real)way.z);
    struct PathAndModulus {
      Real path, modulus;
    };
    const auto at = [&](Real px, Real py) -> PathAndModulus {
      const Real x = px - o.x, y = py - o.y, z = -o.z, r = std::sqrt(x * x + y * y + z * z);
      if (!is_astigmatic) return {o.z < 0 ? r : -r, std::abs(o.z) / r};
      const Real along = x * line.x + y * line.y + z * line.z;
      const Real rho = (o.z < 0 ? 1 : -1) * std::sqrt(r * r - along * along);
      const Real s = (place.z < 0 ? 1 : -1) * std::hypot(rho - apart, along);
      return {s + apart, std::sqrt(std::abs(o.z * place.z * (rho - apart) / (rho * s * s)))};
    };
    constexpr Real h = 1e-5L;
    const auto slope_x = [&](Real x, Real y) { return (at(x + h, y).path - at(x - h, y).path) / (2 * h); };
    const auto slope_y = [&](Real x, Real y) { return (at(x, y + h).path - at(x, y - h).path) / (2 * h); };
    Real fx = o.x, fy = o.y, xx = 0, xy = 0, yy = 0;  // the place, by Newton's method
    for (int step = 0; step < 30; ++step) {
      xx = (slope_x(fx + h, fy) - slope_x(fx - h, fy)) / (2 * h);
      xy = (slope_x(fx, fy + h) - slope_x(fx, fy - h)) / (2 * h);
      yy = (slope_y(fx, fy + h) - slope_y(fx, fy - h)) / (2 * h);
      const Real sx = slope_x(fx, fy), sy = slope_y(fx, fy), determinant = xx * yy - xy * xy;
      fx -= (yy * sx - xy * sy) / determinant;
      fy -= (xx * sy - xy * sx) / determinant;
    }
    for (int j = 0; j < grid.ny; ++j)
      for (int i = 0; i < grid.nx; ++i) {
        const Real x = grid.x(i), y = grid.y(j);
        const Real along_x = xx * (x - fx) + xy * (y - fy), along_y = xy * (x - fx) + yy * (y - fy);
        if (std::abs(along_x) > tangent || std::abs(along_y) > tangent) continue;
        const auto [path, modulus] = at(x, y);
        const Real cycles = path / sources.wavelength;
        field.samples(j, i) += std::complex<double>(std::polar<Real>(
            amplitude * modulus, 2 * std::numbers::pi_v<Real> * (cycles - std::floor(cycles)) + phase));
      }
  }
  return field;
}

TEST(AstigmaticWaves, EveryMethodSumsThemWithinItsTolerance) {
  const Grid grid{96, 80, 8_um};
  const Sources sources = mixed_waves(grid);
  const FieldDouble expected = field_by_formula(sources, grid);
  EXPECT_LT(relative_error(sum_exact(sources, grid), expected), 1e-7);  // cycles in double, phases in float
  for (const SynthesisMethod method :
       {SynthesisMethod::exact, SynthesisMethod::tiled, SynthesisMethod::planes, SynthesisMethod::automatic})
    for (const double tolerance : {1e-2, 1e-3, 2e-4}) {
      const Field field = synthesize(sources, grid, {.method = method, .tolerance = tolerance});
      EXPECT_LT(relative_error(field, expected), tolerance) << method_name(method);
    }
  EXPECT_GT(relative_error(synthesize(astigmatic_of(sources), grid, {}), expected), 0.1);
}

// In tiles of 32 × 2 pixels and in large ones, the error that is measured for a plan is that of its sum.
TEST(AstigmaticWaves, TheErrorOfTilesIsKnown) {
  const Grid grid{128, 120, 8_um};
  const Sources sources = astigmatic_of(mixed_waves(grid));
  const FieldDouble expected = sum_exact(sources, grid);
  const auto waves = prepare_waves(sources, grid);
  for (const TileShape shape : {TileShape{128, 120}, TileShape{32, 30}, TileShape{32, 4}, TileShape{32, 1}}) {
    Field field(grid, green);
    TileWorkspace workspace;
    list_waves(waves, {0, grid.nx, 0, grid.ny}, workspace.waves);
    for (int y = 0; y < grid.ny; y += shape.rows)
      for (int x = 0; x < grid.nx; x += shape.columns)
        sum_tile(workspace.waves, {grid, green}, {shape}, {x, x + shape.columns, y, std::min(y + shape.rows, grid.ny)},
                 workspace, field.samples);
    const SplitEnergies split = measure_split(draw_pixels(waves), grid, {0, grid.nx, 0, grid.ny}, green, shape);
    // 8192 pixels of 150 waves: a tenth.
    EXPECT_NEAR(relative_error(field, expected) / std::hypot(std::sqrt(split.error / split.waves), rounding_error({})),
                1, 0.3)
        << shape.columns << " × " << shape.rows;
  }
}

TEST(AstigmaticWaves, KeepTheirAmplitudesInTilesAndBands) {
  const Grid grid{64, 256, 8_um};
  Sources sources = mixed_waves(grid);
  const size_t count = sources.waves.size();
  sources.tiles = {1, 2, std::vector<float>(2 * count)};
  for (size_t i = 0; i < count; ++i) {
    sources.tiles.values[i] = 1;
    sources.tiles.values[count + i] = float(i % 5);
  }
  FieldDouble expected(grid, green);
  for (const int tile : {0, 1}) {
    Sources one = sources;
    one.tiles = {};
    for (size_t i = 0; i < count; ++i) one.waves[i].amplitude = sources.tiles.values[size_t(tile) * count + i];
    const FieldDouble field = field_by_formula(one, grid);
    for (int j = 128 * tile; j < 128 * (tile + 1); ++j)
      for (int i = 0; i < 64; ++i) expected.samples(j, i) = field.samples(j, i);
  }
  EXPECT_LT(relative_error(sum_exact(sources, grid), expected), 1e-7);
  EXPECT_LT(relative_error(synthesize(sources, grid, {.tolerance = 1e-3}), expected), 1e-3);
  double error = 0, energy = 0;
  for (const Band& band : plan_bands({sources}, grid, {.tolerance = 1e-3}, 1e9)) {
    const Field rows = synthesize_band(sources, grid, band, {.tolerance = 1e-3});
    for (int j = band.first_row; j < band.end_row; ++j)
      for (int i = 0; i < 64; ++i) {
        error += std::norm(std::complex<double>(rows.samples(j - band.first_row, i)) - expected.samples(j, i));
        energy += std::norm(expected.samples(j, i));
      }
  }
  EXPECT_LT(std::sqrt(error / energy), 1e-3);
}

// A wave with a focal line along x 40 mm in front of the panel and one along y at 60 mm: at 40 mm the light is a line as wide as the
// panel shrunk by 1 − 40/60, and λz/w = 28 µm high; at 60 mm it is upright, 42 µm wide.
TEST(AstigmaticWaves, FocusInTheirLines) {
  const Grid grid{96, 96, 8_um};
  Sources sources{green, {{{0, 0, 40_mm}, 1, 0}}};
  sources.second_foci = {{{0, 0, 60_mm}, {1, 0, 0}}};
  const Field field = synthesize(sources, grid, {});
  const auto spreads = [&](double z) {
    const Field there = propagate(field, z);
    double x = 0, y = 0, sum = 0;
    for (int j = 0; j < 96; ++j)
      for (int i = 0; i < 96; ++i) {
        const double power = std::norm(there.samples(j, i));
        sum += power, x += power * std::abs(grid.x(i)), y += power * std::abs(grid.y(j));
      }
    return Vec2{x / sum, y / sum};
  };
  // A line of length L has the mean |x| of L/4: 768 µm/3/4 and 768 µm/2/4. Across, a sinc² of 28 µm has its light within some tens of µm.
  const Vec2 first = spreads(40_mm), second = spreads(60_mm);
  EXPECT_NEAR(first.x, 64_um, 15_um);
  EXPECT_LT(first.y, 25_um);
  EXPECT_NEAR(second.y, 96_um, 20_um);
  EXPECT_LT(second.x, 35_um);
}

// Slightly astigmatic waves are almost those of their mean curvature: 80 mm and 80.4 mm differ by 6e-2/m, λ/24 at the panel's corner.
TEST(AstigmaticWaves, LayersShowThemAsSphericalOnes) {
  const Grid grid{96, 80, 8_um};
  Sources sources{.wavelength = green};
  for (const double x : {-0.1_mm, 0.05_mm}) {
    const AstigmaticSource s = wave_through(x, 0.1_mm, {0.01, -0.005, 1}, 80.4_mm, 80_mm, 0.4);
    sources.waves.push_back({s.origin, 1, 0.5});
    sources.second_foci.push_back(s.second);
  }
  std::string warning;
  Observer observer;
  observer.on_warning = [&](const std::string& text) { warning = text; };
  const SynthesizeParams params{.method = SynthesisMethod::layers, .tolerance = 1e-3};
  const Field field = synthesize(sources, grid, params, observer);
  EXPECT_NE(warning.find("astigmatic"), std::string::npos);
  // Layers cut waves by their window, not by boxes: compared in the middle.
  const FieldDouble expected = sum_exact(sources, grid);
  double error = 0, energy = 0;
  for (int j = 30; j < 50; ++j)
    for (int i = 38; i < 58; ++i) {
      error += std::norm(std::complex<double>(field.samples(j, i)) - expected.samples(j, i));
      energy += std::norm(expected.samples(j, i));
    }
  EXPECT_LT(std::sqrt(error / energy), 0.1);
}

// Second foci without focal lines change nothing.
TEST(AstigmaticWaves, FociWithoutLinesLeaveWavesSpherical) {
  const Grid grid{96, 80, 8_um};
  Sources sources = make_random_sources(300, grid, green, 20_mm, 60_mm);
  const Field expected = synthesize(sources, grid, {.method = SynthesisMethod::planes});
  sources.second_foci.resize(300);
  std::string method;
  Observer observer;
  observer.on_fact = [&](const std::string& name, const Fact& fact) {
    if (name == "method") method = std::get<std::string>(fact);
  };
  EXPECT_EQ(synthesize(sources, grid, {.method = SynthesisMethod::planes}, observer).samples.values,
            expected.samples.values);
  EXPECT_EQ(method, "planes");
}

// Wherever the axes of the wave are, the pixels that it lights are those whose direction the panel can show: differences of the path
// over a pixel stay below the sine times the pitch.
TEST(AstigmaticWaves, LightThePixelsThatCanShowThem) {
  const Grid grid{512, 512, 8_um};
  const double sine = green / (2 * grid.pitch);
  for (const double turn : {0.0, 0.4, pi / 4, 2.0}) {
    const AstigmaticSource s = wave_through(0.3_mm, -0.2_mm, {0.01, 0.015, 1}, 60_mm, 20_mm, turn);
    Sources sources{.wavelength = green};
    sources.waves = {{s.origin, 1, 0}};
    sources.second_foci = {s.second};
    const AstigmaticWave wave(s.origin, s.second);
    const FieldDouble exact = sum_exact(sources, grid);
    const Field tiled = synthesize(sources, grid, {.method = SynthesisMethod::tiled, .tolerance = 1e-2});
    EXPECT_LT(relative_error(tiled, exact), 1e-2);
    int lit = 0, dark = 0;
    for (int j = 1; j < 511; j += 3)
      for (int i = 1; i < 511; i += 3) {
        const auto path = [&](double di, double dj) { return wave.at({grid.x(i + di), grid.y(j + dj), 0}).path; };
        const double x = std::abs(path(0.5, 0) - path(-0.5, 0)) / grid.pitch;
        const double y = std::abs(path(0, 0.5) - path(0, -0.5)) / grid.pitch;
        const bool is_lit = exact.samples(j, i) != 0.0;
        (is_lit ? lit : dark)++;
        // Slopes are linear to the third order: 2 % at the border.
        if (std::max(x, y) < 0.98 * sine) {
          EXPECT_TRUE(is_lit) << i << ", " << j << " turn " << turn;
        }
        if (std::max(x, y) > 1.02 * sine) {
          EXPECT_FALSE(is_lit) << i << ", " << j << " turn " << turn;
        }
      }
    EXPECT_GT(lit, 1000);
    EXPECT_GT(dark, 1000);
  }
}

// The public sums of one method do the same, and devices are asked for spherical waves only.
TEST(AstigmaticWaves, PlanesSumsThemInTiles) {
  const Grid grid{96, 80, 8_um};
  const Sources sources = astigmatic_of(mixed_waves(grid));
  EXPECT_LT(relative_error(sum_planes(sources, grid, 1e-2), sum_exact(sources, grid)), 1e-2);
}

// A device sums the spherical ones, the processor the others.
TEST(AstigmaticWaves, AreSummedBesideThoseOnADevice) {
  const Grid grid{96, 80, 8_um};
  const Sources sources = mixed_waves(grid);
  for (const DeviceChoice& device : test::processor_and_devices())
    EXPECT_LT(
        relative_error(synthesize(sources, grid, {.tolerance = 1e-3, .device = device}), sum_exact(sources, grid)),
        1e-3)
        << test::device_name(device);
}

// The error that the tiles state is that of the sum: at one tolerance the waves' two curvatures differ 20 times.
TEST(AstigmaticWaves, HaveTheErrorThatTheTilesState) {
  const Grid grid{256, 192, 8_um};
  for (const bool is_steep_along_x : {true, false}) {
    Sources sources{green, {}};
    for (int i = 0; i < 40; ++i) {
      const double x = (i % 8 - 3.5) * 50_um, y = (i / 8 - 2) * 50_um;
      const Vec3 near{x, y, -20_mm}, far = near * 20;
      sources.waves.push_back({near, 1, float(i * i)});
      const Vec3 way = normalize(near);
      const Vec3 line = normalize(is_steep_along_x ? Vec3{0, -way.z, way.y} : Vec3{-way.z, 0, way.x});
      sources.second_foci.push_back({far, line});
    }
    Heard heard;
    const Field field = sum_tiled(sources, grid, 1e-2, heard.observer());
    const double error = relative_error(field, sum_exact(sources, grid));
    EXPECT_LT(error, 1e-2);
    // Tiles add up errors as if they were independent, and count half more for safety.
    EXPECT_NEAR(std::log(error / heard.number("expected_error")), 0, std::log(2.5)) << is_steep_along_x;
  }
}

TEST(AstigmaticWaves, AreForecastWithTheOthers) {
  const Grid grid{96, 80, 8_um};
  const Sources sources = mixed_waves(grid);
  double sum = 0;
  const auto [behind, mirrored, astigmatic] = kinds_of(sources);
  for (const Sources* kind : {&behind, &mirrored}) sum += forecast_synthesis(*kind, grid, {}).seconds;
  EXPECT_GT(astigmatic.size(), 1u);  // groups
  EXPECT_TRUE(behind.second_foci.empty() && mirrored.second_foci.empty()) << "or they would be summed by tiles only";
  for (const Sources& group : astigmatic) sum += forecast_synthesis(group, grid, {}).seconds;
  const SumForecast all = forecast_synthesis(sources, grid, {});
  EXPECT_NEAR(all.seconds / sum, 1, 1e-9);
  EXPECT_FALSE(all.method.empty());
}

}  // namespace
}  // namespace holotrace
