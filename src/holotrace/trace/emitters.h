#pragma once

#include <optional>
#include <string>

#include "holotrace/base/vec.h"
#include "holotrace/data/scene.h"
#include "holotrace/trace/lines.h"

namespace holotrace {

/// What sends light in a scene, ready to be asked for it. Light groups are numbered: the lights of Scene::lights in
/// their order, then the meshes that emit (together), then background and environment (together).
class Emitters {
 public:
  Emitters(const Scene& scene, const Lines& lines) : scene_(scene), lines_(lines) {}

  int groups() const { return int(scene_.lights.size()) + 2; }
  int mesh_group() const { return int(scene_.lights.size()); }
  int background_group() const { return mesh_group() + 1; }

  /// "light 0", …, "emission", "background": what separate holograms are called.
  std::string group_name(int group) const {
    if (group == mesh_group()) return "emission";
    return group == background_group() ? "background" : "light " + std::to_string(group);
  }

  /// Radiance from infinitely far away along a unit direction, at the lines [W/m²/sr].
  Vec3 background(Vec3) const { return lines_.from_rgb(scene_.background); }

 private:
  const Scene& scene_;
  Lines lines_;
};

}  // namespace holotrace
