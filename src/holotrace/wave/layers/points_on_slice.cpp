#include "holotrace/wave/layers/points_on_slice.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>

#include "holotrace/base/fft.h"
#include "holotrace/base/threads.h"
#include "holotrace/base/units.h"

namespace holotrace {
namespace {

constexpr double oversampling = 1.25;
constexpr int most_width = 12;
constexpr int block_rows = 32;  // rows of the raster that one thread fills

struct Placed {
  int first = 0;      // index of the first sample, not wrapped
  double offset = 0;  // from the point to that sample
};

Placed place(double position, int width) {
  const double first = std::ceil(position - width / 2.0);
  return {int(first), first - position};
}

void kernel_values(const SpreadKernel& kernel, double offset, float* values) {
  for (int m = 0; m < kernel.width; ++m) values[m] = float(kernel.value(offset + m));
}

}  // namespace

SpreadKernel make_spread_kernel(double tolerance) {
  const double digits = std::log(1 / std::max(tolerance, 1e-7)) / (pi * std::sqrt(1 - 1 / oversampling));
  const int width = std::clamp(int(std::ceil(digits + 0.4)), 3, most_width);
  return {width, 0.97 * pi * width * (1 - 1 / (2 * oversampling))};
}

int spread_length(int band, const SpreadKernel& kernel) {
  return fft_good_length(std::max(int(std::ceil(oversampling * (2 * band + 1))), 2 * kernel.width));
}

std::vector<double> spread_correction(const SpreadKernel& kernel, int samples, int band) {
  std::vector<double> correction(size_t(band) + 1);
  parallel_for(0, band + 1, [&](int64_t k) { correction[size_t(k)] = 1 / kernel.moment(0, double(k) / samples); });
  return correction;
}

SliceSamples spread_points(const std::vector<PointOnSlice>& points, const SpreadKernel& kernel, int nx, int ny,
                           int samples_x, int samples_y) {
  const double across = double(samples_x) / nx, down = double(samples_y) / ny;
  // Sorts the points by their first row; points of one row keep their order.
  std::vector<uint32_t> start(size_t(samples_y) + 1), order(points.size());
  const auto first_row = [&](const PointOnSlice& p) {
    return size_t(wrapped(place(p.row * down, kernel.width).first, samples_y));
  };
  for (const PointOnSlice& p : points) ++start[first_row(p) + 1];
  std::partial_sum(start.begin(), start.end(), start.begin());
  std::vector<uint32_t> next(start.begin(), start.end() - 1);
  for (size_t i = 0; i < points.size(); ++i) order[next[first_row(points[i])]++] = uint32_t(i);

  SliceSamples s{samples_x, samples_y, {}, {}};
  std::vector<int> place_of_row(size_t(samples_y), -1);
  for (int j = 0; j < samples_y; ++j) {
    bool is_lit = false;
    for (int m = 0; m < kernel.width && !is_lit; ++m) {
      const size_t from = size_t(wrapped(j - m, samples_y));
      is_lit = start[from] < start[from + 1];
    }
    if (!is_lit) continue;
    place_of_row[size_t(j)] = int(s.rows.size());
    s.rows.push_back(j);
  }
  s.values = Array2D<std::complex<float>>(int(s.rows.size()), samples_x);

  parallel_for(0, (samples_y + block_rows - 1) / block_rows, [&](int64_t b) {
    const int begin = int(b) * block_rows, end = std::min(begin + block_rows, samples_y);
    float along_x[most_width], along_y[most_width];
    for (int j = begin - kernel.width + 1; j < end; ++j) {
      const size_t from = size_t(wrapped(j, samples_y));
      for (uint32_t n = start[from]; n < start[from + 1]; ++n) {
        const PointOnSlice& p = points[order[n]];
        const Placed x = place(p.column * across, kernel.width), y = place(p.row * down, kernel.width);
        kernel_values(kernel, x.offset, along_x);
        kernel_values(kernel, y.offset, along_y);
        for (int m = std::max(0, begin - j); m < std::min(kernel.width, end - j); ++m) {
          std::complex<float>* row = s.values.row(place_of_row[size_t(j + m)]);
          const std::complex<float> strength = p.strength * along_y[m];
          for (int i = 0, column = wrapped(x.first, samples_x); i < kernel.width; ++i) {
            row[column] += strength * along_x[i];
            if (++column == samples_x) column = 0;
          }
        }
      }
    }
  });
  return s;
}

namespace {

constexpr int neighbours = 4;
constexpr double most_over_median = 3;
constexpr double least_radius = 0.5;  // samples

// Points sorted into square cells of about two points each.
struct Cells {
  double left = 0, top = 0, side = 1;
  int columns = 1, rows = 1;
  std::vector<uint32_t> start, order;

