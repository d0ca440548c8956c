#include "holotrace/trace/geometry/medium_boundaries.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <tuple>
#include <utility>

#include "holotrace/base/error.h"
#include "holotrace/base/units.h"

namespace holotrace {

namespace {

Welded weld(const Mesh& mesh) {
  Box bounds;
  for (const Vec3& p : mesh.positions) bounds.include(p);
  const double quantum = std::max(1e-6 * length(bounds.high - bounds.low), 1e-300);
  Welded welded;
  std::map<std::array<int64_t, 3>, uint32_t> places;
  for (const Vec3& p : mesh.positions) {
    // The offset keeps the round numbers at which models place vertices away from where rounding decides.
    const auto cell = [&](double v) { return int64_t(std::floor(v / quantum + 0.382)); };
    const Vec3 q = p - bounds.low;
    const auto [place, is_new] =
        places.emplace(std::array{cell(q.x), cell(q.y), cell(q.z)}, uint32_t(welded.places.size()));
    if (is_new) welded.places.push_back(p);
    welded.number.push_back(place->second);
  }
  std::map<std::pair<uint32_t, uint32_t>, int> edges;
  for (const auto& triangle : mesh.triangles)
    for (size_t n = 0; n < 3; ++n) {
      const uint32_t a = welded.number[triangle[n]], b = welded.number[triangle[(n + 1) % 3]];
      if (a != b) edges[std::minmax(a, b)] += a < b ? 1 : -1;
    }
  welded.open_edges =
      size_t(std::count_if(edges.begin(), edges.end(), [](const auto& edge) { return edge.second != 0; }));
  return welded;
}

/// The volume of a closed mesh, whichever way its faces are turned [m³].
double volume_of(const Mesh& mesh, const Welded& welded) {
  const Vec3 from = welded.places.front();
  double sum = 0;
  for (const auto& [i, j, k] : mesh.triangles) {
    const auto corner = [&](uint32_t vertex) { return welded.places[welded.number[vertex]] - from; };
    sum += dot(corner(i), cross(corner(j), corner(k))) / 6;
  }
  return std::abs(sum);
}

double volume_of(const Box& box) {
  const Vec3 size = box.high - box.low;
  return size.x * size.y * size.z;
}

/// The layers around a solid that light enters, if a mesh bounds one.
const PrincipledMaterial* layers_of_solid(const Material& material) {
  const auto* layers = std::get_if<PrincipledMaterial>(&material.surface);
  return layers && layers->transmission.value > 0 && !layers->is_thin ? layers : nullptr;
}

bool is_solid(const Material& material) {
  if (const auto* glass = std::get_if<DielectricMaterial>(&material.surface)) return !glass->is_thin;
  return layers_of_solid(material) != nullptr;
}

/// The box of a medium without a mesh: all space behind the panel, if it has none of its own.
Box box_of(const Medium& medium) {
  constexpr double unending = std::numeric_limits<double>::infinity();
  if (!medium.box) return {{-unending, -unending, -unending}, {unending, unending, 0}};
  return {medium.box->low, medium.box->high};
}

void check_mesh_around(const Medium& medium, const Mesh& mesh, size_t open_edges) {
  require(open_edges == 0,
          "expected a closed mesh around the medium \"{}\", got the mesh \"{}\" with {} open edges; close it, or "
          "fill a box",
          medium.name, mesh.name, open_edges);
  const auto [back, front] = std::minmax_element(mesh.positions.begin(), mesh.positions.end(),
                                                 [](const Vec3& a, const Vec3& b) { return a.z < b.z; });
  require(!(back->z < 0 && front->z > 0),
          "expected the mesh \"{}\" with the medium \"{}\" on one side of the panel, got one from z = {} to {}; "
          "move it behind the panel",
          mesh.name, medium.name, format_length(back->z), format_length(front->z));
}

}  // namespace

bool absorbs(const Material& material) {
  const PrincipledMaterial* layers = layers_of_solid(material);
  return layers && material.medium < 0 && std::isfinite(layers->attenuation_distance) &&
         !(layers->attenuation_color == Vec3{1, 1, 1});
}

Vec3 absorption_of(const Material& solid, const Lines& lines) {
  const PrincipledMaterial& layers = *layers_of_solid(solid);
  const Vec3 colour = lines.reflectance_of(layers.attenuation_color);
  const auto of = [&](double share) {
    return -std::log(std::clamp(share, std::numeric_limits<double>::min(), 1.0)) / layers.attenuation_distance;
  };
  return {of(colour.x), of(colour.y), of(colour.z)};
}

std::vector<MediumBoundary> boundaries_of(const Scene& scene) {
  std::vector<MediumBoundary> all;
  for (size_t i = 0; i < scene.media.size(); ++i)
    if (const Box box = box_of(scene.media[i]); scene.media[i].is_open)
      all.push_back({int(i), box, nullptr, {}, float(volume_of(box))});
  for (const Mesh& mesh : scene.meshes) {
    const Material& material = scene.materials[size_t(mesh.material)];
    if (mesh.triangles.empty() || (material.medium < 0 && !is_solid(material))) continue;
    Welded welded = weld(mesh);
    const bool is_empty = material.medium < 0 && !absorbs(material);
    if (is_empty && welded.open_edges > 0) continue;
    if (material.medium >= 0) check_mesh_around(scene.media[size_t(material.medium)], mesh, welded.open_edges);
    const auto volume = float(volume_of(mesh, welded));
    all.push_back({material.medium, {}, &mesh, std::move(welded), volume, is_empty});
  }
  const auto rank = [](const MediumBoundary& b) { return std::tuple(b.volume, !b.mesh, b.is_empty); };
  std::stable_sort(all.begin(), all.end(),
                   [&](const MediumBoundary& a, const MediumBoundary& b) { return rank(a) < rank(b); });
  return all;
}

}  // namespace holotrace
