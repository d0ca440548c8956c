#include "holotrace/wave/layers/depth_layers.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "holotrace/base/error.h"
#include "holotrace/base/threads.h"
#include "holotrace/base/units.h"
#include "holotrace/data/acceptance.h"
#include "holotrace/data/params/parameter.h"
#include "holotrace/data/sources.h"
#include "holotrace/data/spectrum.h"
#include "holotrace/wave/layers/slice.h"

namespace holotrace {
namespace {

using Complex = std::complex<float>;

constexpr double depth_share = 0.8;  // fraction of the tolerance

// A picture's light at a wavelength, as a summed-area table: the mean over any rectangle takes four look-ups.
struct Light {
  int nx, ny;
  Array2D<float> value;
  Array2D<double> sums;  // over all rows above and columns to the left; one larger than the picture

  Light(const Image& picture, double wavelength) : nx(picture.nx), ny(picture.ny), value(ny, nx), sums(ny + 1, nx + 1) {
    for (int j = 0; j < ny; ++j)
      for (int i = 0; i < nx; ++i) {
        const Vec3 rgb = picture.channels == 3 ? Vec3{picture(j, i, 0), picture(j, i, 1), picture(j, i, 2)}
                                               : Vec3{picture(j, i), picture(j, i), picture(j, i)};
        value(j, i) = float(radiance_at(wavelength, rgb));
        sums(j + 1, i + 1) = sums(j, i + 1) + sums(j + 1, i) - sums(j, i) + value(j, i);
      }
  }

  // The integral from the picture's corner to (x, y), in pixels from that corner.
  double integral(double x, double y) const {
    const int i = std::clamp(int(x), 0, nx - 1), j = std::clamp(int(y), 0, ny - 1);
    const double s = std::clamp(x - i, 0.0, 1.0), t = std::clamp(y - j, 0.0, 1.0);
    return (1 - t) * ((1 - s) * sums(j, i) + s * sums(j, i + 1)) +
           t * ((1 - s) * sums(j + 1, i) + s * sums(j + 1, i + 1));
  }

