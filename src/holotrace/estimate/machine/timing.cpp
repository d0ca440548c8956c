#include "holotrace/estimate/machine/timing.h"

#include <cmath>

#include "holotrace/base/random.h"
#include "holotrace/data/shapes.h"

namespace holotrace {

using namespace literals;

Sources timed_waves(const Grid& panel, int64_t count, double nearest, double farthest) {
  Sources sources{.wavelength = timed_wavelength};
  CounterRandom random(1, 0, 0);
  for (int64_t j = 0; j < count; ++j)
    sources.waves.push_back({{(random.uniform() - 0.5) * panel.width(), (random.uniform() - 0.5) * panel.height(),
                              -nearest - (farthest - nearest) * random.uniform()},
                             1,
                             float(2 * pi * random.uniform())});
  return sources;
}

Triangles timed_half_sphere(int64_t count) {
  // A sphere of s segments has about s² triangles, half of them in front.
  Mesh sphere = make_sphere(8_mm, int(std::lround(std::sqrt(2.0 * double(count)))));
  transform_mesh({.origin = {0, 0, -0.2_m}}, sphere);
  Triangles triangles{.wavelength = timed_wavelength};
  CounterRandom random(1, 0, 0);
  for (const auto& [i, j, k] : sphere.triangles) {
    Triangle t;
    t.corners = {sphere.positions[i], sphere.positions[j], sphere.positions[k]};
    const Vec3 normal = cross(t.corners[1] - t.corners[0], t.corners[2] - t.corners[0]);
    if (!(normal.z > 0)) continue;
    for (float& a : t.amplitudes) a = float(normal.z / length(normal));
    t.phase = float(2 * pi * random.uniform());
    triangles.triangles.push_back(t);
  }
  return triangles;
}

Field timed_field(const Grid& panel) {
  Field field(panel, timed_wavelength);
  CounterRandom random(1, 0, 0);
  for (auto& u : field.samples.values) u = std::polar(1.0F, float(2 * pi * random.uniform()));
  return field;
}

}  // namespace holotrace
