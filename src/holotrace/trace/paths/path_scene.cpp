#include "holotrace/trace/paths/path_scene.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <variant>

#include "holotrace/base/error.h"
#include "holotrace/base/units.h"
#include "holotrace/data/rgl_brdf.h"
#include "holotrace/trace/lights/light.h"
#include "holotrace/trace/materials/bsdf.h"

namespace holotrace {
namespace {

constexpr size_t most_planes = 16;       // of a mesh
constexpr double same_direction = 1e-9;  // 1 − cosine of an angle of 4e-5 rad

Vec3 mirrored_direction(Vec3 v, const FlatMirror& mirror) { return v - mirror.normal * (2 * dot(v, mirror.normal)); }
Vec3 mirrored_place(Vec3 p, const FlatMirror& mirror) {
  return mirror.place + mirrored_direction(p - mirror.place, mirror);
}

Light mirror_image(const Light& light, const FlatMirror& mirror) {
  Light image = light;
  if (auto* lamp = std::get_if<PointLight>(&image)) lamp->position = mirrored_place(lamp->position, mirror);
  if (auto* spot = std::get_if<SpotLight>(&image)) {
    spot->position = mirrored_place(spot->position, mirror);
    spot->direction = mirrored_direction(spot->direction, mirror);
  }
  if (auto* beam = std::get_if<DirectionalLight>(&image)) {
    beam->position = mirrored_place(beam->position, mirror);
    beam->direction = mirrored_direction(beam->direction, mirror);
  }
  return image;
}

bool reflects(const Material& material, const Lines& lines) {
  SurfacePoint point;
  point.normal = point.geometric_normal = {0, 0, 1};
  const SpecularBranches branches = specular_branches(make_bsdf(material, point, lines), point.normal);
  return std::any_of(branches.ways.begin(), branches.ways.begin() + branches.count,
                     [](const BsdfSample& way) { return !way.is_transmission; });
}

Vec3 across(const Mesh& mesh, const std::array<uint32_t, 3>& triangle) {
  const Vec3 a = mesh.positions[triangle[0]];
  return cross(mesh.positions[triangle[1]] - a, mesh.positions[triangle[2]] - a);
}

bool is_smooth(const Mesh& mesh) {
  return !mesh.normals.empty() && std::any_of(mesh.triangles.begin(), mesh.triangles.end(), [&](const auto& triangle) {
    const Vec3 side = across(mesh, triangle);
    const double size = length(side);
    return size > 0 && std::any_of(triangle.begin(), triangle.end(), [&](uint32_t corner) {
             return std::abs(dot(normalize(mesh.normals[corner]), side)) < size * (1 - same_direction);
           });
  });
}

// The planes of a mesh; none if it has too many.
std::optional<std::vector<FlatMirror>> planes_of(const Mesh& mesh, uint32_t index) {
  std::vector<FlatMirror> planes;
  for (const auto& triangle : mesh.triangles) {
    const Vec3 a = mesh.positions[triangle[0]], side = across(mesh, triangle);
    const double size = length(side);
    if (!(size > 0)) continue;
    const Vec3 normal = side / size;
    const double near = 1e-6 * std::sqrt(size);
    const bool is_known = std::any_of(planes.begin(), planes.end(), [&](const FlatMirror& plane) {
      return std::abs(dot(plane.normal, normal)) > 1 - same_direction && std::abs(dot(a - plane.place, normal)) <= near;
    });
    if (is_known) continue;
    if (planes.size() == most_planes) return std::nullopt;
    planes.push_back({index, a, normal, {}});
  }
  return planes;
}

}  // namespace

bool FlatMirror::holds(const SurfacePoint& point) const {
  return point.light < 0 && point.mesh == mesh && std::abs(dot(point.geometric_normal, normal)) > 1 - same_direction &&
         std::abs(dot(point.position - place, normal)) <= 8 * point.clearance;
}

bool is_faceted(const Mesh& mesh) { return !is_smooth(mesh) && !planes_of(mesh, 0); }

std::vector<FlatMirror> flat_mirrors(const Scene& scene, const std::vector<Light>& lights, const Lines& lines) {
  std::vector<FlatMirror> mirrors;
  if (std::all_of(lights.begin(), lights.end(), has_area)) return mirrors;
  for (uint32_t m = 0; m < scene.meshes.size(); ++m) {
    const Mesh& mesh = scene.meshes[m];
    const Material& material = scene.materials[size_t(mesh.material)];
    if (mesh.triangles.empty() || !acts_as_its_mesh(material) || !reflects(material, lines) || is_smooth(mesh))
      continue;
    if (auto planes = planes_of(mesh, m)) std::move(planes->begin(), planes->end(), std::back_inserter(mirrors));
  }
  for (FlatMirror& mirror : mirrors)
    for (const Light& light : lights) mirror.images.push_back(mirror_image(light, mirror));
  return mirrors;
}

/// @throws Error  for a line at which a surface was not measured
static void require_measured(const MeasuredBrdf& brdf, const Lines& lines) {
  if (!is_rgl(brdf)) return;
  const auto& measured = brdf.fields[rgl_wavelengths].values;
  for (const double line : lines.wavelengths)
    require(line * 1e9 >= double(measured.front()) && line * 1e9 <= double(measured.back()),
            "expected wavelengths from {} to {} nm, at which a surface was measured, got {}", measured.front(),
            measured.back(), format_length(line));
}

/// The lines with the reflectances that a scene asks for.
static Lines lines_for(const Scene& scene, Lines lines) {
  if (scene.reflectances == Reflectances::smooth) lines.reflectances = &reflectance_table(lines.wavelengths);
  return lines;
}

static bool bends_differently(const Scene& scene, const Lines& lines) {
  const auto& [first, second, third] = lines.wavelengths;
  return lines.glass_wavelength == 0 && (first != second || first != third) &&
         std::any_of(scene.meshes.begin(), scene.meshes.end(),
                     [&](const Mesh& mesh) { return is_dispersive(scene.materials[size_t(mesh.material)]); });
}

/// Filters need polarization, with or without an analyser.
static std::optional<StokesVector> detector_of(const Scene& scene, const PathParams& params) {
  if (params.detector) return params.detector;
  const bool has_filters = std::any_of(scene.meshes.begin(), scene.meshes.end(), [&](const Mesh& mesh) {
    return std::holds_alternative<FilterMaterial>(scene.materials[size_t(mesh.material)].surface);
  });
  return scene.analyser || !has_filters ? scene.analyser : std::optional(all_light);
}

PathScene::PathScene(const Scene& scene, const Lines& lines, const std::vector<std::string>& path_expressions,
                     const PathParams& params)
    : scene(scene),
      accelerator(scene, params.accelerator, lines_for(scene, lines), params.seed),
      emitters(scene, lines),
      automaton(path_expressions),
      lines(lines_for(scene, lines)),
      parts_lines(bends_differently(scene, lines)),
      detector(detector_of(scene, params)),
      params(params),
      light_lanes(scene.lights.size()),
      mirrors(flat_mirrors(scene, emitters.lights(), lines)),
      has_panes(std::any_of(scene.meshes.begin(), scene.meshes.end(),
                            [&](const Mesh& mesh) { return is_pane(scene.materials[size_t(mesh.material)]); })) {
  require(params.max_depth >= 1, "expected a max_depth of 1 surface or more, got {}", params.max_depth);
  require(params.roulette_depth >= 1, "expected a roulette_depth of 1 surface or more, got {}", params.roulette_depth);
  require(std::isfinite(params.clamp) && params.clamp >= 0, "expected a clamp of 0 W/m²/sr or more, got {}",
          params.clamp);
  for (const Material& material : scene.materials)
    if (const auto* measured = std::get_if<MeasuredMaterial>(&material.surface))
      require_measured(*measured->brdf, lines);
  for (size_t i = 0; i < light_lanes.size(); ++i) {
    const Light& light = emitters.lights()[i];
    if (const auto* rectangle = std::get_if<RectangleLight>(&light))
      light_lanes[i] = lanes_of(*rectangle, accelerator.lift_of(int(i)));
    else if (const auto* point = std::get_if<PointLight>(&light))
      light_lanes[i] = lanes_of(*point);
  }
  caustics = find_caustics(*this, params.caustic_rays);
}

Hero PathScene::hero(int number) const {
  if (!parts_lines) return {};
  return {number, Vec3{number == 0 ? 1.0 : 0.0, number == 1 ? 1.0 : 0.0, number == 2 ? 1.0 : 0.0} * heroes()};
}

Lines PathScene::lines_of(const Hero& hero) const {
  Lines of_hero = lines;
  of_hero.hero = hero.line;
  return of_hero;
}

}  // namespace holotrace
