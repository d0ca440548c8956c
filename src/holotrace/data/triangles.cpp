#include "holotrace/data/triangles.h"

#include <cmath>

#include "holotrace/base/error.h"
#include "holotrace/base/units.h"
#include "holotrace/data/grid.h"
#include "holotrace/data/sources.h"

namespace holotrace {

void set_frame(Triangles& triangles, uint32_t frame) {
  for (size_t i = 0; i < triangles.phase_keys.size(); ++i) {
    const uint64_t key = triangles.phase_keys[i];
    const double change =
        random_phase(triangles.seed, frame, key) - random_phase(triangles.seed, triangles.label.frame, key);
    triangles.triangles[i].phase = float(triangles.triangles[i].phase + change);
  }
  triangles.label.frame = frame;
}

TriangleSides sides_of(const Triangles& triangles) {
  const Triangles none{.wavelength = triangles.wavelength, .label = triangles.label, .seed = triangles.seed};
  TriangleSides sides{none, none};
  for (const Triangle& t : triangles.triangles) {
    if (t.corners[0].z < 0) {
      sides.behind.triangles.push_back(t);
      continue;
    }
    Triangle& mirrored = sides.mirrored.triangles.emplace_back(t);
    for (Vec3& corner : mirrored.corners) corner.z = -corner.z;
    mirrored.phase = -t.phase;
    mirrored.direction = {-t.direction.x, -t.direction.y, t.direction.z};
  }
  return sides;
}

void check_triangles(const Triangles& triangles) {
  check_wavelength(triangles.wavelength);
  for (size_t i = 0; i < triangles.triangles.size(); ++i) {
    const Triangle& t = triangles.triangles[i];
    for (int c = 0; c < 3; ++c) {
      const Vec3 p = t.corners[size_t(c)];
      require(is_finite(p) && std::isfinite(t.amplitudes[size_t(c)]) && std::isfinite(t.phase),
              "expected finite numbers in triangle {}, got corner ({}, {}, {}) m, amplitude {}, phase {}", i, p.x, p.y,
              p.z, t.amplitudes[size_t(c)], t.phase);
      if (!(p.z * t.corners[0].z > 0))
        fail(
            "expected triangle {} behind the panel (z < 0) or in front of it (z > 0), got corners at z = {} and {}; cut it at "
            "the panel, or move it",
            i, format_length(t.corners[0].z), format_length(p.z));
    }
    require(length(cross(t.corners[1] - t.corners[0], t.corners[2] - t.corners[0])) > 0,
            "expected triangle {} to have an area, got corners in one line; leave it out", i);
    require(is_finite(t.direction) && std::abs(length(t.direction) - 1) < 1e-6 && t.direction.z > 0,
            "expected a direction of length 1 toward the viewer (z > 0) for triangle {}, got ({}, {}, {})", i,
            t.direction.x, t.direction.y, t.direction.z);
  }
  require(triangles.phase_keys.empty() || triangles.phase_keys.size() == triangles.triangles.size(),
          "expected a phase key for each of {} triangles, or none, got {}", triangles.triangles.size(),
          triangles.phase_keys.size());
}

}  // namespace holotrace
