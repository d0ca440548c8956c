#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "holotrace/base/error.h"
#include "holotrace/data/eye_track.h"

// The eye of a viewer who walks, and where a display takes it to be.

namespace holotrace {
namespace {

constexpr double rounding = 1e-15;  // of places of a few hundred millimetres [m]

// A walk at 50 mm/s along x for 4 s, with 120 places per second.
EyeTrack straight_walk() {
  EyeTrack track;
  for (int i = 0; i <= 480; ++i) {
    track.times.push_back(i / 120.0);
    track.places.push_back({0.05 * i / 120.0, 0, 0.25});
  }
  return track;
}

TEST(EyeTrack, PlacesAreInterpolatedOnLinesAndRestAtTheEnds) {
  const EyeTrack track{{1, 2, 4}, {{0, 0, 0.3}, {0.01, 0.02, 0.2}, {0.01, -0.02, 0.4}}};
  EXPECT_LT(length(place_at(track, 1.25) - Vec3{0.0025, 0.005, 0.275}), rounding);
  EXPECT_LT(length(place_at(track, 3.5) - Vec3{0.01, -0.01, 0.35}), rounding);
  EXPECT_EQ(place_at(track, 2), track.places[1]);
  EXPECT_EQ(place_at(track, -3), track.places[0]);
  EXPECT_EQ(place_at(track, 9), track.places[2]);
}

// 50 mm/s · 20 ms = 1 mm. The predicted eye of a straight walk is that of the walk.
TEST(EyeTrack, AStraightWalkErrsByItsSpeedTimesTheLatency) {
  const EyeTrack track = straight_walk();
  for (const double time : {0.5, 1.2345, 3.9}) {
    const TrackedEye late = tracked_eye(track, {.latency = 0.02}, time);
    EXPECT_LT(length(late.place - Vec3{0.05 * time, 0, 0.25}), 10 * rounding);
    EXPECT_LT(length(late.place - late.measured - Vec3{0.001, 0, 0}), 10 * rounding);
    EXPECT_EQ(late.measured, late.unpredicted);
    EXPECT_TRUE(late.is_off());
    const TrackedEye predicted = tracked_eye(track, {.latency = 0.02, .is_predicted = true}, time);
    EXPECT_LT(length(predicted.place - predicted.measured), 10 * rounding);
    EXPECT_EQ(predicted.unpredicted, late.measured);
  }
}

// x = a·t²/2: x(t) − 2·x(t − L) + x(t − 2L) = a·L². Lines between places 1/1200 s apart err by up to a/8·(1/1200 s)².
TEST(EyeTrack, APredictionOfAnAcceleratedWalkErrsByItsAccelerationTimesTheSquaredLatency) {
  const double a = 0.8, step = 1 / 1200.0, latency = 0.05;
  EyeTrack track;
  for (int i = 0; i <= 2400; ++i) {
    track.times.push_back(i * step);
    track.places.push_back({0, a * i * step * i * step / 2, 0.25});
  }
  const TrackedEye eye = tracked_eye(track, {.latency = latency, .is_predicted = true}, 1.5);
  EXPECT_NEAR(eye.place.y - eye.measured.y, a * latency * latency, 4 * a / 8 * step * step);
}

TEST(EyeTrack, WithoutLatencyAndNoiseTheMeasuredEyeIsTheEye) {
  const EyeTrack track = straight_walk();
  for (const bool is_predicted : {false, true})
    EXPECT_FALSE(tracked_eye(track, {.is_predicted = is_predicted}, 1.7).is_off());
}

// The mean of N numbers of variance σ² has the standard error σ/√N, their variance σ²·√(2/N), a product of two independent
// ones σ²/√N. With a prediction, m(t − L) counts twice and m(t − 2L) once: the variance is 5σ². The bounds are 4 standard errors.
TEST(EyeTrack, NoiseHasItsStandardDeviationAlongEachAxisAndNoMean) {
  const EyeTrack track{{0, 1000}, {{0, 0, 0.25}, {0, 0, 0.25}}};
  constexpr int count = 20000;
  const double sigma = 0.4e-3;
  for (const bool is_predicted : {false, true}) {
    const double variance = (is_predicted ? 5 : 1) * sigma * sigma;
    Vec3 sum, squares, products;
    for (int i = 0; i < count; ++i) {
      const TrackedEye eye =
          tracked_eye(track, {.latency = 0.02, .noise = sigma, .is_predicted = is_predicted}, 1 + i * 0.04123);
      const Vec3 d = eye.measured - eye.place;
      sum = sum + d;
      squares = squares + d * d;
      products = products + Vec3{d.x * d.y, d.y * d.z, d.z * d.x};
    }
    for (const auto& [mean, square, product] :
         {std::array{sum.x, squares.x, products.x}, std::array{sum.y, squares.y, products.y},
          std::array{sum.z, squares.z, products.z}}) {
      EXPECT_LT(std::abs(mean / count), 4 * std::sqrt(variance / count));
      EXPECT_NEAR(square / count, variance, 4 * variance * std::sqrt(2.0 / count));
      EXPECT_LT(std::abs(product / count), 4 * variance / std::sqrt(count));
    }
  }
}

// Any film that has a time measures the same eye then.
TEST(EyeTrack, NoiseDependsOnTheSeedAndTheTime) {
  const EyeTrack track = straight_walk();
  const auto measured = [&](int64_t seed, double time) {
    return tracked_eye(track, {.latency = 0.02, .noise = 1e-3, .seed = seed}, time).measured;
  };
  EXPECT_EQ(measured(1, 0.5), measured(1, 0.5));
  EXPECT_NE(measured(1, 0.5).x, measured(2, 0.5).x);
  EXPECT_NE(measured(1, 0.5).y, measured(1, 0.50001).y);
}

TEST(EyeTrack, BadParametersAreErrors) {
  const EyeTrack track = straight_walk();
  EXPECT_THROW(tracked_eye(track, {.latency = -0.01}, 1), Error);
  EXPECT_THROW(tracked_eye(track, {.noise = NAN}, 1), Error);
  EXPECT_THROW(tracked_eye(track, {.noise = 100}, 1.2), Error);  // behind the panel
}

}  // namespace
}  // namespace holotrace
