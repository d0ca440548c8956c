#include "holotrace/trace/lights/emitters.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "holotrace/base/error.h"
#include "holotrace/base/units.h"
#include "holotrace/data/cie.h"
#include "holotrace/trace/materials/bsdf.h"

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
    means.push_back(sum(emission_of(material, texture, lines)));
    radiances_.push_back(emission_of(material, {1, 1, 1}, lines));
    has_texture_ |= material.emission_texture != nullptr || (means.back() > 0 && !is_opaque(material));
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
        radiance = sum(emission_of(material, texture, lines));
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
  if (!material.emission_texture && is_opaque(material)) return radiances_[size_t(mesh.material)];
  SurfacePoint point;
  point.is_front = is_front;
  if (!mesh.texture_coordinates.empty()) {
    const auto [i, j, k] = mesh.triangles[triangle.index];
    const auto& uv = mesh.texture_coordinates;
    const double b0 = 1 - b1 - b2;
    point.uv = {uv[i].x * b0 + uv[j].x * b1 + uv[k].x * b2, uv[i].y * b0 + uv[j].y * b1 + uv[k].y * b2};
  }
  return emitted_radiance(material, point, lines_) * opacity_at(material, point.uv);
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

namespace {

/// The interval of an ascending table of cumulative shares that contains u, and the position of u in it, in [0, 1).
struct Interval {
  int index;
  double rest;
};

template <class Iterator>
Interval find_interval(Iterator begin, Iterator end, double u) {
  const auto found = std::upper_bound(begin, end - 1, u);
  const double low = found == begin ? 0 : *(found - 1), width = *found - low;
  return {int(found - begin), width > 0 ? std::min((u - low) / width, 1 - 0x1p-53) : 0.5};
}

constexpr int sky_columns = 256;

double cosine_of_edge(int row, int ny) { return std::cos(pi * row / ny); }

}  // namespace

Vec2 environment_place(Vec3 direction, double turn) {
  const double x = 0.5 + (std::atan2(direction.x, -direction.z) + turn) / (2 * pi);
  return {x - std::floor(x), std::acos(std::clamp(direction.y, -1.0, 1.0)) / pi};
}

Vec3 environment_direction(Vec2 place, double turn) {
  const double azimuth = (place.x - 0.5) * 2 * pi - turn, sine = std::sin(pi * place.y);
  return {sine * std::sin(azimuth), std::cos(pi * place.y), -sine * std::cos(azimuth)};
}

EnvironmentLight::EnvironmentLight(const Environment& environment, const Lines& lines)
    : environment_(environment), lines_(lines), scale_(lines.from_rgb(environment.scale)) {
  if (environment.sky) sky_.emplace(*environment.sky, lines);
  nx_ = sky_ ? sky_columns : environment.map->nx;
  ny_ = sky_ ? sky_columns / 2 : environment.map->ny;
  means_.reserve(size_t(nx_) * size_t(ny_));
  cumulative_.reserve(means_.capacity());
  for (int row = 0; row < ny_; ++row) {
    double sum = 0;
    for (int column = 0; column < nx_; ++column) {
      // The mean of the bilinear radiance over a pixel has weights 1/8, 6/8, 1/8 along either axis.
      Vec3 mean;
      for (const int j : {-1, 0, 1})
        for (const int i : {-1, 0, 1})
          mean += pixel(row + j, column + i) * ((j == 0 ? 0.75 : 0.125) * (i == 0 ? 0.75 : 0.125));
      means_.push_back(float(mean.x + mean.y + mean.z));
      sum += double(means_.back());
      cumulative_.push_back(sum);
    }
    if (sum > 0)
      for (auto value = cumulative_.end() - nx_; value != cumulative_.end(); ++value) *value /= sum;
    total_ += sum * 2 * pi / nx_ * (cosine_of_edge(row, ny_) - cosine_of_edge(row + 1, ny_));
    rows_.push_back(total_);
  }
  if (total_ > 0)
    for (double& value : rows_) value /= total_;
  if (!sky_) return;
  const Vec3 sun = scale_ * sky_->sun_radiance() * sun_solid_angle;
  const double of_sun = sun.x + sun.y + sun.z;
  sun_share_ = of_sun > 0 ? of_sun / (of_sun + total_) : 0;
}

/// The colour of a pixel at the lines; columns wrap around, rows are clamped.
Vec3 EnvironmentLight::pixel(int row, int column) const {
  row = std::clamp(row, 0, ny_ - 1);
  column = (column % nx_ + nx_) % nx_;
  if (sky_) return scale_ * sky_->sky_radiance(environment_direction({(column + 0.5) / nx_, (row + 0.5) / ny_}, 0));
  const Image& map = *environment_.map;
  const Vec3 rgb = map.channels < 3 ? Vec3{1, 1, 1} * double(map(row, column))
                                    : Vec3{map(row, column, 0), map(row, column, 1), map(row, column, 2)};
  return lines_.from_rgb(environment_.scale * rgb);
}

Vec3 EnvironmentLight::radiance_at(Vec2 place) const {
  const double x = place.x * nx_ - 0.5, y = place.y * ny_ - 0.5, left = std::floor(x), top = std::floor(y);
  const double s = x - left, t = y - top;
  const int column = int(left), row = int(top);
  return (pixel(row, column) * (1 - s) + pixel(row, column + 1) * s) * (1 - t) +
         (pixel(row + 1, column) * (1 - s) + pixel(row + 1, column + 1) * s) * t;
}

