#include "holotrace/view/stereo.h"

#include <cmath>

#include "holotrace/base/error.h"
#include "holotrace/base/units.h"
#include "holotrace/data/spectrum.h"

namespace holotrace {

std::array<Vec3, 2> two_eyes(Vec3 eye, double separation) {
  const Vec3 half{separation / 2, 0, 0};
  return {eye - half, eye + half};
}

std::array<RenderParams, 2> stereo_pair(const RenderParams& params) {
  require(std::isfinite(params.eye_separation) && params.eye_separation > 0,
          "expected eyes more than 0 m apart for a stereo pair, got {}", format_length(params.eye_separation));
  require(params.lens != Lens::panel,
          "expected a pinhole or a round lens for a stereo pair, got the panel, which has no eye; use another lens");
  std::array<RenderParams, 2> pair{params, params};
  const auto eyes = two_eyes(params.eye, params.eye_separation);
  for (size_t i = 0; i < 2; ++i) {
    pair[i].eye = eyes[i];
    pair[i].eye_separation = 0;
  }
  return pair;
}

Image anaglyph(const Image& left, const Image& right) {
  require(left.nx == right.nx && left.ny == right.ny && left.channels == right.channels,
          "expected two pictures of one size for an anaglyph, got {} × {} pixels of {} channel(s) and {} × {} of {}",
          left.nx, left.ny, left.channels, right.nx, right.ny, right.channels);
  Image both(left.ny, left.nx, 3);
  both.pitch = left.pitch;
  both.centre_x = left.centre_x;
  both.centre_y = left.centre_y;
  for (int j = 0; j < left.ny; ++j)
    for (int i = 0; i < left.nx; ++i) {
      const int green = left.channels == 3 ? 1 : 0, blue = left.channels == 3 ? 2 : 0;
      both(j, i, 0) = float(luminance(left(j, i, 0), left(j, i, green), left(j, i, blue)));
      both(j, i, 1) = right(j, i, green);
      both(j, i, 2) = right(j, i, blue);
    }
  return both;
}

}  // namespace holotrace
