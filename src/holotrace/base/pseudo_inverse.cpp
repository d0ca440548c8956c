#include "holotrace/base/pseudo_inverse.h"

#include <Eigen/Eigenvalues>

namespace holotrace {

Eigen::Matrix3Xd pseudo_inverse(const Eigen::MatrixX3d& matrix, double threshold) {
  const Eigen::Matrix3d square = matrix.transpose().lazyProduct(matrix);
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> parts(square);
  const Eigen::Vector3d squares = parts.eigenvalues();  // of the singular values, from the least to the largest
  const double least = threshold * threshold * squares[2];
  Eigen::Matrix3Xd inverse = Eigen::Matrix3Xd::Zero(3, matrix.rows());
  for (int part = 0; part < 3; ++part) {
    if (squares[part] <= least) continue;
    const Eigen::Vector3d direction = parts.eigenvectors().col(part);
    const Eigen::Vector3d scaled = direction / squares[part];
    for (Eigen::Index row = 0; row < matrix.rows(); ++row) inverse.col(row) += scaled * matrix.row(row).dot(direction);
  }
  return inverse;
}

}  // namespace holotrace
