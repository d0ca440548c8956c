// Scenes as luminous triangles, from the mesh to the light at its depth, and by the command line.

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "end_to_end/scenes.h"
#include "holotrace/run/pipeline.h"
#include "holotrace/wave/propagate/propagate.h"
#include "support/program.h"

namespace holotrace::test {
namespace {

// Two squares of 0.4 mm, side by side at 30 mm, of radiance 1 and 4.
Job two_squares(Shading shading, TrianglePhase phase) {
  Job job;
  job.wavelengths = {test_wavelength};
  job.slm.grid = small_panel;
  job.trace = {.paths = 1, .max_depth = 1};
  job.synthesize.method = SynthesisMethod::triangles;
  job.synthesize.shading = shading;
  job.synthesize.triangle_phase = phase;
  job.synthesize.tolerance = 1e-2;
  for (const int side : {-1, 1}) {
    Mesh mesh;
    const double x = side * 0.25e-3, a = 0.2e-3, z = -30e-3;
    mesh.positions = {{x - a, -a, z}, {x + a, -a, z}, {x + a, a, z}, {x - a, a, z}};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    mesh.material = int(job.scene.materials.size());
    job.scene.meshes.push_back(mesh);
    const double radiance = side < 0 ? 1 : 4;
    job.scene.materials.push_back({DiffuseMaterial{}, Vec3{1, 1, 1} * radiance});
  }
  return job;
}

// Mean |U|² over the middle of a square in the image at its depth, half its width away from all edges.
double brightness(const Field& image, double x) {
  double sum = 0;
  int count = 0;
  for (int j = 0; j < image.grid.ny; ++j)
    for (int i = 0; i < image.grid.nx; ++i)
      if (std::abs(image.grid.x(i) - x) < 0.1e-3 && std::abs(image.grid.y(j)) < 0.1e-3) {
        sum += std::norm(image.samples(j, i));
        ++count;
      }
  return sum / count;
}

// The panel's wave, propagated back to the squares, shows them with |U|² = L·Ω, Ω the solid angle of the panel's part
// in their box: in x from R = 0.998 mm on the inner side to the panel's edge on the outer one, in y the whole panel.
// With constant phases the middle of a square is uniform except for ripples from the edges, 5 %. With random phases a
// third of the light goes beyond the band, because the triangles are only 31 µm (four pixels) wide. Both squares lose
// the same to 20 %: 100 triangles in each middle average phases to 1/√100; the tolerance is twice that.
TEST(TriangleScenes, ShowRadianceAtItsDepth) {
  const double angle = (0.998e-3 + 1.024e-3 - 0.25e-3) * 1.536e-3 / (30e-3 * 30e-3);
  for (const Shading shading : {Shading::flat, Shading::smooth})
    for (const TrianglePhase phase : {TrianglePhase::constant, TrianglePhase::random}) {
      const Job job = two_squares(shading, phase);
      const Field field = fields_of_frame(trace_light(job), 0, job.slm.grid, job.synthesize).front();
      const Field image = propagate(field, -30e-3);
      const double dim = brightness(image, -0.25e-3) / angle, bright = brightness(image, 0.25e-3) / angle;
      if (phase == TrianglePhase::constant) {
        EXPECT_NEAR(dim, 1, 0.05);
        EXPECT_NEAR(bright, 4, 0.2);
      } else {
        EXPECT_GT(dim, 0.5);
        EXPECT_LT(dim, 1);
        EXPECT_NEAR(bright / dim, 4, 0.8);
      }
    }
}

TEST(TriangleScenes, OtherFramesHaveOtherPhasesAndTheSameLight) {
  const Job job = two_squares(Shading::flat, TrianglePhase::random);
  const SceneLight light = trace_light(job);
  const Field first = fields_of_frame(light, 0, job.slm.grid, job.synthesize).front();
  const Field second = fields_of_frame(light, 1, job.slm.grid, job.synthesize).front();
  EXPECT_NE(first.samples.values, second.samples.values);
  EXPECT_NEAR(power(second) / power(first), 1, 0.05);
  EXPECT_EQ(second.label.frame, 1U);
}

TEST(TriangleScenes, RunByTheCommandLine) {
  const Workplace work;
  work.write("scene.toml", mesh_scene() + "[synthesize]\nmethod = \"triangles\"\ntolerance = 1e-2\n");
  const Outcome outcome = work.run({"run", "scene.toml", "-o", "out", "--shading", "flat"});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_NE(outcome.err.find("luminous points are left out"), std::string::npos) << outcome.err;
  EXPECT_FALSE(work.has("out/sources.ply"));
  EXPECT_TRUE(work.has("out/view.png"));
  const auto report = nlohmann::json::parse(work.read("out/report.json"));
  for (const auto& stage : report["stages"]) {
    if (stage["stage"] == "trace") {
      EXPECT_GT(stage["shining"], 100);
    }
    if (stage["stage"] == "synthesize") {
      EXPECT_EQ(stage["method"], "triangles");
      EXPECT_LE(stage["expected_error"], 1e-2);
      EXPECT_GT(stage["parts"], 100);
    }
  }
}

TEST(TriangleScenes, FieldTakesTheMethodAndAMesh) {
  const Workplace work;
  work.write("scene.toml", mesh_scene());
  const Outcome outcome = work.run({"field", "scene.toml", "-o", "f.npy", "--method", "triangles", "--shading",
                                    "smooth", "--triangle-phase", "constant", "--tolerance", "1e-2"});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_TRUE(work.has("f.npy"));
}

TEST(TriangleScenes, WavesAreRefused) {
  const Workplace work;
  work.write("scene.toml", mesh_scene());
  EXPECT_EQ(work.run({"trace", "scene.toml", "-o", "s.ply"}).exit_code, 0);
  const Outcome outcome = work.run({"field", "s.ply", "-o", "f.npy", "--method", "triangles"});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_NE(outcome.err.find("expected a scene or a mesh for --method triangles"), std::string::npos) << outcome.err;
  EXPECT_FALSE(work.has("f.npy"));
}

}  // namespace
}  // namespace holotrace::test
