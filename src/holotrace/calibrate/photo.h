#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "holotrace/calibrate/unknowns.h"
#include "holotrace/data/image.h"
#include "holotrace/view/register/channel.h"

namespace holotrace {

/// Pixels of a photograph that a calibration uses: inside the simulated window, and not saturated.
struct PhotoPixels {
  std::vector<float> u, v, value;  ///< place from the photograph's centre [pixels, u right, v down], and light
  std::vector<int> block;          ///< index of the block of 16 × 16 pixels
  int blocks = 0;
  double mean = 0;  ///< of the values, the unit of their errors

  size_t size() const { return value.size(); }
};

/// Chooses at most `most` pixels: all, or random ones, bright pixels more often than dark ones.
/// @param camera  an estimate of the camera's place
/// @throws Error  naming the photograph, if more than 10 % of its bright pixels are saturated, if it has no light, or
///                if too few of its pixels show the panel
PhotoPixels choose_pixels(const Channel& photograph, const Similarity& camera, const Grid& window, int most,
                          const std::string& name);

/// The mean of a picture over each camera pixel: of 2 × 2 places in it, which is exact for polynomials to degree 3. Places
/// beyond the picture give NaN.
Eigen::VectorXd seen_by(const PhotoPixels& pixels, const Similarity& camera, const Channel& picture);

/// The same, and its derivatives by a, b, x and y of the camera.
Eigen::VectorXd seen_by(const PhotoPixels& pixels, const Similarity& camera, const Channel& picture,
                        Eigen::Matrix<double, Eigen::Dynamic, 4>& slopes);

}  // namespace holotrace
