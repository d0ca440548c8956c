#include "holotrace/io/scene/model_job.h"

#include <algorithm>

#include "holotrace/base/error.h"
#include "holotrace/base/units.h"
#include "holotrace/data/shapes.h"
#include "holotrace/io/mesh/mesh_file.h"
#include "holotrace/io/scene/slm_file.h"

namespace holotrace {
namespace {

using namespace literals;

constexpr double model_size = 7_mm, model_depth = 200_mm;

// The uniform scale and the shift that give the model its size and position.
Frame placing(const std::vector<Mesh>& meshes, const std::string& path) {
  Vec3 low = meshes.front().positions.front(), high = low;
  for (const Mesh& mesh : meshes)
    for (const Vec3 p : mesh.positions) {
      low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
      high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
    }
  const double largest = max_component(high - low);
  require(largest > 0, "{}: expected a model with an extent, got a single point", path);
  const double scale = model_size / largest;
  return {{scale, 0, 0}, {0, scale, 0}, {0, 0, scale}, (low + high) * (-0.5 * scale) + Vec3{0, 0, -model_depth}};
}

// A square lamp above left in front of the model, facing it. Its radiance L lights a white surface that faces it
// to L·A·cos/(π·d²) = 0.7, with A its area, d its distance, and cos = 1.
RectangleLight key_light() {
  constexpr double side = 60_mm, white = 0.7;
  const Vec3 model{0, 0, -model_depth}, middle = model + Vec3{-80_mm, 100_mm, 150_mm};
  const Vec3 way = model - middle, towards = normalize(way);
  const Vec3 u = normalize(cross(Vec3{0, 1, 0}, towards)) * side, v = normalize(cross(towards, u)) * side;
  const double radiance = white * pi * dot(way, way) / (side * side);
  return {middle - u * 0.5 - v * 0.5, u, v, Vec3{1, 1, 1} * radiance};
}

}  // namespace

Job job_for_model(const std::string& path, Outside outside) {
  LoadedModel model = load_meshes(path, outside);
  const Frame frame = placing(model.meshes, path);
  for (Mesh& mesh : model.meshes) transform_mesh(frame, mesh);
  Job job;
  job.scene.materials = std::move(model.materials);
  job.scene.meshes = std::move(model.meshes);
  job.scene.lights = {key_light()};
  job.scene.background = {0.3, 0.3, 0.3};
  job.warnings = std::move(model.warnings);
  job.wavelengths = {532_nm};
  job.slm = slm_preset("pluto");
  job.trace.columns = 1024, job.trace.rows = 768;  // waves 13 × 17 µm apart, about the panel's resolution there
  job.trace.paths = 16;
  double front = -model_depth;
  for (const Mesh& mesh : job.scene.meshes)
    for (const Vec3 p : mesh.positions) front = std::max(front, p.z);
  job.camera.distances = {model_depth};
  if (front + model_depth > 0.2_mm) job.camera.distances = {-front, model_depth};  // more than the depth of focus there
  job.render.focus = model_depth;
  job.render.paths = 32;
  job.encode.method = Encoding::sgd;
  job.encode.target = EncodeTarget::render;
  job.encode.quality = Quality::draft;
  check_scene(job.scene);
  return job;
}

}  // namespace holotrace
