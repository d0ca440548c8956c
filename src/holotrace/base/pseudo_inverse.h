#pragma once

#include <Eigen/Core>

namespace holotrace {

/// The pseudo-inverse A⁺ of a matrix of n × 3: A⁺·b is the shortest of the vectors x with the least |A·x − b|.
/// Singular values below `threshold` times the largest count as 0. A⁺ comes from AᵀA, so its relative error is 1e-16
/// times the square of the ratio of the largest to the smallest singular value that counts.
Eigen::Matrix3Xd pseudo_inverse(const Eigen::MatrixX3d& matrix, double threshold = 1e-7);

}  // namespace holotrace
