#include "holotrace/trace/shade_triangles.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "holotrace/base/error.h"
#include "holotrace/base/machine.h"
#include "holotrace/base/threads.h"
#include "holotrace/base/units.h"
#include "holotrace/data/acceptance.h"
#include "holotrace/data/params/parameter.h"
#include "holotrace/data/sources.h"
#include "holotrace/trace/geometry/first_hits.h"
#include "holotrace/trace/geometry/light_surfaces.h"
#include "holotrace/trace/materials/bsdf.h"
#include "holotrace/trace/paths/path.h"
#include "holotrace/trace/shared/texture.h"
#include "holotrace/trace/waves/wave_sets.h"

namespace holotrace {
namespace {

constexpr double view_part = 1.0 / 64;   // largest side of a triangle, over the view's height
constexpr double inset = 0.01;           // sampling point, over the way from a corner to the centroid
constexpr int64_t block_triangles = 64;  // per task
constexpr size_t most_pieces = size_t(1) << 24;

using Corners = std::array<Vec3, 3>;

// A piece of a triangle of a mesh.
struct Piece {
  Corners corners;
  uint32_t mesh, triangle;
};

// Cuts the triangles of meshes into pieces as small as the view requires, without those that lie outside it.
class Cutter {
 public:
  Cutter(const Grid& panel, double tangent)
      : panel_(panel), tangent_(tangent), most_((std::isfinite(tangent) ? 2 * tangent : 2) * view_part) {}

  // @return  false if there would be more than most_pieces
  bool cut(const Corners& c, uint32_t mesh, uint32_t triangle, std::vector<Piece>& pieces) const {
    if (is_outside(c)) return true;
    size_t longest = 0;
    double size = 0;
    for (size_t side = 0; side < 3; ++side)
      if (const double l = length(c[side] - c[(side + 1) % 3]); l > size) longest = side, size = l;
    const double depth = std::abs(c[0].z + c[1].z + c[2].z) / 3;
    if (size <= most_ * depth) {
      if (pieces.size() == most_pieces) return false;
      pieces.push_back({c, mesh, triangle});
      return true;
    }
    const size_t i = longest, j = (longest + 1) % 3;
    Corners first = c, second = c;
    first[j] = second[i] = (c[i] + c[j]) / 2;
    return cut(first, mesh, triangle, pieces) && cut(second, mesh, triangle, pieces);
  }

  // Whether the whole piece lies beyond one edge of the panel's field of view.
  bool is_outside(const Corners& c) const {
    bool is_left = true, is_right = true, is_low = true, is_high = true;
    for (const Vec3 p : c) {
      const double reach = std::abs(p.z) * tangent_;
      is_left = is_left && p.x < panel_.centre_x - panel_.width() / 2 - reach;
      is_right = is_right && p.x > panel_.centre_x + panel_.width() / 2 + reach;
      is_low = is_low && p.y < panel_.centre_y - panel_.height() / 2 - reach;
      is_high = is_high && p.y > panel_.centre_y + panel_.height() / 2 + reach;
    }
    return is_left || is_right || is_low || is_high;
  }

