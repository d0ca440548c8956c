// A file of meshes in place of a scene, by the command line.

#include <gtest/gtest.h>

#include "end_to_end/scenes.h"
#include "holotrace/io/field/field_file.h"
#include "holotrace/io/picture/image_file.h"
#include "support/fields.h"
#include "support/gltf.h"
#include "support/program.h"

namespace holotrace::test {
namespace {

// A square that faces the panel, of the grey 0.8 of meshes without a material, before black. It is lit by even light of
// radiance 0.15 from all around, the key lamp, which gives white that faces it 0.85, in the direction (-0.40, 0.55, 0.73)
// of length 0.998, and the fill lamp, which gives 0.2 in the direction (0.80, 0.20, 0.56) of length 1.0.
TEST(Models, AModelAloneIsLitFromAllAroundAndByItsLamps) {
  const Workplace work;
  work.write("m.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n");
  const Outcome outcome = work.run({"render", "m.obj", "-o", "m.exr", "--rows", "32", "--columns", "32", "--floor",
                                    "none", "--rotation", "x -18 deg"});  // as much as it is seen from above
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const Image image = load_image(work.path("m.exr"));
  EXPECT_EQ(image(0, 0), 0);
  double sum = 0;
  for (int row = 12; row < 20; ++row)
    for (int column = 12; column < 20; ++column) sum += image(row, column) / 64;
  // A place of a lamp at ρ from its middle gives (1 + ρ²/d²)⁻² of the light, in the mean over a square of side s about
  // 1 − s²/3d²: s/d is 0.4 and 0.7. Terms of the fourth order are below 2 %.
  const double lamps = 0.8 * (0.85 * 0.73 / 0.998 * (1 - 0.16 / 3) + 0.2 * 0.56 * (1 - 0.49 / 3));
  EXPECT_NEAR(sum, 0.8 * 0.15 + lamps, 0.02 * lamps);
}

TEST(Models, FlagsOfModelsAreRefusedForScenes) {
  const Workplace work;
  work.write("scene.toml", mesh_scene());
  const Outcome outcome = work.run({"run", "scene.toml", "-o", "out", "--up", "z"});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_NE(outcome.err.find("expected --up with a model, got the scene scene.toml"), std::string::npos) << outcome.err;
}

// The square stands at 5 mm, 19.5 panel widths of 0.256 mm; its depth of focus there is 2·532 nm·(5/0.256)² = 0.4 mm.
TEST(Models, AFocusBesideTheModelIsAWarning) {
  const Workplace work;
  work.write("m.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n");
  work.write("p.toml", "columns = 32\nrows = 24\npitch = \"8 um\"\n");
  const auto warnings = [&](const std::string& flag, const std::string& distance) {
    const Outcome outcome = work.run({"run", "m.obj", "--slm", "p.toml", "--iterations", "2", "--paths", "1", "--floor",
                                      "none", flag, distance, "-o", "out"});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return outcome.err;
  };
  EXPECT_NE(warnings("--distance", "9 mm").find("the camera focuses at 9 mm, and the scene is "), std::string::npos);
  EXPECT_EQ(warnings("--distance", "5.2 mm").find("the camera focuses at"), std::string::npos);
  EXPECT_EQ(warnings("--model-distance", "9 mm").find("the camera focuses at"), std::string::npos);
}

TEST(Models, WavelengthsThatAreGivenAreNotSaidToBeChosen) {
  const Workplace work;
  work.write("m.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n");
  work.write("p.toml", "columns = 64\nrows = 48\npitch = \"8 um\"\n");
  const auto chosen = [&](std::vector<std::string> flags) {
    std::vector<std::string> command{"run", "m.obj",   "--slm", "p.toml", "--iterations",
                                     "2",   "--paths", "1",     "-o",     "out"};
    command.insert(command.end(), flags.begin(), flags.end());
    const Outcome outcome = work.run(command);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return work.read("out/report.json").find("\"parameter\": \"wavelength\"") != std::string::npos;
  };
  EXPECT_TRUE(chosen({}));
  EXPECT_FALSE(chosen({"--wavelength", "600 nm"}));
}

// The field of a model is that of the waves that `trace` finds with the same panel, which the model is placed before.
TEST(Models, AFieldOfAModelIsThatBeforeTheGivenPanel) {
  const Workplace work;
  work.write("m.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n");
  work.write("p.toml", "columns = 50\nrows = 40\npitch = \"8 um\"\n");
  ASSERT_EQ(work.run({"trace", "m.obj", "--slm", "p.toml", "-o", "w.ply"}).exit_code, 0);
  ASSERT_EQ(work.run({"field", "w.ply", "--slm", "p.toml", "-o", "of_waves.npy"}).exit_code, 0);
  ASSERT_EQ(work.run({"field", "m.obj", "--slm", "p.toml", "-o", "of_model.npy"}).exit_code, 0);
  const Field expected = load_field(work.path("of_waves.npy")), found = load_field(work.path("of_model.npy"));
  ASSERT_EQ(found.grid.nx, 50);
  EXPECT_GT(power(expected), 0);
  EXPECT_LT(relative_error(found, expected), 1e-5);  // PLY files keep places in double, amplitudes in float
}

TEST(Models, FilesBesideAModelAreFoundFromAnywhere) {
  const Workplace work;
  std::filesystem::create_directory(work.path("models"));
  work.write("models/m.mtl", "newmtl black\nKd 0 0 0\n");
  work.write("models/m.obj", "mtllib m.mtl\nusemtl black\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n");
  ASSERT_EQ(work.run({"render", "models/m.obj", "-o", "m.exr", "--rows", "16", "--columns", "16", "--floor", "none"})
                .exit_code,
            0);
  EXPECT_EQ(load_image(work.path("m.exr"))(8, 8), 0);
}

// Every command that reads a model, by a small scene of it.
std::vector<std::vector<std::string>> commands_with_model(const Workplace& work, const std::string& model) {
  work.write("scene.toml", mesh_scene() + "[[object]]\ntype = \"mesh\"\nfile = \"" + model +
                               "\"\nscale = 1e-3\nposition = \"0 0 -30 mm\"\n");
  return {{"info", model},
          {"info", "scene.toml"},
          {"run", "scene.toml", "-o", "out"},
          {"render", "scene.toml", "-o", "x.png"},
          {"trace", "scene.toml", "-o", "x.ply"},
          {"field", "scene.toml", "-o", "x.npy"},
          {"estimate", "scene.toml"}};
}

TEST(Models, EveryCommandWarnsOfWhatAModelLacks) {
  const Workplace work;
  const std::string square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";
  work.write("m.mtl", "newmtl a\nKd 1 1 1\nmap_Kd none.png\n");
  work.write("m.obj", "mtllib m.mtl\nusemtl a\n" + square + "vt 0 0\nf 1/1 2/1 3/1 4/1\nl 1 2\n");
  for (const auto& command : commands_with_model(work, "m.obj")) {
    const Outcome outcome = work.run(command);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    const std::string said = outcome.err + outcome.out;
    EXPECT_NE(said.find("the texture none.png is missing"), std::string::npos) << command[0] << ": " << said;
    EXPECT_NE(said.find("1 points and lines are ignored"), std::string::npos) << command[0] << ": " << said;
  }
  // A PLY file of a mesh is described as one, also if it is loose triangles.
  work.write("m.ply",
             "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
             "property float nx\nproperty float ny\nproperty float nz\nelement face 1\n"
             "property list uchar int vertex_indices\nend_header\n0 0 0 0 0 0\n1 0 0 0 0 0\n0 1 0 0 0 0\n3 0 1 2\n");
  for (const auto& command : commands_with_model(work, "m.ply")) {
    const Outcome outcome = work.run(command);
    EXPECT_NE((outcome.err + outcome.out).find("normals of length 0; it is shaded flat"), std::string::npos)
        << command[0] << ": " << outcome.err << outcome.out;
  }
}

TEST(Models, EveryCommandRefusesIndicesBeyondTheVertices) {
  const Workplace work;
  GltfTriangle gltf;
  gltf.primitives = R"([{"attributes": {"POSITION": 0}, "indices": 4}])";
  std::string text = gltf.text();
  const std::string positions = R"("bufferView": 0, "componentType": 5126, "count": 3)";
  text.replace(text.find(positions), positions.size(), R"("bufferView": 0, "componentType": 5126, "count": 2)");
  work.write("m.gltf", text);
  work.write("m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 2 4\n");
  work.write("m.ply",
             "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
             "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n");
  const std::vector<std::pair<std::string, std::string>> cases{
      {"m.gltf", "m.gltf: expected vertex indices below 2 in mesh \"triangle\", got 2; export it again"},
      {"m.obj", "m.obj:5: expected vertex indices from 1 to 3 or as far back, got 4; export the mesh again"},
      {"m.ply", "m.ply: expected vertex indices below 3, got 3 in face 0"}};
  for (const auto& [model, sentence] : cases)
    for (const auto& command : commands_with_model(work, model)) {
      const Outcome outcome = work.run(command);
      EXPECT_EQ(outcome.exit_code, 1) << command[0] << " " << model;
      EXPECT_NE(outcome.err.find(sentence), std::string::npos) << command[0] << ": " << outcome.err;
    }
}

}  // namespace
}  // namespace holotrace::test
