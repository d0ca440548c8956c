#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "holotrace/calibrate/bench.h"
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

/// Takes the mean of pictures over camera pixels, by cubic convolution at 2 × 2 Gaussian places in each, or in each part
/// of at most 1.5 samples of a larger pixel. All pictures have the size of `frame`.
class PixelMeans {
 public:
  PixelMeans(const PhotoPixels& pixels, const Similarity& camera, const Channel& frame);

  /// The means; NaN for pixels that the picture does not cover.
  Eigen::VectorXd of(const Channel& picture) const;

  /// Derivatives of the means by a, b, x and y of the camera; 0 for pixels that the picture does not cover.
  Eigen::Matrix<double, Eigen::Dynamic, 4> slopes_of(const Channel& picture) const;

 private:
  struct Place {
    double column, row;
  };
  Place place(double u, double v) const;
  bool covers(size_t pixel) const;

  const PhotoPixels& pixels_;
  Similarity camera_;
  int nx_, ny_;
  std::vector<double> places_;  // along a pixel's side, from its middle [pixels]
  int side_;                    // of the samples that a mean uses
  std::vector<int64_t> first_;  // the first of them; −1: not covered
  std::vector<float> weights_;  // side² for each pixel
};

}  // namespace holotrace
