#include "holotrace/trace/lights/emissive_triangles.h"

#include <algorithm>
#include <cmath>

#include "holotrace/trace/materials/bsdf.h"
#include "holotrace/trace/materials/texture.h"

namespace holotrace {

namespace {

double sum(Vec3 v) { return v.x + v.y + v.z; }

/// Mean of a texture over all its pixels.
Vec3 mean_of(const Image& image) {
  Vec3 total;
  for (int row = 0; row < image.ny; ++row)
    for (int column = 0; column < image.nx; ++column)
      total += image.channels < 3 ? Vec3{1, 1, 1} * double(image(row, column))
                                  : Vec3{image(row, column, 0), image(row, column, 1), image(row, column, 2)};
  return total / (double(image.nx) * image.ny);
}

/// Mean of the emission texture over the 16 similar triangles into which a triangle is cut.
Vec3 mean_over(const Image& texture, Vec2 a, Vec2 b, Vec2 c) {
  Vec3 total;
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4 - i; ++j)
      for (const double third : {1.0, 2.0}) {  // upward triangles and, inside the border, downward ones
        const double s = (i + third / 3) / 4, t = (j + third / 3) / 4;
        if (s + t < 1)
          total +=
              eval_texture(texture, {a.x + (b.x - a.x) * s + (c.x - a.x) * t, a.y + (b.y - a.y) * s + (c.y - a.y) * t});
      }
  return total / 16;
}

}  // namespace

EmissiveTriangles::EmissiveTriangles(const Scene& scene, const Lines& lines)
    : scene_(scene), lines_(lines), densities_(scene.meshes.size()) {
  std::vector<double> means;  // mean of each material
  for (const Material& material : scene.materials) {
    const Vec3 texture = material.emission_texture ? mean_of(*material.emission_texture) : Vec3{1, 1, 1};
    means.push_back(sum(lines.from_rgb(material.emission * texture)));
    radiances_.push_back(lines.from_rgb(material.emission));
    has_texture_ |= material.emission_texture != nullptr;
  }
  double total = 0;
  for (size_t m = 0; m < scene.meshes.size(); ++m) {
    const Mesh& mesh = scene.meshes[m];
    const Material& material = scene.materials[size_t(mesh.material)];
    const double mean = means[size_t(mesh.material)];
    if (mean <= 0) continue;
    densities_[m].resize(mesh.triangles.size());
    for (size_t t = 0; t < mesh.triangles.size(); ++t) {
      const auto [i, j, k] = mesh.triangles[t];
      const Vec3 a = mesh.positions[i], ab = mesh.positions[j] - a, ac = mesh.positions[k] - a;
      const double area = length(cross(ab, ac)) / 2;
      double radiance = mean;
      if (material.emission_texture && !mesh.texture_coordinates.empty()) {
        const auto& uv = mesh.texture_coordinates;
        const Vec3 texture = mean_over(*material.emission_texture, uv[i], uv[j], uv[k]);
        radiance = sum(lines.from_rgb(material.emission * texture));
      }
      const double density = area > 0 ? radiance + mean / 20 : 0;  // a triangle without area is never met
      if (!(density * area > 0)) continue;
      densities_[m][t] = float(density);
      const double first = total, longest = std::max({length(ab), length(ac), length(ac - ab)});
      total += double(densities_[m][t]) * area;
      triangles_.push_back({uint32_t(m), uint32_t(t), a, ab, ac, 1 / (2 * area), longest, 0, first, total, 0});
    }
  }
  for (auto& densities : densities_)
    for (float& density : densities) density = float(density / total);
  if (triangles_.empty()) return;
  for (Triangle& triangle : triangles_) {
    triangle.density = double(densities_[triangle.mesh][triangle.index]);
    triangle.first /= total, triangle.end /= total;
    triangle.per_probability = 1 / (triangle.end - triangle.first);
  }
  triangles_.back().end = 1;
  uint32_t selected = 0;
  for (size_t i = 0; i < triangles_.size(); ++i) {
    while (triangles_[selected].end <= double(i) / double(triangles_.size())) ++selected;
    cutpoints_.push_back(selected);
  }
}

Vec3 EmissiveTriangles::radiance_of(const Triangle& triangle, bool is_front, double b1, double b2) const {
  const Mesh& mesh = scene_.meshes[triangle.mesh];
  const Material& material = scene_.materials[size_t(mesh.material)];
  if (!is_front && !material.two_sided) return {};
  if (!material.emission_texture) return radiances_[size_t(mesh.material)];
  SurfacePoint point;
  point.is_front = is_front;
  if (!mesh.texture_coordinates.empty()) {
    const auto [i, j, k] = mesh.triangles[triangle.index];
    const auto& uv = mesh.texture_coordinates;
    const double b0 = 1 - b1 - b2;
    point.uv = {uv[i].x * b0 + uv[j].x * b1 + uv[k].x * b2, uv[i].y * b0 + uv[j].y * b1 + uv[k].y * b2};
  }
  return emitted_radiance(material, point, lines_);
}

const EmissiveTriangles::Triangle& EmissiveTriangles::selected_by(double u) const {
  size_t selected = cutpoints_[std::min(size_t(u * double(triangles_.size())), triangles_.size() - 1)];
  while (triangles_[selected].end <= u) ++selected;
  return triangles_[selected];
}

void EmissiveTriangles::select(Vec2 u, size_t i, LightLanes& lanes, PlaceLanes& places) const {
  const Triangle& triangle = selected_by(u.x);
  const int material = scene_.meshes[triangle.mesh].material;
  lanes.corner.set(i, triangle.corner);
  lanes.edge_u.set(i, triangle.edge_u);
  lanes.edge_v.set(i, triangle.edge_v);
  lanes.per_size[i] = triangle.per_twice_area;
  lanes.density[i] = triangle.density;
  lanes.size[i] = triangle.longest;
  lanes.two_sided[i] = scene_.materials[size_t(material)].two_sided;
  lanes.radiance.set(i, radiances_[size_t(material)]);
  places.set(i, {place_in(triangle, u.x), u.y});
}

LightSample EmissiveTriangles::sample(Vec3 from, Vec2 u) const {
  const Triangle& triangle = selected_by(u.x);
  const double root = std::sqrt(place_in(triangle, u.x)), b1 = root * (1 - u.y),
               b2 = root * u.y;  // uniform over the triangle
  const Vec3 way = triangle.corner + triangle.edge_u * b1 + triangle.edge_v * b2 - from;
  const double projected = dot(cross(triangle.edge_u, triangle.edge_v), way);  // 2A·cosθ'·d, below 0 in front
  if (projected == 0) return {};  // the point is on the surface or in its plane
  const double distance = length(way), inverse = 1 / distance;
  const double cosine = std::abs(projected) * inverse * triangle.per_twice_area;
  return {way * inverse,
          distance,
          radiance_of(triangle, projected < 0, b1, b2),
          triangle.density * distance * distance / cosine,
          cosine,
          triangle.longest};
}

}  // namespace holotrace
