#include "holotrace/view/render_at.h"

#include <cmath>

#include "holotrace/base/error.h"
#include "holotrace/data/spectrum.h"
#include "holotrace/view/camera.h"
#include "holotrace/view/combine_views.h"

namespace holotrace {

Image sensor_at(const ViewPlace& place, int rows, int columns) {
  Image sensor(rows, columns, 1);
  sensor.pitch = place.pixel;
  sensor.centre_x = place.centre_x;
  sensor.centre_y = place.centre_y;
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
