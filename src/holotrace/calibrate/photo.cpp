#include "holotrace/calibrate/photo.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "holotrace/base/error.h"
#include "holotrace/base/random.h"
#include "holotrace/base/threads.h"

namespace holotrace {
namespace {

constexpr int block_side = 16;  // [pixels], as in view/register/similarity_search.h
constexpr double margin = 4;    // of the window, for steps of the camera's place [samples]
constexpr size_t least_pixels = 1000;
constexpr double most_saturated = 0.1;  // of the pixels brighter than the mean
constexpr double even_share = 0.1;      // least probability of a pixel relative to one of mean brightness

constexpr double gauss = 0.28867513459481287;  // 1/(2√3), the place of Gauss's two points on a side of 1
constexpr double longest_part = 1.5;           // of a pixel's side [samples]

}  // namespace

PhotoPixels choose_pixels(const Channel& photograph, const Similarity& camera, const Grid& window, int most,
                          const std::string& name) {
  const Channel frame(window.ny, window.nx);
  PhotoPixels all;
  const int across = (photograph.nx + block_side - 1) / block_side;
  all.blocks = across * ((photograph.ny + block_side - 1) / block_side);
  const float top = *std::max_element(photograph.values.begin(), photograph.values.end());
  require(top > 0, "{}: expected a photograph with light, got a black one; check the exposure", name);
  size_t bright = 0, saturated = 0;
  double sum = 0;
  for (int j = 0; j < photograph.ny; ++j)
    for (int i = 0; i < photograph.nx; ++i) {
      const double u = i - photograph.u_centre(), v = j - photograph.v_centre();
      const auto [x, y] = camera(u, v);
      if (std::abs(x) > frame.u_centre() - margin || std::abs(y) > frame.v_centre() - margin) continue;
      all.u.push_back(float(u));
      all.v.push_back(float(v));
      all.value.push_back(photograph(j, i));
      all.block.push_back(i / block_side + across * (j / block_side));
      sum += photograph(j, i);
    }
  require(
      all.size() >= least_pixels,
      "{}: expected at least {} pixels that show the panel, got {}; move the camera nearer or use one with more pixels",
      name, least_pixels, all.size());
  all.mean = sum / double(all.size());
  // A pixel at the largest value is saturated if others are, too.
  std::vector<bool> is_saturated(all.size());
  for (size_t i = 0; i < all.size(); ++i) {
    bright += all.value[i] > all.mean;
    is_saturated[i] = all.value[i] >= 0.999F * top;
    saturated += is_saturated[i];
  }
  const bool is_clipped = saturated > 8;
  require(
      !is_clipped || double(saturated) <= most_saturated * double(bright),
      "{}: expected a photograph whose brightest pixels differ, got {} pixels at the largest value; it is saturated: "
      "expose for a shorter time",
      name, saturated);
  PhotoPixels chosen;
  chosen.blocks = all.blocks;
  chosen.mean = all.mean;
  const double share = double(most) / double(all.size());
  for (size_t i = 0; i < all.size(); ++i) {
    if (is_clipped && is_saturated[i]) continue;
    const double bias = std::max(even_share, double(all.value[i]) / all.mean);
    if (share < 1 && CounterRandom(1, 0, i).uniform() > share * bias) continue;
    chosen.u.push_back(all.u[i]);
    chosen.v.push_back(all.v[i]);
    chosen.value.push_back(all.value[i]);
    chosen.block.push_back(all.block[i]);
  }
  return chosen;
}

PixelMeans::PixelMeans(const PhotoPixels& pixels, const Similarity& camera, const Channel& frame)
    : pixels_(pixels), camera_(camera), nx_(frame.nx), ny_(frame.ny), first_(pixels.size(), -1) {
  const double size = std::hypot(camera.a, camera.b);
  const int parts = std::max(1, int(std::ceil(size / longest_part)));
  for (int k = 0; k < parts; ++k)
    for (const double at : {-gauss, gauss}) places_.push_back((k + 0.5 + at) / parts - 0.5);
  const int reach = int(std::ceil(size * std::sqrt(0.5)));  // from a pixel's middle to its corner
  side_ = 2 * reach + 4;
  weights_.assign(pixels.size() * size_t(side_) * size_t(side_), 0);
  parallel_for(
      0, int64_t(pixels.size()),
      [&](int64_t n) {
        const auto i = size_t(n);
        if (!covers(i)) return;
        const Place middle = place(pixels.u[i], pixels.v[i]);
        const int column = int(std::floor(middle.column)) - 1 - reach, row = int(std::floor(middle.row)) - 1 - reach;
        first_[i] = int64_t(row) * nx_ + column;
        float* to = weights_.data() + i * size_t(side_) * size_t(side_);
        const double part = 1.0 / double(places_.size() * places_.size());
        for (const double du : places_)
          for (const double dv : places_) {
            const Place p = place(pixels.u[i] + du, pixels.v[i] + dv);
            double across[4], down[4], ignored[4];
            cubic_weights(p.column - std::floor(p.column), across, ignored);
            cubic_weights(p.row - std::floor(p.row), down, ignored);
            const int x = int(std::floor(p.column)) - 1 - column, y = int(std::floor(p.row)) - 1 - row;
            for (int k = 0; k < 4; ++k)
              for (int l = 0; l < 4; ++l) to[(y + k) * side_ + x + l] += float(part * down[k] * across[l]);
          }
      },
      {}, 1024);
}

PixelMeans::Place PixelMeans::place(double u, double v) const {
  const auto [x, y] = camera_(u, v);
  return {x + (nx_ - 1) / 2.0, y + (ny_ - 1) / 2.0};
}

// Whether the picture has all samples that the mean may use.
bool PixelMeans::covers(size_t pixel) const {
  const Place p = place(pixels_.u[pixel], pixels_.v[pixel]);
  return p.column >= side_ && p.row >= side_ && p.column < nx_ - side_ && p.row < ny_ - side_;
}

Eigen::VectorXd PixelMeans::of(const Channel& picture) const {
  Eigen::VectorXd means(Eigen::Index(first_.size()));
  parallel_for(
      0, int64_t(first_.size()),
      [&](int64_t i) {
        means[i] = std::numeric_limits<double>::quiet_NaN();
        if (first_[size_t(i)] < 0) return;
        const float* values = picture.values.data() + first_[size_t(i)];
        const float* weights = weights_.data() + size_t(i) * size_t(side_) * size_t(side_);
        double sum = 0;
        for (int y = 0; y < side_; ++y, values += nx_, weights += side_) {
          float row = 0;
          for (int x = 0; x < side_; ++x) row += weights[x] * values[x];
          sum += row;
        }
        means[i] = sum;
      },
      {}, 1024);
  return means;
}

Eigen::Matrix<double, Eigen::Dynamic, 4> PixelMeans::slopes_of(const Channel& picture) const {
  Eigen::Matrix<double, Eigen::Dynamic, 4> slopes(Eigen::Index(first_.size()), 4);
  parallel_for(
      0, int64_t(first_.size()),
      [&](int64_t n) {
        const auto i = size_t(n);
        Eigen::RowVector4d sum = Eigen::RowVector4d::Zero();
        if (first_[i] >= 0)
          for (const double du : places_)
            for (const double dv : places_) {
              const double u = pixels_.u[i] + du, v = pixels_.v[i] + dv;
              const Place p = place(u, v);
              const Sample s = sample_cubic(picture, p.column, p.row);
              sum += Eigen::RowVector4d(s.slope_u * u + s.slope_v * v, s.slope_v * u - s.slope_u * v, s.slope_u,
                                        s.slope_v);
            }
        slopes.row(n) = sum / double(places_.size() * places_.size());
      },
      {}, 1024);
  return slopes;
}

}  // namespace holotrace
