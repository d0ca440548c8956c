#include "holotrace/calibrate/photo.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "holotrace/base/error.h"
#include "holotrace/base/random.h"
#include "holotrace/base/threads.h"

namespace holotrace {
namespace {

constexpr int block_side = 16;  // [pixels], as in view/register/refine.h
constexpr double margin = 4;    // of the window, for steps of the camera's place [samples]
constexpr size_t least_pixels = 1000;
constexpr double most_saturated = 0.1;  // of the pixels brighter than the mean
constexpr double even_share = 0.1;       // least probability of a pixel relative to one of mean brightness

struct Place {
  double column, row;
};

Place place_in(const Similarity& camera, const Channel& picture, double u, double v) {
  const auto [x, y] = camera(u, v);
  return {x + picture.u_centre(), y + picture.v_centre()};
}

// Gauss's two points on a pixel's side.
constexpr double gauss = 0.28867513459481287;  // 1/(2√3)

template <class Take>
bool over_pixel(const Similarity& camera, const Channel& picture, double u, double v, const Take& take) {
  for (const double du : {-gauss, gauss})
    for (const double dv : {-gauss, gauss}) {
      const Place p = place_in(camera, picture, u + du, v + dv);
      if (!holds_cubic(picture, p.column, p.row)) return false;
      take(sample_cubic(picture, p.column, p.row), u + du, v + dv);
    }
  return true;
}

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
      const Place p = place_in(camera, frame, u, v);
      if (p.column < margin || p.row < margin || p.column > window.nx - 1 - margin || p.row > window.ny - 1 - margin)
        continue;
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

Eigen::VectorXd seen_by(const PhotoPixels& pixels, const Similarity& camera, const Channel& picture) {
  Eigen::VectorXd seen(Eigen::Index(pixels.size()));
  parallel_for(
      0, int64_t(pixels.size()),
      [&](int64_t i) {
        double sum = 0;
        const bool is_inside = over_pixel(camera, picture, pixels.u[size_t(i)], pixels.v[size_t(i)],
                                          [&](const Sample& s, double, double) { sum += s.value / 4; });
        seen[i] = is_inside ? sum : std::numeric_limits<double>::quiet_NaN();
      },
      {}, 1024);
  return seen;
}

Eigen::VectorXd seen_by(const PhotoPixels& pixels, const Similarity& camera, const Channel& picture,
                        Eigen::Matrix<double, Eigen::Dynamic, 4>& slopes) {
  Eigen::VectorXd seen(Eigen::Index(pixels.size()));
  slopes.resize(Eigen::Index(pixels.size()), 4);
  parallel_for(
      0, int64_t(pixels.size()),
      [&](int64_t i) {
        double sum = 0;
        Eigen::RowVector4d slope = Eigen::RowVector4d::Zero();
        const bool is_inside = over_pixel(
            camera, picture, pixels.u[size_t(i)], pixels.v[size_t(i)], [&](const Sample& s, double u, double v) {
              sum += s.value / 4;
              slope += Eigen::RowVector4d(s.slope_u * u + s.slope_v * v, s.slope_v * u - s.slope_u * v, s.slope_u,
                                          s.slope_v) /
                       4;
            });
        seen[i] = is_inside ? sum : std::numeric_limits<double>::quiet_NaN();
        slopes.row(i) = slope;
      },
      {}, 1024);
  return seen;
}

}  // namespace holotrace
