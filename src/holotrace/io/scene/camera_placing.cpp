#include "holotrace/io/scene/camera_placing.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "holotrace/base/error.h"
#include "holotrace/base/message_text.h"
#include "holotrace/data/shapes.h"

namespace holotrace {

double distance_of_models(const Grid& panel) { return 300.0 / 15.36 * panel.width(); }

void move(const Frame& frame, std::vector<Mesh>& meshes) {
  for (Mesh& mesh : meshes) transform_mesh(frame, mesh);
}

Frame shift(Vec3 by) { return {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, by}; }
Frame scale(double factor) { return {{factor, 0, 0}, {0, factor, 0}, {0, 0, factor}, {}}; }

// The distance up to which is a part of all areas; 0 if there are none.
double part_of(std::vector<std::pair<double, double>>& distances_and_areas, double part) {
  std::sort(distances_and_areas.begin(), distances_and_areas.end());
  double total = 0, sum = 0;
  for (const auto& [distance, area] : distances_and_areas) total += area;
  for (const auto& [distance, area] : distances_and_areas)
    if ((sum += area) >= part * total) return distance;
  return distances_and_areas.empty() ? 0 : distances_and_areas.back().first;
}

namespace {

// Into the frame of a camera, without the scale of its node.
Frame into_camera(const ModelCamera& camera) {
  const Vec3 x = normalize(camera.place.x), y = normalize(camera.place.y), z = normalize(camera.place.z);
  const Frame turn{{x.x, y.x, z.x}, {x.y, y.y, z.y}, {x.z, y.z, z.z}, {}};
  return compose(turn, shift(camera.place.origin * -1.0));
}

// The parts of meshes, in the camera's frame, that are in its picture: |x|/aspect and |y| are at most offset − slope·z, z ≤ 0.
std::vector<Mesh> in_picture(const std::vector<Mesh>& meshes, const ModelCamera& camera, double aspect,
                             const std::vector<HalfSpace>& further = {}) {
  std::vector<HalfSpace> picture = further;
  picture.push_back({{0, 0, -1}, 0});
  for (const double side : {-1.0, 1.0})
    for (const Vec3 across : {Vec3{side / aspect, 0, 0}, Vec3{0, side, 0}})
      picture.push_back({across - Vec3{0, 0, camera.slope}, -camera.offset});
  std::vector<Mesh> seen;
  for (const Mesh& mesh : meshes) seen.push_back(clip_mesh(mesh, picture));
  return seen;
}

}  // namespace

CameraPlacing::CameraPlacing(const std::string& path, const ModelCamera& camera, std::vector<Mesh> meshes,
                             const Grid& panel, double distance)
    : distance_(distance), aspect_(panel.width() / panel.height()) {
  move(into_camera(camera), meshes);
  std::vector<std::pair<double, double>> parts;  // distance, area in the picture
  for (const Mesh& mesh : in_picture(meshes, camera, aspect_))
    for (const auto& [a, b, c] : mesh.triangles) {
      const Vec3 p = mesh.positions[a], q = mesh.positions[b], r = mesh.positions[c];
      const double away = -(p.z + q.z + r.z) / 3, half = camera.offset + camera.slope * away;
      parts.emplace_back(away, std::abs(cross(q - p, r - p).z) / (half * half));
    }
  middle_ = part_of(parts, 0.5);
  require(middle_ > 0, "{}: expected a camera that sees the model, got \"{}\", which does not; choose another", path,
          camera.name);
  factor_ = panel.height() / (2 * (camera.offset + camera.slope * middle_));
}

Frame CameraPlacing::place(const ModelCamera& camera, std::vector<Mesh>& meshes) const {
  move(into_camera(camera), meshes);
  std::vector<Mesh> seen = in_picture(meshes, camera, aspect_, {{{0, 0, 1}, -middle_}});
  const double beyond = middle_ * (1 + 1e-9);  // surfaces in the plane of the middle are not taken twice
  for (const Mesh& mesh : meshes) seen.push_back(clip_mesh(mesh, {{{0, 0, -1}, beyond}}));
  std::erase_if(seen, [](const Mesh& mesh) { return mesh.triangles.empty(); });
  meshes = std::move(seen);
  const Frame before_panel = compose(shift({0, 0, factor_ * middle_ - distance_}), scale(factor_));
  move(before_panel, meshes);
  return compose(before_panel, into_camera(camera));
}

const ModelCamera& camera_named(const std::string& name, const std::string& path, const LoadedModel& model) {
  std::vector<std::string> names;
  for (const ModelCamera& camera : model.cameras) {
    if (camera.name == name) return camera;
    names.push_back(camera.name);
  }
  const auto& cameras = model.cameras;
  for (size_t i = 0; i < cameras.size(); ++i)
    if (name == std::to_string(i + 1)) return cameras[i];
  require(!names.empty(),
          "{}: expected a file with cameras for the camera \"{}\", got one without; leave the camera out", path, name);
  throw Error(path + ": " + unknown_name_message("camera", name, names));
}

}  // namespace holotrace