 private:
  const Grid& panel_;
  double tangent_, most_;
};

// The triangle of a mesh that came to most pieces.
struct MostCut {
  size_t pieces = 0, triangle = 0;
  std::string mesh;
  Corners corners{};
};

[[noreturn]] void refuse_many_pieces(const MostCut& t) {
  const auto [back, front] = std::minmax({t.corners[0].z, t.corners[1].z, t.corners[2].z});
  fail(
      "expected a scene that the method triangles cuts into {} pieces or fewer, got more; triangle {} of \"{}\", from z = {} to "
      "{}, comes to {} or more; shorten it, or use another method",
      most_pieces, t.triangle, t.mesh, format_length(back), format_length(front), t.pieces);
}

// The pieces of all triangles that have an area, without those that the panel cannot see.
std::vector<Piece> list_pieces(const Scene& scene, const Grid& panel, double tangent, int64_t& of_meshes) {
  const Cutter cutter(panel, tangent);
  std::vector<Piece> pieces;
  uint32_t id = 0;
  MostCut most_cut;
  const auto add = [&](const Mesh& mesh) {
    for (size_t t = 0; t < mesh.triangles.size(); ++t) {
      Corners c;
      for (size_t j = 0; j < 3; ++j) c[j] = mesh.positions[mesh.triangles[t][j]];
      const bool has_area = length(cross(c[1] - c[0], c[2] - c[0])) > 0;
      if (!has_area) continue;
      if (cutter.is_outside(c)) continue;
      const auto [back, front] = std::minmax({c[0].z, c[1].z, c[2].z});
      if (back <= 0 && front >= 0)
        fail(
            "expected surfaces behind the panel (z < 0) or in front of it (z > 0) for the method triangles, got triangle {} of "
            "\"{}\" from z = {} to {}; cut it at the panel, or use another method",
            t, mesh.name, format_length(back), format_length(front));
      const size_t before = pieces.size();
      const bool is_whole = cutter.cut(c, id, uint32_t(t), pieces);
      if (const size_t count = pieces.size() - before; count > most_cut.pieces) most_cut = {count, t, mesh.name, c};
      if (!is_whole) refuse_many_pieces(most_cut);
    }
    ++id;
  };
  for (const Mesh& mesh : scene.meshes) {
    of_meshes += int64_t(mesh.triangles.size());
    add(mesh);
  }
  for (const LightSurface& surface : light_surfaces(scene)) add(surface.mesh);
  return pieces;
}

/// Data shared by all pieces of a shading.
struct Shade {
  const PathScene& scene;
  const TraceParams& params;
  const Grid& panel;
  const std::vector<WaveSet>& sets;
  Shading shading;
  double longest;  // longest wavelength; its beams are the widest
};

// Light from a place on a piece toward the place that its light reaches next to the panel's centre; none if something hides it.
std::optional<LeafLight> light_at(const Shade& s, const Piece& piece, Vec3 place, uint64_t sample, PathCounts& counts) {
  const double radius = box_radius(std::abs(place.z), s.longest, s.panel.pitch);
  const Vec3 eye{std::clamp(s.panel.centre_x, place.x - radius, place.x + radius),
                 std::clamp(s.panel.centre_y, place.y - radius, place.y + radius), 0};
  const Ray ray = s.scene.accelerator.from_viewer({eye, normalize(place.z < 0 ? place - eye : eye - place)});
  const double distance = length(place - ray.origin);
  ++counts.rays;
  auto hit = s.scene.accelerator.closest_hit(ray);
  const Mesh* mesh = piece.mesh < s.scene.scene.meshes.size() ? &s.scene.scene.meshes[piece.mesh] : nullptr;
  const bool is_veil = mesh && !is_opaque(s.scene.scene.materials[size_t(mesh->material)]);
  if (is_veil) {                     // it shines by the part of its opacity: what is drawn are the veils before it
    constexpr double before = 1e-4;  // of the distance
    ++counts.shadow_rays;
    if (s.scene.accelerator.is_occluded(ray, distance * (1 - before))) return std::nullopt;
    const Vec3 start = ray.origin + ray.direction * (distance * (1 - before));
    hit = s.scene.accelerator.closest_hit({start, ray.direction}, Aim::exact, {Veils::Kind::met});
    if (hit) hit->distance += distance * (1 - before);
  }
  if (!hit) return std::nullopt;
  const bool is_own = hit->point.mesh == piece.mesh && hit->point.triangle == piece.triangle;
  // Rounding may have found the neighbouring triangle: accept a few times the clearance along the ray.
  const double slope = std::max(1e-3, std::abs(dot(hit->point.geometric_normal, ray.direction)));
  if (!is_own && std::abs(hit->distance - distance) > 4 * hit->point.clearance / slope) return std::nullopt;
  const Material& material = material_at(s.scene.scene, hit->point);
  const PathStart start{shading_point(material, hit->point), -ray.direction, s.scene.automaton.start(), 1};
  LeafLight light;
  light.radiance.resize(size_t(s.scene.sums()));
  mean_radiance(s.scene, start, s.params.paths, sample, light.radiance, counts);
  if (is_veil)
    for (auto& radiance : light.radiance) radiance *= opacity_at(material, hit->point.uv);
  return light;
}

// Solid angle of the part of the panel that light from a place reaches within the panel's acceptance [sr].
double solid_angle(Vec3 place, const Grid& panel, double wavelength) {
  const double depth = std::abs(place.z), radius = box_radius(depth, wavelength, panel.pitch);
  const double x = panel.centre_x - place.x, y = panel.centre_y - place.y;
  const double x0 = std::max(x - panel.width() / 2, -radius), x1 = std::min(x + panel.width() / 2, radius);
  const double y0 = std::max(y - panel.height() / 2, -radius), y1 = std::min(y + panel.height() / 2, radius);
  return x1 > x0 && y1 > y0 ? wave_power(depth, x0, x1, y0, y1) / (depth * depth) : 0;
}

// Direction of the light of a piece: the middle of a beam that diffraction makes λ·depth/width wide.
Vec3 direction_from(const Shade& s, const Corners& corners, double cone_wavelength) {
  const Grid& panel = s.panel;
  const Vec3 place = (corners[0] + corners[1] + corners[2]) / 3;
  const double depth = std::abs(place.z), radius = box_radius(depth, cone_wavelength, panel.pitch);
  const double width = std::sqrt(length(cross(corners[1] - corners[0], corners[2] - corners[0])));
  const double beam = s.longest * depth / width;
  // Aims at the nearest point of the panel's part in the box, with a margin at its ends.
  const auto aim = [&](double from, double centre, double side) {
    const double low = std::max(centre - side / 2, from - radius), high = std::min(centre + side / 2, from + radius);
    if (low >= high) return std::clamp(centre - from, -radius, radius);  // the panel does not see it
    const double margin = std::min(std::max((high - low) / 8, beam), (high - low) / 2);
    return std::clamp(from, low + margin, high - margin) - from;
  };
  const Vec3 to_panel{aim(place.x, panel.centre_x, panel.width()), aim(place.y, panel.centre_y, panel.height()),
                      -place.z};
  return normalize(place.z < 0 ? to_panel : -to_panel);
}

/// Results of one task: triangles and keys of each set.
struct ShadedBlock {
  std::vector<std::vector<Triangle>> triangles;
  std::vector<std::vector<uint64_t>> keys;
  PathCounts counts;
};

void shade_piece(const Shade& s, const Piece& piece, uint64_t index, ShadedBlock& block) {
  const Vec3 centre = (piece.corners[0] + piece.corners[1] + piece.corners[2]) / 3;
  std::array<std::optional<LeafLight>, 3> lights;
  if (s.shading == Shading::flat)
    lights[0] = light_at(s, piece, centre, 3 * index, block.counts);
  else
    for (size_t j = 0; j < 3; ++j)
      lights[j] =
          light_at(s, piece, piece.corners[j] + (centre - piece.corners[j]) * inset, 3 * index + j, block.counts);
  for (size_t i = 0; i < s.sets.size(); ++i) {
    const WaveSet& set = s.sets[i];
    const double angle = solid_angle(centre, s.panel, set.cone());
    Triangle t{piece.corners, {}, 0, direction_from(s, piece.corners, set.cone())};
    bool is_lit = false;
    for (size_t j = 0; j < 3; ++j) {
      const auto& light = lights[s.shading == Shading::flat ? 0 : j];
      const double radiance = light && !set.sums.empty() ? light_of(set, *light, {1, 1, 1}).radiance : 0;
      t.amplitudes[j] = float(std::sqrt(squared_amplitude_of(radiance, s.params.amplitude) * angle));
      is_lit = is_lit || t.amplitudes[j] > 0;
    }
    if (!is_lit) continue;
    block.triangles[i].push_back(t);
    block.keys[i].push_back(index);
  }
}

void warn_of_left_out(const Scene& scene, const TraceParams& params, const std::vector<WaveSet>& sets,
                      const Observer& observer) {
  if (!scene.points.empty())
    observer.warn(
        fmt::format("{} luminous points are left out: the method triangles shows only surfaces", scene.points.size()));
  if (params.has_background)
    observer.warn(
        "the method triangles leaves out the background, which has no triangles; use another method to show it");
  if (std::any_of(sets.begin(), sets.end(), [](const WaveSet& set) { return set.has_laser; }))
    observer.warn("the method triangles does not follow the phase of lasers: it treats their light as incoherent");
}

}  // namespace

void check_shading(const Scene& scene, const TraceParams& params) {
  check_ranges(params);
  require(params.strategy == Strategy::shared,
          "expected the strategy shared with the method triangles, got {}; triangles have one brightness for the whole "
          "panel",
          params.strategy == Strategy::tiled ? "tiled" : "gather");
  require(scene.media.empty(),
          "expected a scene without media for the method triangles, got the medium \"{}\"; use another method",
          scene.media.empty() ? "" : scene.media.front().name);
  require(has_surfaces(scene),
          "expected a scene with meshes for the method triangles, got only luminous points; add an object that "
          "is a surface, or use another method");
}

std::vector<Triangles> shade_triangles(const Scene& scene, const Grid& panel, const std::vector<double>& wavelengths,
                                       const TraceParams& params, Shading shading, TrianglePhase phase,
                                       const Observer& observer) {
  check_scene(scene);
  check_grid(panel);
  require(!wavelengths.empty(), "expected at least one wavelength, got none");
  for (const double wavelength : wavelengths) check_wavelength(wavelength, panel);
  check_shading(scene, params);
  const Cones cones = cones_of(wavelengths, params);
  const double longest = *std::max_element(wavelengths.begin(), wavelengths.end());
  int64_t of_meshes = 0, shining = 0;
  const std::vector<Piece> pieces =
      list_pieces(scene, panel, acceptance_tangent(cones.of_rays, panel.pitch), of_meshes);
  observer.fact("mesh_triangles", Fact(of_meshes));
  observer.fact("triangles", Fact(int64_t(pieces.size())));
  std::vector<Triangles> all;
  require(!params.separate_polarizations,
          "expected a method of waves for separate_polarizations, got triangles; leave out separate_polarizations");
  const Component whole = components_of(scene, params).front();
  PathCounts counts;
  const auto groups = group_wavelengths(scene, wavelengths);
  for (size_t g = 0; g < groups.size(); ++g) {
    const PathScene path_scene(scene, lines_of(groups[g]), params.path_expressions, path_params(whole));
    const std::vector<WaveSet> sets = list_sets(path_scene, whole, groups[g], cones);
    if (g == 0) warn_of_left_out(scene, params, sets, observer);
    require_memory(2 * double(sizeof(Triangle) + 8) * double(pieces.size()) * double(sets.size()),
                   fmt::format("{} sets of {} triangles", sets.size(), pieces.size()));
    const Shade shade{path_scene, params, panel, sets, shading, longest};
    std::vector<ShadedBlock> blocks((pieces.size() + block_triangles - 1) / block_triangles);
    parallel_for(
        0, int64_t(blocks.size()),
        [&](int64_t b) {
          ShadedBlock& block = blocks[size_t(b)];
          block.triangles.resize(sets.size());
          block.keys.resize(sets.size());
          const int64_t end = std::min(int64_t(pieces.size()), (b + 1) * block_triangles);
          for (int64_t i = b * block_triangles; i < end; ++i) shade_piece(shade, pieces[size_t(i)], uint64_t(i), block);
        },
        part_of(observer, int(g), int(groups.size())));
    for (const ShadedBlock& block : blocks) counts += block.counts;
    for (size_t i = 0; i < sets.size(); ++i) {
      Triangles set;
      set.wavelength = sets[i].wavelength;
      set.seed = uint64_t(params.seed);
      set.label.name = sets[i].name;
      set.label.cone_wavelength = sets[i].cone_wavelength;
      for (const ShadedBlock& block : blocks) {
        set.triangles.insert(set.triangles.end(), block.triangles[i].begin(), block.triangles[i].end());
        if (phase == TrianglePhase::random)
          set.phase_keys.insert(set.phase_keys.end(), block.keys[i].begin(), block.keys[i].end());
      }
      for (size_t k = 0; k < set.phase_keys.size(); ++k)
        set.triangles[k].phase = float(random_phase(set.seed, 0, set.phase_keys[k]));
      shining += int64_t(set.triangles.size());
      const bool is_whole = !params.separate_path_groups && !params.separate_lights;
      if (is_whole || !set.triangles.empty()) all.push_back(std::move(set));
    }
  }
  report(counts, params.max_depth, observer);
  report(cones, wavelengths, panel, observer);
  observer.fact("shining", Fact(shining));
  if (shining == 0)
    observer.warn("no triangle sends light toward the panel's centre; move the scene onto the axis, or light it");
  return all;
}

}  // namespace holotrace
