#include <gtest/gtest.h>

#include <cmath>

#include "holotrace/base/keyframes.h"
#include "holotrace/base/quaternion.h"
#include "holotrace/base/units.h"

namespace holotrace {
namespace {

constexpr double rounding = 1e-14;  // of a few operations on numbers of about 1

double at(const Keyframes& keys, double time) { return value_at(keys, time).at(0); }

TEST(Keyframes, LinearValuesLieOnTheLineAndStayAtTheEnds) {
  const Keyframes keys{{0, 2, 3}, {{1}, {5}, {-1}}, Interpolation::linear};
  EXPECT_EQ(at(keys, -7), 1);
  EXPECT_EQ(at(keys, 0), 1);
  EXPECT_NEAR(at(keys, 0.5), 2, rounding);
  EXPECT_EQ(at(keys, 2), 5);
  EXPECT_NEAR(at(keys, 2.25), 3.5, rounding);
  EXPECT_EQ(at(keys, 3), -1);
  EXPECT_EQ(at(keys, 100), -1);
}

TEST(Keyframes, StepsKeepTheLastKey) {
  const Keyframes keys{{0, 2, 3}, {{1}, {5}, {-1}}, Interpolation::step};
  EXPECT_EQ(at(keys, 1.999), 1);
  EXPECT_EQ(at(keys, 2), 5);
  EXPECT_EQ(at(keys, 2.999), 5);
}

// Two keys at rest: the cubic 3t² − 2t³.
TEST(Keyframes, ASmoothCurveStartsAndEndsAtRest) {
  const Keyframes keys{{1, 3}, {{10}, {14}}, Interpolation::smooth};
  for (const double t : {0.1, 0.25, 0.5, 0.9})
    EXPECT_NEAR(at(keys, 1 + 2 * t), 10 + 4 * (3 * t * t - 2 * t * t * t), 10 * rounding) << t;
}

// On equal steps of a straight line the weighted mean of the slopes is that slope, so inner parts are the line itself.
TEST(Keyframes, ASmoothCurvePassesThroughItsKeysWithAContinuousSlope) {
  const Keyframes line{{0, 1, 2, 3}, {{0}, {2}, {4}, {6}}, Interpolation::smooth};
  for (const double t : {1.0, 1.3, 1.5, 2.0}) EXPECT_NEAR(at(line, t), 2 * t, rounding) << t;
  const Keyframes keys{{0, 1, 1.5, 4}, {{0}, {1}, {3}, {3.5}}, Interpolation::smooth};
  for (size_t k = 0; k < 4; ++k) EXPECT_EQ(at(keys, keys.times[k]), keys.values[k][0]);
  const double h = 1e-6;  // differences then have an error of about h
  for (const double t : {0.0, 1.0, 1.5, 4.0})
    EXPECT_NEAR((at(keys, t) - at(keys, t - h)) / h, (at(keys, t + h) - at(keys, t)) / h, 1e-4) << t;
  // The formula of Fritsch and Butland at t = 1: steps of 1 and 0.5 s, slopes of 1 and 4 per second.
  const double slope = 4.5 / ((2 * 0.5 + 1) / 1.0 + (0.5 + 2 * 1) / 4.0);
  EXPECT_NEAR((at(keys, 1 + h) - at(keys, 1 - h)) / (2 * h), slope, 1e-4);
}

TEST(Keyframes, ASmoothCurveRestsWhereTwoKeysAreEqualAndNeverLeavesTheirInterval) {
  const Keyframes keys{{0, 1, 2, 3}, {{0}, {7}, {7}, {1}}, Interpolation::smooth};
  for (double t = 1; t <= 2; t += 0.125) EXPECT_EQ(at(keys, t), 7) << t;
  for (double t = 0; t <= 3; t += 0.01) {
    EXPECT_GE(at(keys, t), 0) << t;
    EXPECT_LE(at(keys, t), 7) << t;
  }
}

// At a key between a rise and a fall the value is the greatest of all.
TEST(Keyframes, ASmoothCurveTurnsAtAKey) {
  const Keyframes keys{{0, 1, 3}, {{0}, {1}, {0.5}}, Interpolation::smooth};
  for (double t = 0; t <= 3; t += 0.01) EXPECT_LE(at(keys, t), 1) << t;
  EXPECT_EQ(at(keys, 1), 1);
}

// Rodrigues' formula about the axis (1, 2, 2)/3.
TEST(Quaternions, AreRotationsAboutTheirAxis) {
  const Vec3 axis{1.0 / 3, 2.0 / 3, 2.0 / 3}, p{0.3, -0.7, 0.2};
  for (const double angle : {0.1, 1.0, 2.0, 3.0, -3.0}) {
    const double s = std::sin(angle / 2), c = std::cos(angle), turn = std::sin(angle);
    const Frame rotation = rotation_by({axis.x * s, axis.y * s, axis.z * s, std::cos(angle / 2)});
    const Vec3 expected = p * c + cross(axis, p) * turn + axis * (dot(axis, p) * (1 - c));
    EXPECT_LT(length(transform_vector(rotation, p) - expected), rounding);
    const Frame again = rotation_by(quaternion_of(rotation));
    EXPECT_LT(length(transform_vector(again, p) - expected), rounding);
  }
}

TEST(Quaternions, SlerpTurnsEvenlyTheShortestWay) {
  const Quaternion start = quaternion_of(rotation_x(0.4)),
                   end = quaternion_of(compose(rotation_z(2.0), rotation_x(0.4)));
  const Quaternion opposite{-end[0], -end[1], -end[2], -end[3]};
  const Vec3 p{0.3, -0.7, 0.2};
  for (const double part : {0.0, 0.25, 0.5, 1.0})
    for (const Quaternion& to : {end, opposite}) {
      const Frame expected = compose(rotation_z(2.0 * part), rotation_x(0.4));
      const Frame turned = rotation_by(slerp(start, to, part));
      EXPECT_LT(length(transform_vector(turned, p) - transform_vector(expected, p)), rounding) << part;
    }
  EXPECT_EQ(slerp(start, start, 0.5), start);
}

}  // namespace
}  // namespace holotrace