  int column(const PointOnSlice& p) const { return std::min(int((p.column - left) / side), columns - 1); }
  int row(const PointOnSlice& p) const { return std::min(int((p.row - top) / side), rows - 1); }
};

Cells make_cells(const std::vector<PointOnSlice>& points) {
  Cells cells;
  double right = points[0].column, bottom = points[0].row;
  cells.left = right, cells.top = bottom;
  for (const PointOnSlice& p : points) {
    cells.left = std::min(cells.left, p.column), right = std::max(right, p.column);
    cells.top = std::min(cells.top, p.row), bottom = std::max(bottom, p.row);
  }
  const double width = right - cells.left, height = bottom - cells.top, count = double(points.size());
  // Side from the area or, for points on a line, from its length.
  cells.side = std::max({std::sqrt(width * height * 2 / count), (width + height) * 2 / count, 1e-3});
  cells.columns = int(width / cells.side) + 1, cells.rows = int(height / cells.side) + 1;
  const auto cell_of = [&](const PointOnSlice& p) {
    return size_t(cells.row(p)) * size_t(cells.columns) + size_t(cells.column(p));
  };
  cells.start.resize(size_t(cells.columns) * size_t(cells.rows) + 1);
  for (const PointOnSlice& p : points) ++cells.start[cell_of(p) + 1];
  for (size_t c = 1; c < cells.start.size(); ++c) cells.start[c] += cells.start[c - 1];
  std::vector<uint32_t> next(cells.start.begin(), cells.start.end() - 1);
  cells.order.resize(points.size());
  for (size_t i = 0; i < points.size(); ++i) cells.order[next[cell_of(points[i])]++] = uint32_t(i);
  return cells;
}

// The distance in the plane to the farthest of the four points (or fewer) that are nearest in space. It is 0 for a lone
// point, and where four points are so near that the disc has its least radius anyway.
double neighbour_distance(const std::vector<PointOnSlice>& points, const std::vector<double>& depths,
                          const Cells& cells, size_t index) {
  struct Neighbour {
    double space, plane;  // squared distances
    bool operator<(const Neighbour& other) const { return space < other.space; }
  };
  const PointOnSlice& p = points[index];
  const size_t wanted = std::min<size_t>(neighbours, points.size() - 1);
  if (wanted == 0) return 0;
  std::vector<Neighbour> found;
  size_t close = 0;
  const int column = cells.column(p), row = cells.row(p), most = std::max(cells.columns, cells.rows);
  for (int ring = 0; ring <= most; ++ring) {
    for (int j = std::max(0, row - ring); j <= std::min(cells.rows - 1, row + ring); ++j)
      for (int i = std::max(0, column - ring); i <= std::min(cells.columns - 1, column + ring); ++i) {
        if (std::max(std::abs(j - row), std::abs(i - column)) != ring) continue;
        const size_t cell = size_t(j) * size_t(cells.columns) + size_t(i);
        for (uint32_t n = cells.start[cell]; n < cells.start[cell + 1]; ++n) {
          const uint32_t other = cells.order[n];
          if (other == index) continue;
          const PointOnSlice& q = points[other];
          const double dz = depths[other] - depths[index];
          const double plane = (q.column - p.column) * (q.column - p.column) + (q.row - p.row) * (q.row - p.row);
          found.push_back({plane + dz * dz, plane});
          close += found.back().space <= 2 * least_radius * least_radius;
          if (close >= wanted) return 0;
        }
      }
    if (found.size() < wanted) continue;
    std::nth_element(found.begin(), found.begin() + int64_t(wanted - 1), found.end());
    const double reached = ring * cells.side;  // all points nearer than this have been visited
    if (found[wanted - 1].space <= reached * reached) break;
  }
  std::nth_element(found.begin(), found.begin() + int64_t(wanted - 1), found.end());
  double farthest = 0;
  for (size_t n = 0; n < wanted; ++n) farthest = std::max(farthest, found[n].plane);
  return std::sqrt(farthest);
}

}  // namespace

std::vector<double> silhouette_radii(const std::vector<PointOnSlice>& points, const std::vector<double>& depths) {
  std::vector<double> radii(points.size());
  if (points.empty()) return radii;
  const Cells cells = make_cells(points);
  parallel_for(
      0, int64_t(points.size()),
      [&](int64_t i) { radii[size_t(i)] = neighbour_distance(points, depths, cells, size_t(i)) / std::sqrt(2.0); }, {},
      64);
  std::vector<double> sorted = radii;
  std::nth_element(sorted.begin(), sorted.begin() + int64_t(sorted.size() / 2), sorted.end());
  const double most = std::max(most_over_median * sorted[sorted.size() / 2], least_radius);
  for (double& radius : radii) radius = std::clamp(radius, least_radius, most);
  return radii;
}

Array2D<float> silhouette_of(const std::vector<PointOnSlice>& points, const std::vector<double>& radii, int nx,
                             int ny) {
  Array2D<float> mask(ny, nx);
  for (size_t n = 0; n < points.size(); ++n) {
    const PointOnSlice& p = points[n];
    const double radius = radii[n] * (1 + 1e-9);
    mask(wrapped(int(std::lround(p.row)), ny), wrapped(int(std::lround(p.column)), nx)) = 1;
    for (int j = int(std::ceil(p.row - radius)); j <= int(std::floor(p.row + radius)); ++j) {
      const double half = std::sqrt(std::max(0.0, radius * radius - (j - p.row) * (j - p.row)));
      for (int i = int(std::ceil(p.column - half)); i <= int(std::floor(p.column + half)); ++i)
        mask(wrapped(j, ny), wrapped(i, nx)) = 1;
    }
  }
  return mask;
}

}  // namespace holotrace
