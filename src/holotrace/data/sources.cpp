#include "holotrace/data/sources.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "holotrace/base/error.h"
#include "holotrace/base/random.h"
#include "holotrace/base/units.h"
#include "holotrace/data/grid.h"

namespace holotrace {

double random_phase(uint64_t seed, uint32_t frame, uint64_t key) {
  return 2 * pi * CounterRandom(seed, frame, key).uniform();
}

void set_frame(Sources& sources, uint32_t frame) {
  for (size_t i = 0; i < sources.phase_keys.size(); ++i) {
    const uint64_t key = sources.phase_keys[i];
    if (key == Sources::no_phase_key) continue;
    const double change = random_phase(sources.seed, frame, key) - random_phase(sources.seed, sources.label.frame, key);
    sources.waves[i].phase = float(sources.waves[i].phase + change);
  }
  sources.label.frame = frame;
}

namespace {

enum class Kind { behind, in_front, astigmatic };

Kind kind_of(const Sources& sources, size_t i) {
  if (is_astigmatic(sources, i)) return Kind::astigmatic;
  return sources.waves[i].origin.z > 0 ? Kind::in_front : Kind::behind;
}

}  // namespace

bool has_astigmatic(const Sources& sources) {
  return std::any_of(sources.second_foci.begin(), sources.second_foci.end(),
                     [](const SecondFocus& focus) { return focus.is_astigmatic(); });
}

bool are_from_behind(const Sources& sources) {
  for (size_t i = 0; i < sources.waves.size(); ++i)
    if (kind_of(sources, i) != Kind::behind) return false;
  return true;
}

Sources some_of(const Sources& sources, const std::vector<size_t>& indices) {
  Sources some{.wavelength = sources.wavelength,
               .tiles = {sources.tiles.columns, sources.tiles.rows, {}},
               .label = sources.label,
               .seed = sources.seed};
  const auto take = [&](const auto& all, size_t first, auto& to) {
    for (const size_t i : indices) to.push_back(all[first + i]);
  };
  take(sources.waves, 0, some.waves);
  if (!sources.second_foci.empty()) take(sources.second_foci, 0, some.second_foci);
  const size_t tiles = size_t(sources.tiles.columns) * size_t(sources.tiles.rows);
  for (size_t tile = 0; tile < tiles; ++tile)
    take(sources.tiles.values, tile * sources.waves.size(), some.tiles.values);
  return some;
}

SourceKinds kinds_of(const Sources& sources) {
  std::vector<size_t> behind, in_front;
  std::map<int, std::vector<size_t>> astigmatic;
  for (size_t i = 0; i < sources.waves.size(); ++i) {
    const Kind kind = kind_of(sources, i);
    if (kind == Kind::astigmatic) {
      const double difference = 1 / sources.second_foci[i].place.z - 1 / sources.waves[i].origin.z;
      astigmatic[int(std::floor(std::ilogb(difference) / 3.0))].push_back(i);  // alike within a factor of 8
    } else {
      (kind == Kind::behind ? behind : in_front).push_back(i);
    }
  }
  SourceKinds kinds{some_of(sources, behind), some_of(sources, in_front), {}};
  for (const auto& [size, waves] : astigmatic) kinds.astigmatic.push_back(some_of(sources, waves));
  kinds.behind.second_foci.clear();
  kinds.mirrored.second_foci.clear();
  for (Source& wave : kinds.mirrored.waves) {
    wave.origin.z = -wave.origin.z;
    wave.phase = -wave.phase;
  }
  return kinds;
}

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
