#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "holotrace/base/vec.h"
#include "holotrace/data/image.h"

namespace holotrace {

/// A Lambertian surface: BRDF = reflectance/π on both sides.
struct DiffuseMaterial {
  Vec3 reflectance{0.8, 0.8, 0.8};       ///< albedo ρ in red, green, blue, each in [0, 1]
  std::shared_ptr<const Image> texture;  ///< multiplies the reflectance where present (linear light)
  Vec3 emission{0, 0, 0};                ///< radiance [W/m²/sr] that both sides send out
};

/// What a surface does to light. Further materials join this list.
using Material = std::variant<DiffuseMaterial>;

/// Triangles of one material.
struct Mesh {
  std::string name;
  std::vector<Vec3> positions;                     ///< [m]
  std::vector<Vec3> normals;                       ///< unit, one per position, or empty: flat shading
  std::vector<Vec2> texture_coordinates;           ///< (u, v), v up, one per position, or empty
  std::vector<std::array<uint32_t, 3>> triangles;  ///< indices into positions
  int material = 0;                                ///< index into Scene::materials
};

/// Light that leaves a point evenly in all directions.
struct PointLight {
  Vec3 position;   ///< [m]
  Vec3 intensity;  ///< [W/sr]
};

/// A rectangle corner + s·edge_u + t·edge_v that shines from the side edge_u × edge_v points to.
/// Paths do not hit it: it lights the scene, and is not seen.
struct RectangleLight {
  Vec3 corner, edge_u, edge_v;  ///< [m]
  Vec3 radiance;                ///< [W/m²/sr]
};

/// What sends light. Further lights join this list.
using Light = std::variant<PointLight, RectangleLight>;

/// A luminous point that is a source by itself, without path tracing.
struct ScenePoint {
  Vec3 position;        ///< [m]
  float amplitude = 1;  ///< at the panel, head-on [√(W/m²)]
  float phase = 0;      ///< [rad], added to what TraceParams::phase gives
};

/// Geometry in the panel's frame: origin at its centre, x right, y up, z toward the viewer; the
/// scene stands at z < 0.
struct Scene {
  std::vector<Material> materials;
  std::vector<Mesh> meshes;
  std::vector<Light> lights;
  std::vector<ScenePoint> points;
  Vec3 background{0, 0, 0};  ///< radiance where a ray leaves the scene [W/m²/sr]
};

/// @throws Error, naming mesh and element, for triangles that index no vertex, numbers that are
///         not finite, materials that do not exist, points that are not behind the panel (z ≥ 0), meshes wholly in
///         front of it, and a scene with nothing in it.
void check_scene(const Scene& scene);

}  // namespace holotrace
