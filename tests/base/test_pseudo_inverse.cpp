#include <gtest/gtest.h>

#include "holotrace/base/pseudo_inverse.h"

namespace holotrace {
namespace {

// Rounding of doubles, 1e-16, times the squared condition number of these matrices, below 100, with a reserve.
constexpr double rounding = 1e-13;

double greatest(const Eigen::MatrixXd& m) { return m.cwiseAbs().maxCoeff(); }

TEST(PseudoInverse, OfIndependentColumnsIsAnInverseFromTheLeft) {
  Eigen::MatrixX3d a(5, 3);
  a << 2, 0, 1, 1, 3, -1, 0, 1, 2, -1, 1, 1, 0.5, -2, 1;
  EXPECT_LT(greatest(pseudo_inverse(a) * a - Eigen::Matrix3d::Identity()), rounding);
}

TEST(PseudoInverse, OfFewerRowsIsAnInverseFromTheRight) {
  Eigen::MatrixX3d a(2, 3);
  a << 2, 0, 1, 1, 3, -1;
  const Eigen::Matrix3Xd inverse = pseudo_inverse(a);
  ASSERT_EQ(inverse.cols(), 2);
  EXPECT_LT(greatest(a * inverse - Eigen::Matrix2d::Identity()), rounding);
  // The shortest solutions: no part of them is normal to the rows.
  const Eigen::Vector3d normal(-1, 1, 2);
  EXPECT_LT(greatest(normal.transpose() * inverse), rounding);
}

TEST(PseudoInverse, OfADyadHasAClosedForm) {
  const Eigen::Vector4d u(1, -2, 0.5, 3);
  const Eigen::Vector3d v(0.3, 1, -2);
  const Eigen::MatrixX3d a = u * v.transpose();
  const Eigen::MatrixXd expected = v * u.transpose() / (u.squaredNorm() * v.squaredNorm());
  EXPECT_LT(greatest(pseudo_inverse(a) - expected), rounding);
}

TEST(PseudoInverse, LeavesOutSingularValuesBelowTheThreshold) {
  Eigen::MatrixX3d a = Eigen::Matrix3d::Zero();
  a(0, 0) = 100, a(1, 1) = 1, a(2, 2) = 1e-2;
  const Eigen::Matrix3Xd all = pseudo_inverse(a, 0.9e-4), two = pseudo_inverse(a, 1.1e-4);
  EXPECT_NEAR(all(2, 2), 100, 1e-8);
  EXPECT_EQ(two(2, 2), 0);
  EXPECT_NEAR(two(1, 1), 1, rounding);
}

TEST(PseudoInverse, OfZerosIsZero) { EXPECT_EQ(greatest(pseudo_inverse(Eigen::MatrixX3d::Zero(4, 3))), 0); }

}  // namespace
}  // namespace holotrace
