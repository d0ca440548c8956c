// Waves sorted into slices of depth, and points between samples: the parts of sum_layers.

#include <gtest/gtest.h>

#include <cmath>

#include "holotrace/base/fft.h"
#include "holotrace/base/units.h"
#include "holotrace/wave/layers/points_on_slice.h"
#include "holotrace/wave/layers/slice.h"
#include "holotrace/wave/shared/spherical_wave_kernel.h"
#include "support/fields.h"
#include "support/panels.h"
#include "support/wavelengths.h"

namespace holotrace {
namespace {

using namespace literals;
using test::make_random_sources;

TEST(SliceDepths, AreTheFewestNoneThickerThanAsked) {
  const DepthSlices s = slice_depths({0.21, 0.2, 0.205, 0.1951, 0.2101}, 0.0051);
  ASSERT_EQ(s.slices.size(), 3U);  // 0.2101 … 0.205, 0.2 … 0.1951
  EXPECT_EQ(s.slices.size(), slice_depths({0.21, 0.2, 0.205, 0.1951, 0.2101}, 0.005).slices.size());
  EXPECT_EQ(s.slices[0].members, (std::vector<uint32_t>{0, 4}));
  EXPECT_DOUBLE_EQ(s.slices[0].depth, (0.21 + 0.2101) / 2);
  EXPECT_EQ(s.slices[1].members, (std::vector<uint32_t>{1, 2}));
  EXPECT_EQ(s.slices[2].members, (std::vector<uint32_t>{3}));
  EXPECT_NEAR(s.thickness, 0.005, 1e-15);
}

// Tries all cuts of a sorted list into `count` runs; returns the smallest value of the thickest run.
double thinnest_by_trial(std::vector<double> depths, int count) {
  std::sort(depths.begin(), depths.end());
  const int n = int(depths.size());
  double best = INFINITY;
  for (int cuts = 0; cuts < 1 << (n - 1); ++cuts) {
    if (__builtin_popcount(unsigned(cuts)) + 1 > count) continue;
    double thickest = 0;
    for (int i = 0, first = 0; i < n; ++i)
      if (i == n - 1 || (cuts >> i & 1)) {
        thickest = std::max(thickest, depths[size_t(i)] - depths[size_t(first)]);
        first = i + 1;
      }
    best = std::min(best, thickest);
  }
  return best;
}

TEST(SliceDepths, OfAGivenCountAreTheThinnest) {
  CounterRandom random(5, 0, 0);
  for (int trial = 0; trial < 20; ++trial) {
    std::vector<double> depths;
    for (int i = 0; i < 10; ++i) depths.push_back(0.2 + 0.01 * random.uniform());
    for (const int count : {1, 2, 3, 5, 9, 10, 50}) {
      const DepthSlices s = slice_depths_into(depths, count);
      EXPECT_LE(int(s.slices.size()), count);
      EXPECT_NEAR(s.thickness, thinnest_by_trial(depths, count), 1e-14) << count;  // a few last bits of 0.01 m
      size_t members = 0;
      for (const DepthSlice& slice : s.slices) members += slice.members.size();
      EXPECT_EQ(members, depths.size());
    }
  }
}

TEST(SliceDepths, OfEqualDepthsIsOneWithoutThickness) {
  for (const DepthSlices& s : {slice_depths({0.2, 0.2, 0.2}, 0), slice_depths_into({0.2, 0.2, 0.2}, 7)}) {
    ASSERT_EQ(s.slices.size(), 1U);
    EXPECT_EQ(s.slices[0].depth, 0.2);
    EXPECT_EQ(s.thickness, 0);
  }
}

// A wave on its slice compared with the wave itself, pixel by pixel, over the box of Eq. 14.
double measured_depth_error(double x, double y, double depth, double moved, const Grid& panel) {
  const PreparedWave wave = prepare_wave({{x, y, -depth}, 1, 0}, panel, green);
  PreparedWave on_slice = wave;
  on_slice.depth = depth + moved;
  double error = 0, energy = 0;
  for (int j = wave.box.y0; j < wave.box.y1; ++j)
    for (int i = wave.box.x0; i < wave.box.x1; ++i) {
      const auto u = wave_at(wave, panel.x(i), panel.y(j), green);
      error += std::norm(wave_at(on_slice, panel.x(i), panel.y(j), green) - u);
      energy += std::norm(u);
    }
  return std::sqrt(error / energy);
}

// 1 − cos θ is tan²θ/2 to 3/4·tan²θ ≤ 2e-3 here, and a phase φ of 0.01 rad gives an error of φ to 1e-5. A box of
// whole pixels differs from R by 1/2 pixel in 200: ρ⁴ to 1 %.
TEST(DepthError, IsThatOfAMovedWave) {
  const Grid panel{300, 201, 8_um};
  for (const double depth : {0.05_m, 0.2_m})
    for (const Vec2 at : {Vec2{0, 0}, Vec2{1_mm, -0.4_mm}, Vec2{2.2_mm, 0.9_mm}}) {
      const double per_metre = depth_error_per_metre(at.x, at.y, depth, panel, green), moved = 0.01 / per_metre;
      if (per_metre == 0) continue;
      EXPECT_NEAR(measured_depth_error(at.x, at.y, depth, moved, panel) / 0.01, 1, 0.015) << depth << " " << at.x;
    }
  EXPECT_EQ(depth_error_per_metre(5_mm, 0, 0.05_m, panel, green), 0);  // outside its box: R 1.66 mm, half width 1.2 mm
}

// closed_forms.md section 1: k·dz·(1 − cos θmax) = 6.5e-2 rad at dz = 10 µm for 8 µm, 532 nm. It is the phase at the
// middle of the box's side; its rms over a whole box is √0.6222 of that: ⟨(a² + b²)²⟩ = 2/5 + 2/9 in the unit square.
TEST(DepthError, HasTheBoundOfTheHalfAngle) {
  const Grid panel{2000, 2000, 8_um};
  EXPECT_NEAR(10_um * depth_error_per_metre(0, 0, 0.1_m, panel, green), 6.5e-2 * std::sqrt(0.4 + 2.0 / 9), 4e-4);
}

TEST(SliceSources, KeepTheToleranceAndCountWhatIsCut) {
  const Grid panel{200, 160, 8_um};
  const Sources sources = make_random_sources(500, panel, green, 0.2_m, 0.21_m);
  for (const double tolerance : {1e-1, 1e-2, 1e-3}) {
    const SlicedSources s = slice_sources(sources, panel, 0, tolerance);
    EXPECT_LE(s.expected_error, tolerance);
    EXPECT_GT(s.expected_error, tolerance / 4);  // evenly spread depths: 1/√3 of the ends' error, less with few
    EXPECT_EQ(s.cut_waves, 0);
  }
  Sources near = sources;
  for (Source& wave : near.waves) wave.origin.z += 0.19_m;  // boxes of at most 0.67 mm
  EXPECT_EQ(slice_sources(near, panel, 5, 1e-3).cut_waves, 500);
  EXPECT_EQ(slice_sources(near, panel, 5, 1e-3).depth.slices.size(), 5U);
}

// The transform of the points by its formula.
std::complex<double> direct(const std::vector<PointOnSlice>& points, int nx, int ny, int k, int l) {
  std::complex<double> sum = 0;
  for (const PointOnSlice& p : points)
    sum += std::complex<double>(p.strength) * std::polar(1.0, -2 * pi * (k * p.column / nx + l * p.row / ny));
  return sum;
}

TEST(SpreadPoints, HaveTheTransformOfThePointsWithinTheTolerance) {
  const int nx = 90, ny = 64, band_x = 40, band_y = 25;
  CounterRandom random(7, 0, 0);
  std::vector<PointOnSlice> points{{0, 0, {1, 0}}, {89.999, 63.5, {0, 1}}, {-30.25, 100.75, {1, 1}}};
  for (int i = 0; i < 60; ++i)
    points.push_back(
        {random.uniform() * nx, random.uniform() * ny, std::complex<float>(std::polar(1.0, 6.28 * random.uniform()))});
  for (const double tolerance : {1e-2, 1e-3, 1e-4, 1e-5}) {
    const SpreadKernel kernel = make_spread_kernel(tolerance);
    const int mx = spread_length(band_x, kernel), my = spread_length(band_y, kernel);
    const SliceSamples s = spread_points(points, kernel, nx, ny, mx, my);
    Array2D<std::complex<float>> all(my, mx);
    for (size_t r = 0; r < s.rows.size(); ++r) std::copy_n(s.values.row(int(r)), mx, all.row(s.rows[r]));
    fft_2d(all.values.data(), my, mx, FftDirection::forward);
    const auto x = spread_correction(kernel, mx, band_x), y = spread_correction(kernel, my, band_y);
    double error = 0, energy = 0;
    for (int l = -band_y; l <= band_y; ++l)
      for (int k = -band_x; k <= band_x; ++k) {
        const auto expected = direct(points, nx, ny, k, l);
        const auto found =
            std::complex<double>(all((l + my) % my, (k + mx) % mx)) * x[size_t(std::abs(k))] * y[size_t(std::abs(l))];
        error += std::norm(found - expected);
        energy += std::norm(expected);
      }
    EXPECT_LT(std::sqrt(error / energy), tolerance);
  }
}

// The mask of points on one slice.
Array2D<float> mask_of(const std::vector<PointOnSlice>& points, int nx, int ny) {
  return silhouette_of(points, silhouette_radii(points, std::vector<double>(points.size(), 0.0)), nx, ny);
}

TEST(Silhouette, OfALatticeCoversItWithoutHolesAndHardlyMore) {
  std::vector<PointOnSlice> points;
  for (int j = 0; j < 8; ++j)
    for (int i = 0; i < 10; ++i) points.push_back({20 + 3.3 * i, 15 + 3.3 * j, {1, 0}});
  const Array2D<float> mask = mask_of(points, 80, 70);
  for (int j = 0; j < 70; ++j)
    for (int i = 0; i < 80; ++i) {
      const double out_x = std::max({20.0 - i, i - (20 + 9 * 3.3), 0.0}),
                   out_y = std::max({15.0 - j, j - (15 + 7 * 3.3), 0.0});
      if (out_x == 0 && out_y == 0) {
        EXPECT_EQ(mask(j, i), 1) << j << " " << i;
      }
      // At a corner the fourth-nearest is 2 steps away: 2·3.3/√2 = 4.7 samples.
      if (std::hypot(out_x, out_y) > 4.7) {
        EXPECT_EQ(mask(j, i), 0) << j << " " << i;
      }
    }
}

TEST(Silhouette, OfALonePointIsItsSampleAndALostOneIsBounded) {
  Array2D<float> mask = mask_of({{12.3, 7.6, {}}}, 30, 20);
  EXPECT_EQ(mask(8, 12), 1);
  double sum = 0;
  for (const float m : mask.values) sum += m;
  EXPECT_EQ(sum, 1);
  // A point 100 samples from a lattice of step 2: at most three times the lattice's radius 2/√2 … 2·2/√2 at corners.
  std::vector<PointOnSlice> points{{150, 10, {}}};
  for (int i = 0; i < 25; ++i) points.push_back({10.0 + 2 * (i % 5), 10.0 + 2 * (i / 5), {}});
  mask = mask_of(points, 200, 60);
  EXPECT_EQ(mask(10, 150), 1);
  EXPECT_EQ(mask(10, 162), 0);
  EXPECT_EQ(mask(10, 80), 0);
}

// Neighbours are searched cell by cell; the result must not depend on the cells. Compared with a search of all pairs.
TEST(Silhouette, FindsTheFourthNeighbourWhereverPointsLie) {
  CounterRandom random(9, 0, 0);
  std::vector<PointOnSlice> points;
  for (int i = 0; i < 150; ++i) {  // some on a line, some scattered, some coincident
    const double x = 200 * random.uniform(), y = i % 3 == 0 ? 50 : 100 * random.uniform();
    points.push_back({x, y, {}});
    if (i % 10 == 0) points.push_back({x, y, {}});
  }
  std::vector<double> radii;
  for (const PointOnSlice& p : points) {
    std::vector<double> distances;
    for (const PointOnSlice& q : points) distances.push_back(std::hypot(p.column - q.column, p.row - q.row));
    std::sort(distances.begin(), distances.end());
    radii.push_back(distances[4] / std::sqrt(2.0));
  }
  std::vector<double> sorted = radii;
  std::sort(sorted.begin(), sorted.end());
  const double most = 3 * sorted[sorted.size() / 2];
  const Array2D<float> mask = mask_of(points, 260, 160);
  for (int j = 0; j < 130; ++j)
    for (int i = 0; i < 230; ++i) {
      bool is_covered = false;
      for (size_t n = 0; n < points.size(); ++n) {
        const double radius = std::clamp(radii[n], 0.5, most);
        is_covered = is_covered || std::hypot(points[n].column - i, points[n].row - j) <= radius * (1 + 1e-9) ||
                     (std::lround(points[n].column) == i && std::lround(points[n].row) == j);
      }
      EXPECT_EQ(mask(j, i), float(is_covered)) << j << " " << i;
    }
}

}  // namespace
}  // namespace holotrace