Vec3 EnvironmentLight::radiance(Vec3 direction) const {
  if (sky_) {
    const Vec3 light = sky_->sky_radiance(direction);
    return scale_ * (sky_->is_in_sun(direction) ? light + sky_->sun_radiance() : light);
  }
  return radiance_at(environment_place(direction, environment_.turn));
}

LightSample EnvironmentLight::sample(Vec2 u) const {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  if (u.x < sun_share_) {  // in the disc, evenly
    const double sine = sun_radius * std::sqrt(u.x / sun_share_);
    const Vec2 place = point_on_circle(u.y);
    const Vec3 direction = transform_vector(frame_from_normal(sky_->sun_direction()),
                                            {sine * place.x, sine * place.y, std::sqrt(1 - sine * sine)});
    return {direction, infinity, radiance(direction), pdf(direction)};
  }
  if (!(total_ > 0)) return {};
  u.x = std::min((u.x - sun_share_) / (1 - sun_share_), 1 - 0x1p-53);
  const Interval row = find_interval(rows_.begin(), rows_.end(), u.y);
  const auto begin = cumulative_.begin() + ptrdiff_t(row.index) * nx_;
  const Interval column = find_interval(begin, begin + nx_, u.x);
  const double top = cosine_of_edge(row.index, ny_), bottom = cosine_of_edge(row.index + 1, ny_);
  const Vec2 place{(column.index + column.rest) / nx_, std::acos(top + (bottom - top) * row.rest) / pi};
  const double density = double(means_[size_t(row.index) * size_t(nx_) + size_t(column.index)]) / total_;
  if (!(density > 0)) return {};
  const Vec3 direction = environment_direction(place, environment_.turn);
  if (sky_) return {direction, infinity, radiance(direction), pdf(direction)};
  return {direction, infinity, radiance_at(place), density};
}

double EnvironmentLight::pixel_pdf(Vec3 direction) const {
  if (!(total_ > 0)) return 0;
  const Vec2 place = environment_place(direction, environment_.turn);
  const int row = std::min(int(place.y * ny_), ny_ - 1), column = std::min(int(place.x * nx_), nx_ - 1);
  return double(means_[size_t(row) * size_t(nx_) + size_t(column)]) / total_;
}

double EnvironmentLight::pdf(Vec3 direction) const {
  const double of_pixels = pixel_pdf(direction);
  if (!(sun_share_ > 0)) return of_pixels;
  const bool is_in_disc = dot(direction, sky_->sun_direction()) >= std::cos(sun_radius);
  return of_pixels * (1 - sun_share_) + (is_in_disc ? sun_share_ / sun_solid_angle : 0);
}

namespace {

/// @throws Error  for a line outside of the range from `shortest` to `longest` [m]
void require_lines_in(const Lines& lines, double shortest, double longest, const std::string& what) {
  constexpr double rounding = 1e-15;
  for (const double line : lines.wavelengths)
    require(line >= shortest - rounding && line <= longest + rounding,
            "expected wavelengths from {} to {}, those of {}, got {}", format_length(shortest), format_length(longest),
            what, format_length(line));
}

Vec3& strength(PointLight& light) { return light.intensity; }
Vec3& strength(SpotLight& light) { return light.intensity; }
Vec3& strength(DirectionalLight& light) { return light.irradiance; }
Vec3& strength(RectangleLight& light) { return light.radiance; }

}  // namespace

Emitters::Emitters(const Scene& scene, const Lines& lines)
    : lights_(scene.lights), triangles_(scene, lines), background_(lines.from_rgb(scene.background)) {
  for (size_t i = 0; i < lights_.size(); ++i) {
    std::visit(
        [&](auto& light) {
          strength(light) = lines.from_rgb(strength(light));
          if (!light.spectrum) return;
          const std::vector<double>& known = light.spectrum->wavelengths;
          require_lines_in(lines, known.front(), known.back(), fmt::format("the spectrum of light {}", i));
          strength(light) *= lines.values_of(*light.spectrum);
        },
        lights_[i]);
    const auto* rectangle = std::get_if<RectangleLight>(&lights_[i]);
    if (rectangle && !rectangle->is_visible) lights_on_way_.push_back(int(i));
  }
  for (size_t i = 0; i < scene.materials.size(); ++i) {
    const Material& material = scene.materials[i];
    if (const auto& spectrum = material.emission_spectrum)
      require_lines_in(lines, spectrum->wavelengths.front(), spectrum->wavelengths.back(),
                       fmt::format("the spectrum of material {}", i));
    is_emissive_.push_back(is_hot(material) || max_component(emission_of(material, {1, 1, 1}, lines)) > 0);
  }
  if (scene.environment && scene.environment->sky)
    require_lines_in(lines, shortest_visible, longest_visible, "the sky");
  if (scene.environment) environment_.emplace(*scene.environment, lines);
  shine_on_way_ = environment_ || max_component(background_) > 0 || !lights_on_way_.empty();
  shine_beyond_surfaces_ = shine_on_way_ || std::any_of(lights_.begin(), lights_.end(), has_area);
}

std::string Emitters::group_name(int group) const {
  if (group == mesh_group()) return "emission";
  return group == background_group() ? "background" : "light " + std::to_string(group);
}

}  // namespace holotrace
