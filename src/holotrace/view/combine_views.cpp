#include "holotrace/view/combine_views.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "holotrace/base/error.h"
#include "holotrace/base/threads.h"
#include "holotrace/data/cie.h"
#include "holotrace/data/spectrum.h"
#include "holotrace/view/camera.h"

namespace holotrace {
namespace {

// Calls work(i) for each pixel of a picture.
template <class Work>
void each_pixel(int ny, int nx, const Work& work) {
  parallel_for(
      0, ny,
      [&](int64_t row) {
        const size_t first = size_t(row) * size_t(nx);
        for (size_t i = first; i < first + size_t(nx); ++i) work(i);
      },
      {}, 32);
}

}  // namespace

void CombinedViews::add(double wavelength, const std::string& name, double illumination, const Image& view,
                        double reach) {
  require(std::isfinite(illumination) && illumination >= 0, "expected an illumination of 0 W/m² or more, got {} W/m²",
          illumination);
  require(std::isfinite(reach) && reach > 0, "expected a reach above 0, got {}", reach);
  require(view.channels == 1, "expected a view of one channel, got {}", view.channels);
  if (groups_.empty()) {
    nx_ = view.nx;
    ny_ = view.ny;
    pitch_ = view.pitch;
    centre_x_ = view.centre_x;
    centre_y_ = view.centre_y;
  }
  require(view.nx == nx_ && view.ny == ny_ && view.pitch == pitch_ && view.centre_x == centre_x_ &&
              view.centre_y == centre_y_,
          "expected views of one size to add up, {} × {} pixels, got {} × {}; show holograms of one panel", nx_, ny_,
          view.nx, view.ny);
  auto group = std::find_if(groups_.begin(), groups_.end(),
                            [&](const Group& g) { return g.wavelength == wavelength && g.name == name; });
  if (group == groups_.end()) {
    groups_.push_back({wavelength, reach, name, 0, 0, std::vector<double>(view.values.size())});
    group = groups_.end() - 1;
  }
  ++group->frames;
  group->illumination += illumination;
  brightest_ = std::max(brightest_, illumination);
  double* light = group->light.data();
  each_pixel(ny_, nx_, [&](size_t i) { light[i] += illumination * double(view.values[i]); });
}

std::vector<double> CombinedViews::wavelengths() const {
  std::vector<double> found = wavelengths_;
  for (const Group& group : groups_)
    if (std::find(found.begin(), found.end(), group.wavelength) == found.end()) found.push_back(group.wavelength);
  return found;
}

Image CombinedViews::irradiance(double wavelength) const {
  std::vector<double> sum(size_t(nx_) * size_t(ny_));
  for (const Group& group : groups_)
    if (group.wavelength == wavelength)
      each_pixel(ny_, nx_, [&](size_t i) { sum[i] += group.light[i] / group.frames; });
  Image image(ny_, nx_, 1);
  image.pitch = pitch_;
  image.centre_x = centre_x_;
  image.centre_y = centre_y_;
  each_pixel(ny_, nx_, [&](size_t i) { image.values[i] = float(sum[i] / brightest()); });
  return image;
}

Image CombinedViews::image() const {
  const std::vector<double> lines = wavelengths();
  require(!groups_.empty(), "expected a view to make a picture of, got none");
  if (lines.size() == 1) return irradiance(lines.front());
  const std::vector<Vec3> matrix = colour_matrix(lines);
  const auto reach_of = [&](double wavelength) {  // 0 for a wavelength of no hologram
    const auto group =
        std::find_if(groups_.begin(), groups_.end(), [&](const Group& g) { return g.wavelength == wavelength; });
    return group == groups_.end() ? 0 : group->reach;
  };
  double farthest = 0;
  for (const double wavelength : lines) farthest = std::max(farthest, reach_of(wavelength));
  std::vector<Vec3> sum(size_t(nx_) * size_t(ny_));
  for (size_t n = 0; n < lines.size(); ++n) {
    if (reach_of(lines[n]) == 0) continue;
    const Image one = irradiance(lines[n]);
    const Vec3 weight = matrix[n] * (farthest / reach_of(lines[n]));
    each_pixel(ny_, nx_, [&](size_t i) { sum[i] = sum[i] + weight * double(one.values[i]); });
  }
  Image image(ny_, nx_, 3);
  image.pitch = pitch_;
  image.centre_x = centre_x_;
  image.centre_y = centre_y_;
  each_pixel(ny_, nx_, [&](size_t i) {
    image.values[3 * i] = float(sum[i].x);
    image.values[3 * i + 1] = float(sum[i].y);
    image.values[3 * i + 2] = float(sum[i].z);
  });
  return image;
}

double CombinedViews::mean_irradiance() const {
  double sum = 0;
  for (const Group& group : groups_) sum += std::accumulate(group.light.begin(), group.light.end(), 0.0) / group.frames;
  return sum / brightest() / (double(nx_) * ny_);
}

double CombinedViews::relative_illumination() const {
  double sum = 0;
  for (const Group& group : groups_) sum += group.illumination / group.frames;
  return sum / brightest();
}

Image seen_at(const Image& rgb, const std::vector<double>& wavelengths) {
  const std::vector<Vec3> matrix = colour_matrix(wavelengths);
  if (rgb.channels == 1 && wavelengths.size() == 1) return rgb;
  Image out(rgb.ny, rgb.nx, wavelengths.size() == 1 ? 1 : 3);
  out.pitch = rgb.pitch;
  each_pixel(rgb.ny, rgb.nx, [&](size_t i) {
    const float* c = &rgb.values[i * size_t(rgb.channels)];
    const Vec3 colour = rgb.channels == 1 ? Vec3{c[0], c[0], c[0]} : Vec3{c[0], c[1], c[2]};
    if (wavelengths.size() == 1) {
      out.values[i] = float(radiance_at(wavelengths.front(), colour));
      return;
    }
    Vec3 seen;
    for (size_t n = 0; n < wavelengths.size(); ++n) seen = seen + matrix[n] * radiance_at(wavelengths[n], colour);
    out.values[3 * i] = float(seen.x);
    out.values[3 * i + 1] = float(seen.y);
    out.values[3 * i + 2] = float(seen.z);
  });
  return out;
}

Image in_cie_colours(const Image& image, const std::vector<double>& wavelengths) {
  const std::vector<Vec3> matrix = cie_colour_matrix(wavelengths);
  Image out(image.ny, image.nx, 3);
  out.pitch = image.pitch;
  out.centre_x = image.centre_x;
  out.centre_y = image.centre_y;
  each_pixel(image.ny, image.nx, [&](size_t i) {
    const float* c = &image.values[i * size_t(image.channels)];
    const Vec3 colour = image.channels == 1 ? Vec3{c[0], c[0], c[0]} : Vec3{c[0], c[1], c[2]};
    Vec3 sum;
    for (size_t n = 0; n < wavelengths.size(); ++n) sum += matrix[n] * radiance_at(wavelengths[n], colour);
    const Vec3 seen = within_gamut(sum);
    out.values[3 * i] = float(seen.x);
    out.values[3 * i + 1] = float(seen.y);
    out.values[3 * i + 2] = float(seen.z);
  });
  return out;
}

Image sensor_at(const ViewPlace& place, int rows, int columns) {
  Image sensor(rows, columns, 1);
  sensor.pitch = place.pixel;
  sensor.centre_x = place.centre_x - place.tangent_x * std::abs(place.distance);
  sensor.centre_y = place.centre_y - place.tangent_y * std::abs(place.distance);
  return sensor;
}

Image render_at(const Image& render, const ViewPlace& place, int rows, int columns) {
  return project_render(seen_at(render, place.wavelengths), place.half_tangent, sensor_at(place, rows, columns),
                        place.distance);
}

Image on_pixels_of(const Image& picture, const Image& other) {
  const double columns_expected = double(picture.nx) * other.ny / picture.ny;
  require(std::abs(columns_expected - other.nx) <= 0.5 * std::max(1.0, double(other.ny) / picture.ny),
          "expected two pictures of the same shape, got {} × {} and {} × {} pixels; crop one of them, "
          "or add --register if one is a photograph",
          picture.nx, picture.ny, other.nx, other.ny);
  ViewPlace same;  // the window of the picture is 1 high, at a distance of 1
  same.half_tangent = 0.5;
  same.distance = 1;
  same.pixel = 1.0 / other.ny;
  Image out = project_render(picture, same.half_tangent, sensor_at(same, other.ny, other.nx), same.distance);
  out.pitch = other.pitch;
  return out;
}

Image luminance_of(const Image& image) {
  if (image.channels == 1) return image;
  Image grey(image.ny, image.nx, 1);
  grey.pitch = image.pitch;
  grey.centre_x = image.centre_x;
  grey.centre_y = image.centre_y;
  for (size_t i = 0; i < grey.values.size(); ++i) {
    const float* c = &image.values[3 * i];
    grey.values[i] = float(luminance(c[0], c[1], c[2]));
  }
  return grey;
}

}  // namespace holotrace
