#include "holotrace/trace/lights/environment.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "holotrace/base/units.h"

namespace holotrace {

namespace {

/// The interval of an ascending table of cumulative shares that contains u, and the position of u in it, in [0, 1).
struct Interval {
  int index;
  double rest;
};

template <class Iterator>
Interval find_interval(Iterator begin, Iterator end, double u) {
  const auto found = std::upper_bound(begin, end - 1, u);
  const double low = found == begin ? 0 : *(found - 1), width = *found - low;
  return {int(found - begin), width > 0 ? std::min((u - low) / width, 1 - 0x1p-53) : 0.5};
}

double cosine_of_edge(int row, int ny) { return std::cos(pi * row / ny); }

}  // namespace

Vec2 environment_place(Vec3 direction, double turn) {
  const double x = 0.5 + (std::atan2(direction.x, -direction.z) + turn) / (2 * pi);
  return {x - std::floor(x), std::acos(std::clamp(direction.y, -1.0, 1.0)) / pi};
}

Vec3 environment_direction(Vec2 place, double turn) {
  const double azimuth = (place.x - 0.5) * 2 * pi - turn, sine = std::sin(pi * place.y);
  return {sine * std::sin(azimuth), std::cos(pi * place.y), -sine * std::cos(azimuth)};
}

EnvironmentLight::EnvironmentLight(const Environment& environment, const Lines& lines)
    : environment_(environment), lines_(lines), nx_(environment.map->nx), ny_(environment.map->ny) {
  means_.reserve(size_t(nx_) * size_t(ny_));
  cumulative_.reserve(means_.capacity());
  for (int row = 0; row < ny_; ++row) {
    double sum = 0;
    for (int column = 0; column < nx_; ++column) {
      // The mean of the bilinear radiance over a pixel has weights 1/8, 6/8, 1/8 along either axis.
      Vec3 mean;
      for (const int j : {-1, 0, 1})
        for (const int i : {-1, 0, 1})
          mean += pixel(row + j, column + i) * ((j == 0 ? 0.75 : 0.125) * (i == 0 ? 0.75 : 0.125));
      means_.push_back(float(mean.x + mean.y + mean.z));
      sum += double(means_.back());
      cumulative_.push_back(sum);
    }
    if (sum > 0)
      for (auto value = cumulative_.end() - nx_; value != cumulative_.end(); ++value) *value /= sum;
    total_ += sum * 2 * pi / nx_ * (cosine_of_edge(row, ny_) - cosine_of_edge(row + 1, ny_));
    rows_.push_back(total_);
  }
  if (total_ > 0)
    for (double& value : rows_) value /= total_;
}

/// The colour of a pixel at the lines; columns wrap around, rows are clamped.
Vec3 EnvironmentLight::pixel(int row, int column) const {
  const Image& map = *environment_.map;
  row = std::clamp(row, 0, ny_ - 1);
  column = (column % nx_ + nx_) % nx_;
  const Vec3 rgb = map.channels < 3 ? Vec3{1, 1, 1} * double(map(row, column))
                                    : Vec3{map(row, column, 0), map(row, column, 1), map(row, column, 2)};
  return lines_.from_rgb(environment_.scale * rgb);
}

Vec3 EnvironmentLight::radiance_at(Vec2 place) const {
  const double x = place.x * nx_ - 0.5, y = place.y * ny_ - 0.5, left = std::floor(x), top = std::floor(y);
  const double s = x - left, t = y - top;
  const int column = int(left), row = int(top);
  return (pixel(row, column) * (1 - s) + pixel(row, column + 1) * s) * (1 - t) +
         (pixel(row + 1, column) * (1 - s) + pixel(row + 1, column + 1) * s) * t;
}

Vec3 EnvironmentLight::radiance(Vec3 direction) const {
  return radiance_at(environment_place(direction, environment_.turn));
}

LightSample EnvironmentLight::sample(Vec2 u) const {
  if (!(total_ > 0)) return {};
  const Interval row = find_interval(rows_.begin(), rows_.end(), u.y);
  const auto begin = cumulative_.begin() + ptrdiff_t(row.index) * nx_;
  const Interval column = find_interval(begin, begin + nx_, u.x);
  const double top = cosine_of_edge(row.index, ny_), bottom = cosine_of_edge(row.index + 1, ny_);
  const Vec2 place{(column.index + column.rest) / nx_, std::acos(top + (bottom - top) * row.rest) / pi};
  const double density = double(means_[size_t(row.index) * size_t(nx_) + size_t(column.index)]) / total_;
  if (!(density > 0)) return {};
  return {environment_direction(place, environment_.turn), std::numeric_limits<double>::infinity(), radiance_at(place),
          density};
}

double EnvironmentLight::pdf(Vec3 direction) const {
  if (!(total_ > 0)) return 0;
  const Vec2 place = environment_place(direction, environment_.turn);
  const int row = std::min(int(place.y * ny_), ny_ - 1), column = std::min(int(place.x * nx_), nx_ - 1);
  return double(means_[size_t(row) * size_t(nx_) + size_t(column)]) / total_;
}

}  // namespace holotrace
