#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "holotrace/base/vec.h"
#include "holotrace/data/scene.h"
#include "holotrace/trace/lights/emissive_triangles.h"
#include "holotrace/trace/lights/environment.h"
#include "holotrace/trace/shared/lines.h"

namespace holotrace {

/// All emitters of a scene, prepared for sampling. Light groups are numbered: the lights of Scene::lights in
/// their order, then the meshes that emit (together), then background and environment (together). Keeps a reference to
/// the scene.
class Emitters {
 public:
  Emitters(const Scene& scene, const Lines& lines);

  int groups() const { return int(lights_.size()) + 2; }
  int mesh_group() const { return int(lights_.size()); }
  int background_group() const { return mesh_group() + 1; }

  /// Name of a group's separate hologram: "light 0", …, "emission", "background".
  std::string group_name(int group) const;

  /// Scene::lights; their strengths are at the lines instead of red, green and blue.
  const std::vector<Light>& lights() const { return lights_; }

  /// The emitting triangles.
  const EmissiveTriangles& triangles() const { return triangles_; }
  bool is_emissive(int material) const { return is_emissive_[size_t(material)]; }

  /// The environment map, if there is one.
  const EnvironmentLight* environment() const { return environment_ ? &*environment_ : nullptr; }

  /// Radiance from infinitely far away along a unit direction, at the lines [W/m²/sr]: background and environment.
  Vec3 background(Vec3 direction) const {
    return environment_ ? background_ + environment_->radiance(direction) : background_;
  }
  /// Radiance of the background alone, the same in every direction [W/m²/sr].
  Vec3 even_background() const { return background_; }

  /// Whether a ray that meets no further mesh can find light from the background, the environment or a light with an
  /// area.
  bool shine_beyond_surfaces() const { return shine_beyond_surfaces_; }

  /// Lights with an area that rays meet and pass through, as indices into lights(). Visible ones are surfaces.
  const std::vector<int>& lights_on_way() const { return lights_on_way_; }

 private:
  std::vector<Light> lights_;
  EmissiveTriangles triangles_;
  std::vector<char> is_emissive_;  // index: material
  std::optional<EnvironmentLight> environment_;
  Vec3 background_;
  std::vector<int> lights_on_way_;
  bool shine_beyond_surfaces_;
};

}  // namespace holotrace