  // Mean light over a square of that side (at least a pixel's) around (x, y); bilinear for a pixel's side.
  double mean(double x, double y, double side) const {
    const double half = std::max(side, 1.0) / 2;
    const double x0 = std::clamp(x - half, 0.0, double(nx)), x1 = std::clamp(x + half, 0.0, double(nx));
    const double y0 = std::clamp(y - half, 0.0, double(ny)), y1 = std::clamp(y + half, 0.0, double(ny));
    if (x1 <= x0 || y1 <= y0) return 0;
    const double sum = integral(x1, y1) - integral(x0, y1) - integral(x1, y0) + integral(x0, y0);
    return std::max(0.0, sum / ((x1 - x0) * (y1 - y0)));
  }
};

// Size of pixels in space: `size` [m] at a depth of 1 m (perspective), or at any depth (orthographic).
struct Placing {
  Projection projection;
  double size;
  double pixel_at(double depth) const { return projection == Projection::perspective ? size * depth : size; }
};

// Data shared by the slices; the stack's make function holds it.
struct Slicing {
  const DepthImage& image;
  Light light;
  Placing placing;
  Grid panel;
  double wavelength;
  DepthImageParams params;
  bool has_silhouettes;
  uint32_t frame;
  std::vector<double> depths;
  std::vector<Grid> grids;
  Array2D<int32_t> slice_of;  // index: pixel; −1: nothing there
};

Placing placing_of(const DepthImage& image, const Grid& panel, const LightInCone& light,
                   const DepthImageParams& params) {
  const int nx = image.picture.nx;
  if (params.projection == Projection::orthographic)
    return {params.projection, (params.width > 0 ? params.width : panel.width()) / nx};
  const double tangent = params.field_of_view > 0 ? std::tan(params.field_of_view)
                                                  : acceptance_tangent(light.acceptance_wavelength(), panel.pitch);
  require(std::isfinite(tangent),
          "expected a field of view for a panel of {} at {}, whose acceptance is all directions",
          format_length(panel.pitch), format_length(light.wavelength));
  return {params.projection, 2 * tangent / nx};
}

void check_params(const DepthImageParams& params, const SynthesizeParams& synthesis) {
  require(params.phase == SourcePhase::random || params.phase == SourcePhase::constant,
          "expected the phase random or constant for a picture with depth");
  check_ranges(params);
  check_ranges(synthesis);
  require(params.projection == Projection::perspective || params.field_of_view == 0,
          "expected no field of view with the projection orthographic, got {}; give a width, or the projection "
          "perspective",
          format_angle(params.field_of_view));
  require(params.projection == Projection::orthographic || params.width == 0,
          "expected no width with the projection perspective, got {}; give a field of view",
          format_length(params.width));
}

// The samples of the panel's raster that a picture covers: pixels of side `pixel`, centred on the panel's axis. Light
// farther than `reach` from the panel does not reach it.
Grid grid_of(const Image& picture, double pixel, double reach, const Grid& panel) {
  const auto covered = [&](int pixels, int of_panel) {  // of the panel's parity, so that samples lie on its raster
    const double wanted = std::min(pixels * pixel / panel.pitch, of_panel + 2 * reach / panel.pitch);
    const int samples = std::max(1, int(std::ceil(wanted - 1e-9)));
    return samples + (samples + of_panel) % 2;
  };
  Grid grid = panel;
  grid.nx = covered(picture.nx, panel.nx), grid.ny = covered(picture.ny, panel.ny);
  return grid;
}

// The different depths of a picture, ascending; pictures have few.
std::vector<double> depths_of(const DepthImage& image) {
  std::vector<double> depths;
  for (const float depth : image.depth.values)
    if (depth != 0) depths.push_back(depth);
  std::sort(depths.begin(), depths.end());
  depths.erase(std::unique(depths.begin(), depths.end()), depths.end());
  return depths;
}

// Sorts depths into slices; see slice.h for the error. The light is taken as even and spreading from the axis.
DepthSlices slices_of(const std::vector<double>& depths, const Grid& panel, const LightInCone& light,
                      const SynthesizeParams& synthesis, const Observer& observer) {
  const double nearest = std::abs(*std::min_element(
      depths.begin(), depths.end(), [](double one, double other) { return std::abs(one) < std::abs(other); }));
  const double per_metre = depth_error_per_metre(0, 0, nearest, panel, light.wavelength, light.cone_wavelength);
  const double by_tolerance = 2 * depth_share * synthesis.tolerance / per_metre;
  const auto thickness_at = [&](double depth) { return std::max(by_tolerance, depth_of_focus(depth, panel, light)); };
  DepthSlices found =
      synthesis.slices > 0 ? slice_depths_into(depths, synthesis.slices) : slice_depths(depths, thickness_at);
  observer.fact("slice_thickness_m", found.thickness);
  observer.fact("largest_depth_error", per_metre * found.thickness / 2);
  if (synthesis.slices == 0 && found.slices.size() > many_slices)
    observer.warn(fmt::format("the panel's depth of focus needs {} slices, one transform each; set slices to fewer",
                              found.slices.size()));
  return found;
}

// The slice of each pixel, −1 without one.
Array2D<int32_t> assign_pixels(const DepthImage& image, const std::vector<double>& depths, const DepthSlices& found) {
  std::vector<int32_t> slice_of_depth(depths.size());
  for (size_t m = 0; m < found.slices.size(); ++m)
    for (const uint32_t member : found.slices[m].members) slice_of_depth[member] = int32_t(m);
  Array2D<int32_t> slice_of(image.depth.ny, image.depth.nx, -1);
  for (size_t i = 0; i < image.depth.size(); ++i) {
    const double depth = image.depth.values[i];
    if (depth != 0)
      slice_of.values[i] =
          slice_of_depth[size_t(std::lower_bound(depths.begin(), depths.end(), depth) - depths.begin())];
  }
  return slice_of;
}

Slice make_slice(const Slicing& s, size_t index) {
  const Grid& grid = s.grids[index];
  const Image& picture = s.image.picture;
  const double pixel = s.placing.pixel_at(s.depths[index]);
  Slice slice{Field(grid, s.wavelength, -s.depths[index]), {}};
  if (s.has_silhouettes) slice.mask = Array2D<float>(grid.ny, grid.nx);
  parallel_for(0, grid.ny, [&](int64_t row) {
    const int j = int(row);
    const double y = picture.ny / 2.0 - (grid.y(j) - grid.centre_y) / pixel;  // in pixels from the top left corner
    if (y < 0 || y >= picture.ny) return;
    for (int i = 0; i < grid.nx; ++i) {
      const double x = picture.nx / 2.0 + (grid.x(i) - grid.centre_x) / pixel;
      if (x < 0 || x >= picture.nx || s.slice_of(int(y), int(x)) != int32_t(index)) continue;
      if (s.has_silhouettes) slice.mask(j, i) = 1;
      const double amplitude = std::sqrt(s.light.mean(x, y, grid.pitch / pixel));
      const uint64_t sample = (uint64_t(index) << 40) + uint64_t(j) * uint64_t(grid.nx) + uint64_t(i);
      const double phase =
          s.params.phase == SourcePhase::random ? random_phase(uint64_t(s.params.seed), s.frame, sample) : 0;
      slice.light.samples(j, i) = Complex(std::polar(amplitude, phase));
    }
  });
  return slice;
}

}  // namespace

double depth_of_focus(double depth, const Grid& panel, const LightInCone& light) {
  const double edge = std::max(panel.width(), panel.height()) / 2;
  const double sine =
      std::min(edge / std::hypot(edge, depth), acceptance_sine(light.acceptance_wavelength(), panel.pitch));
  return light.wavelength / (sine * sine);
}

SliceStack slice_depth_image(const DepthImage& image, const Grid& panel, const LightInCone& light,
                             const DepthImageParams& params, const SynthesizeParams& synthesis, uint32_t frame,
                             const Observer& observer) {
  check_grid(panel);
  const double wavelength = light.wavelength;
  check_wavelength(wavelength, panel);
  check_cone(light.cone_wavelength, wavelength);
  check_depth_image(image);
  check_params(params, synthesis);
  const std::vector<double> depths = depths_of(image);
  const double narrowest = placing_of(image, panel, light, params).pixel_at(depths.front()) * image.picture.nx;
  require(
      params.projection == Projection::orthographic || narrowest >= panel.pitch,
      "expected depths behind the panel with the projection perspective, whose rays leave the panel's centre, got {}; "
      "use orthographic",
      format_length(depths.front()));
  const DepthSlices found = slices_of(depths, panel, light, synthesis, observer);
  const auto shared = std::make_shared<Slicing>(Slicing{image,
                                                        Light(image.picture, wavelength),
                                                        placing_of(image, panel, light, params),
                                                        panel,
                                                        wavelength,
                                                        params,
                                                        synthesis.has_silhouettes,
                                                        frame,
                                                        {},
                                                        {},
                                                        {}});
  for (const DepthSlice& slice : found.slices) {
    shared->depths.push_back(slice.depth);
    const double reach = box_radius(std::abs(slice.depth), wavelength, panel.pitch);
    shared->grids.push_back(grid_of(image.picture, shared->placing.pixel_at(slice.depth), reach, panel));
    check_field_fits(shared->grids.back(), sizeof(Complex));
  }
  shared->slice_of = assign_pixels(image, depths, found);
  // The fraction of the raster's band inside the cone.
  const double part =
      acceptance_sine(light.acceptance_wavelength(), panel.pitch) / acceptance_sine(wavelength, panel.pitch);
  return {.wavelength = wavelength,
          .depths = shared->depths,
          .grids = shared->grids,
          .has_masks = synthesis.has_silhouettes,
          .make = [shared](size_t index) { return make_slice(*shared, index); },
          .cone_wavelength = light.cone_wavelength,
          .scale = params.phase == SourcePhase::random ? 1 / part : 1};
}

Field sum_depth_image(const DepthImage& image, const Grid& panel, const LightInCone& light,
                      const DepthImageParams& params, const SynthesizeParams& synthesis, uint32_t frame,
                      const Observer& observer) {
  observer.fact("method", std::string("layers"));
  Field field = sum_layers(slice_depth_image(image, panel, light, params, synthesis, frame, observer), panel, observer);
  field.label.frame = frame;
  return field;
}

}  // namespace holotrace
