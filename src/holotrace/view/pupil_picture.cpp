#include "holotrace/view/pupil_picture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <vector>

#include "holotrace/base/array.h"
#include "holotrace/base/error.h"
#include "holotrace/base/fft.h"
#include "holotrace/base/threads.h"
#include "holotrace/base/units.h"
#include "holotrace/data/acceptance.h"
#include "holotrace/data/grid.h"
#include "holotrace/data/params/parameter.h"

namespace holotrace {
namespace {

/// What the pixels of one column (or row) have in common: the cells that the footprint touches along one axis.
struct AxisCells {
  int first = 0, count = 0;      // touched cells; 0 if none
  std::vector<double> edges;     // their count + 1 borders, from the disc's centre in radii, within −1 … 1
  std::vector<double> segments;  // area of the disc below each border
  std::vector<double> places;    // for each cell: where its picture is read, in pixels along this axis
  std::vector<double> open;      // for each cell: the part of it that light reaches; 1 where edges leave the rest out
};

/// One axis of the lens, and how rays cross it. Places grow with the index of cells and pixels: y points down here.
struct Axis {
  double lens_low, cell;  // border of the first cell, and size of a cell [m]
  int cells;
  double panel_low, panel_high;   // sides of the panel [m]
  double view_first, view_pitch;  // centre of the first pixel of the cells' pictures, and their pitch [m]
  double eye;                     // centre of the pupil [m]
};

struct Geometry {
  double distance, view_distance;  // planes of the picture, and of the cells' pictures, from the lens [m]
  double share;                    // (d + l)/(d + e_z)
  double radius;                   // of the footprint [m]
  double reach;                    // of the acceptance box [m]
  double beyond_panel;             // (d + l)/d: the panel on the lens, as a point of the picture sees it
};

/// Whether pupils lie in the lens: the footprint of all pixels is then the pupil itself.
bool is_same_for_all(const Geometry& geometry) { return geometry.share == 1; }

AxisCells touched_cells(const Axis& axis, const Geometry& geometry, double pixel) {
  const bool is_same = is_same_for_all(geometry);
  // Rounding must not give pixels of one footprint different cells.
  const double centre = is_same ? axis.eye : pixel + (axis.eye - pixel) * geometry.share;
  const auto on_lens = [&](double side) { return pixel + (side - pixel) * geometry.beyond_panel; };
  const double lens_high = axis.lens_low + axis.cell * axis.cells;
  // Rays through a place in front of the panel cross there: its low side is then on the lens's high side.
  const double one = on_lens(axis.panel_low), other = on_lens(axis.panel_high);
  const double low_open = std::max({axis.lens_low, pixel - geometry.reach, std::min(one, other)});
  const double high_open = std::min({lens_high, pixel + geometry.reach, std::max(one, other)});
  AxisCells result;
  if (!(std::max(low_open, centre - geometry.radius) < std::min(high_open, centre + geometry.radius))) return result;
  // What cuts the footprint of this pixel: nothing but the lens if all pixels have the same one, whose areas are found once.
  const double low = std::max(is_same ? axis.lens_low : low_open, centre - geometry.radius);
  const double high = std::min(is_same ? lens_high : high_open, centre + geometry.radius);
  result.first = std::clamp(int((low - axis.lens_low) / axis.cell), 0, axis.cells - 1);
  const int last = std::clamp(int(std::ceil((high - axis.lens_low) / axis.cell)) - 1, result.first, axis.cells - 1);
  result.count = last - result.first + 1;
  for (int i = 0; i <= result.count; ++i) {
    const double border = std::clamp(axis.lens_low + axis.cell * (result.first + i), low, high);
    const double edge = std::clamp((border - centre) / geometry.radius, -1.0, 1.0);
    result.edges.push_back(edge);
    result.segments.push_back(disc_area_below(edge));
  }
  for (int i = 0; i < result.count; ++i) {
    const double from = axis.lens_low + axis.cell * (result.first + i);
    const double seen_low = std::max(from, low_open), seen_high = std::min(from + axis.cell, high_open);
    result.open.push_back(is_same ? std::max(0.0, seen_high - seen_low) / axis.cell : 1);
    const double place = (seen_low + seen_high) / 2;
    const double at = place + (pixel - place) * geometry.view_distance / geometry.distance;
    result.places.push_back((at - axis.view_first) / axis.view_pitch);
  }
  return result;
}

/// Places between pixels as two pixels and the share of the second one; the nearest pixel outside.
struct Between {
  int first, second;
  float share;
};

Between between(double place, int count) {
  const double inside = std::clamp(place, 0.0, double(count - 1));
  // Places on a pixel, but for rounding, need no other pixel.
  const int nearest = int(std::lround(inside));
  if (std::abs(inside - nearest) < 1e-6) return {nearest, nearest, 0};
  const int first = int(inside);
  return {first, first + 1, float(inside - first)};
}

void add_bilinear(const Image& view, const Between& x, const Between& y, float weight, float* sum) {
  const size_t channels = size_t(view.channels), width = size_t(view.nx);
  const auto add = [&](int row, int column, float share) {
    const float* values = &view.values[(size_t(row) * width + size_t(column)) * channels];
    for (size_t c = 0; c < channels; ++c) sum[c] += share * values[c];
  };
  add(y.first, x.first, weight * (1 - x.share) * (1 - y.share));
  if (x.share > 0) add(y.first, x.second, weight * x.share * (1 - y.share));
  if (y.share > 0) add(y.second, x.first, weight * (1 - x.share) * y.share);
  if (x.share > 0 && y.share > 0) add(y.second, x.second, weight * x.share * y.share);
}

/// Area of the disc up to two borders, one along each axis.
double corner_area(const AxisCells& x, const AxisCells& y, size_t i, size_t j) {
  const double u = x.edges[i], v = y.edges[j];
  if (u <= -1 || v <= -1) return 0;
  if (u >= 1) return y.segments[j];
  if (v >= 1) return x.segments[i];
  return disc_area_below(u, v);
}

/// Area of the disc in each of the touched cells [radii²], row by row.
void find_areas(const AxisCells& x, const AxisCells& y, std::vector<double>& areas) {
  areas.resize(size_t(x.count) * size_t(y.count));
  for (int j = 0; j < y.count; ++j) {
    double above = corner_area(x, y, 0, size_t(j)), below = corner_area(x, y, 0, size_t(j) + 1);
    for (int i = 0; i < x.count; ++i) {
      const double above_next = corner_area(x, y, size_t(i) + 1, size_t(j));
      const double below_next = corner_area(x, y, size_t(i) + 1, size_t(j) + 1);
      areas[size_t(j) * size_t(x.count) + size_t(i)] = below_next - below - (above_next - above);
      above = above_next;
      below = below_next;
    }
  }
}

/// Adds the pictures of all cells that the footprint of one pixel touches. @return area of the footprint [radii²]
double add_cells(const LightField& field, const AxisCells& x, const AxisCells& y, const std::vector<double>& areas,
                 float* sum) {
  double total = 0;
  for (int j = 0; j < y.count; ++j) {
    const Between row = between(y.places[size_t(j)], field.plane.ny);
    for (int i = 0; i < x.count; ++i) {
      const double area = areas[size_t(j) * size_t(x.count) + size_t(i)] * x.open[size_t(i)] * y.open[size_t(j)];
      if (area < 1e-9) continue;
      total += area;
      const size_t cell = size_t(y.first + j) * size_t(field.columns) + size_t(x.first + i);
      add_bilinear(field.views[cell], between(x.places[size_t(i)], field.plane.nx), row, float(area), sum);
    }
  }
  return total;
}

Image make_image(const Grid& grid, int channels) {
  Image image(grid.ny, grid.nx, channels);
  image.pitch = grid.pitch;
  image.centre_x = grid.centre_x;
  image.centre_y = grid.centre_y;
  return image;
}

}  // namespace

PupilPicture picture_through(const LightField& light_field, double wavelength, const Grid& grid, double distance,
                             const Pupil& pupil) {
  check_light_field(light_field);
  check_grid(light_field.panel);
  check_wavelength(wavelength);
  check_grid(grid);
  check_range(pupil.diameter, range::positive, Quantity::length, " for the pupil's diameter");
  check_range(pupil.centre.z, range::positive, Quantity::length, " for the pupil's distance from the panel");
  require(
      std::isfinite(distance) && distance != 0 && distance + light_field.lens_z != 0 && distance + pupil.centre.z > 0,
      "expected a picture in a plane behind the pupil, other than those of the panel and the lens, got one at {}",
      format_length(distance));
  require(is_finite(pupil.centre), "expected a pupil at a finite place, got one that is not");

  require(pupil.centre.z >= light_field.lens_z,
          "expected a pupil on the lens of the light field or in front of it, got one behind it");

  const double from_lens = distance + light_field.lens_z, share = from_lens / (distance + pupil.centre.z);
  const Grid &panel = light_field.panel, &view = light_field.plane;
  const Geometry geometry{from_lens,
                          light_field.distance + light_field.lens_z,
                          share,
                          pupil.diameter / 2 * std::abs(share),
                          box_radius(std::abs(from_lens), wavelength, panel.pitch),
                          from_lens / distance};
  const Axis across{light_field.left(),
                    light_field.cell_width(),
                    light_field.columns,
                    panel.x(-0.5),
                    panel.x(panel.nx - 0.5),
                    view.x(0),
                    view.pitch,
                    pupil.centre.x};
  const Axis down{-light_field.top(),
                  light_field.cell_height(),
                  light_field.rows,
                  -panel.y(-0.5),
                  -panel.y(panel.ny - 0.5),
                  -view.y(0),
                  view.pitch,
                  -pupil.centre.y};
  std::vector<AxisCells> columns;
  for (int column = 0; column < grid.nx; ++column) columns.push_back(touched_cells(across, geometry, grid.x(column)));

  const auto lit = std::find_if(columns.begin(), columns.end(), [](const AxisCells& cells) { return cells.count > 0; });
  const int channels = light_field.views.front().channels;
  PupilPicture picture{make_image(grid, channels), make_image(grid, 1)};
  parallel_for(0, grid.ny, [&](int64_t row) {
    const AxisCells rows = touched_cells(down, geometry, -grid.y(double(row)));
    if (rows.count == 0) return;
    std::vector<double> areas;
    const bool is_same = is_same_for_all(geometry);
    if (is_same && lit != columns.end()) find_areas(*lit, rows, areas);
    for (int column = 0; column < grid.nx; ++column) {
      const AxisCells& cells = columns[size_t(column)];
      if (cells.count == 0) continue;
      if (!is_same) find_areas(cells, rows, areas);
      std::array<float, 3> sum{};
      const double area = add_cells(light_field, cells, rows, areas, sum.data());
      if (!(area > 0)) continue;
      picture.open(int(row), column) = float(std::min(1.0, area / pi));
      for (int c = 0; c < channels; ++c) picture.radiance(int(row), column, c) = sum[size_t(c)] / float(area);
    }
  });
  return picture;
}

PupilBlur::PupilBlur(int columns, int rows, double pitch, double wavelength, double distance, double diameter)
    : columns_(columns), rows_(rows) {
  check_wavelength(wavelength);
  require(columns > 0 && rows > 0, "expected a picture with pixels");
  require(pitch > 0 && distance > 0 && diameter > 0,
          "expected a pitch, a distance and a diameter of a pupil above 0 m, got {}, {} and {} m", pitch, distance,
          diameter);
  const double cutoff = diameter / (wavelength * distance) * pitch;  // [cycles per pixel]
  // Beyond three Airy radii hardly any light is left; edges are continued by reflection that far.
  const auto rim = [&](int count) { return std::min(count, int(std::ceil(3 * 1.22 / cutoff))); };
  left_ = rim(columns), top_ = rim(rows);
  transfer_ = Array2D<float>(fft_good_length(rows + 2 * top_), fft_good_length(columns + 2 * left_));
  const int nx = transfer_.nx, ny = transfer_.ny;
  parallel_for(0, ny, [&](int64_t j) {
    const double v = std::abs(double(signed_frequency(int(j), ny))) / ny;
    for (int i = 0; i < nx; ++i) {
      const double u = std::hypot(double(signed_frequency(i, nx)) / nx, v) / cutoff;
      const double h = u < 1 ? 2 / pi * (std::acos(u) - u * std::sqrt((1 - u) * (1 + u))) : 0;
      transfer_(int(j), i) = float(h / (double(nx) * ny));
    }
  });
}

void PupilBlur::apply(std::span<const PictureChannel> pictures) const {
  for (const PictureChannel& one : pictures)
    require(one.picture->nx == columns_ && one.picture->ny == rows_,
            "expected a picture of {} × {} pixels, got {} × {}", columns_, rows_, one.picture->nx, one.picture->ny);
  const auto reflected = [](int i, int count) {
    const int inside = ((i % (2 * count)) + 2 * count) % (2 * count);
    return inside < count ? inside : 2 * count - 1 - inside;
  };
  // The transfer function is real and even: two pictures pass as the real and the imaginary parts of one field.
  Array2D<std::complex<float>> wide(transfer_.ny, transfer_.nx);
  for (size_t k = 0; k < pictures.size(); k += 2) {
    const PictureChannel &one = pictures[k], *other = k + 1 < pictures.size() ? &pictures[k + 1] : nullptr;
    parallel_for(0, wide.ny, [&](int64_t j) {
      const int row = reflected(int(j) - top_, rows_);
      for (int i = 0; i < wide.nx; ++i) {
        const int column = reflected(i - left_, columns_);
        wide(int(j), i) = {one(row, column), other ? (*other)(row, column) : 0};
      }
    });
    fft_2d(wide.values.data(), wide.ny, wide.nx, FftDirection::forward);
    parallel_for(0, wide.ny, [&](int64_t j) {
      for (int i = 0; i < wide.nx; ++i) wide(int(j), i) *= transfer_(int(j), i);
    });
    fft_2d(wide.values.data(), wide.ny, wide.nx, FftDirection::backward);
    parallel_for(0, rows_, [&](int64_t j) {
      for (int i = 0; i < columns_; ++i) {
        const std::complex<float> sample = wide(top_ + int(j), left_ + i);
        one(int(j), i) = std::max(0.0F, sample.real());
        if (other) (*other)(int(j), i) = std::max(0.0F, sample.imag());
      }
    });
  }
}

void limit_to_pupil(Image& picture, double pitch, double wavelength, double distance, double diameter) {
  std::vector<PictureChannel> channels;
  for (int c = 0; c < picture.channels; ++c) channels.push_back({&picture, c});
  PupilBlur(picture.nx, picture.ny, pitch, wavelength, distance, diameter).apply(channels);
}

}  // namespace holotrace
