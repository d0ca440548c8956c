#include "holotrace/trace/lights/emitters.h"

#include <algorithm>

namespace holotrace {

namespace {

Vec3& strength(PointLight& light) { return light.intensity; }
Vec3& strength(SpotLight& light) { return light.intensity; }
Vec3& strength(DirectionalLight& light) { return light.irradiance; }
Vec3& strength(RectangleLight& light) { return light.radiance; }

}  // namespace

Emitters::Emitters(const Scene& scene, const Lines& lines)
    : lights_(scene.lights), triangles_(scene, lines), background_(lines.from_rgb(scene.background)) {
  for (size_t i = 0; i < lights_.size(); ++i) {
    std::visit([&](auto& light) { strength(light) = lines.from_rgb(strength(light)); }, lights_[i]);
    const auto* rectangle = std::get_if<RectangleLight>(&lights_[i]);
    if (rectangle && !rectangle->is_visible) lights_on_way_.push_back(int(i));
  }
  for (const Material& material : scene.materials)
    is_emissive_.push_back(max_component(lines.from_rgb(material.emission)) > 0);
  if (scene.environment) environment_.emplace(*scene.environment, lines);
  shine_beyond_surfaces_ =
      environment_ || max_component(background_) > 0 || std::any_of(lights_.begin(), lights_.end(), has_area);
}

std::string Emitters::group_name(int group) const {
  if (group == mesh_group()) return "emission";
  return group == background_group() ? "background" : "light " + std::to_string(group);
}

}  // namespace holotrace
