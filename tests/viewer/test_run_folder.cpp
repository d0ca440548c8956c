// The folder of a run in the viewer: the quality of its views, and where its things are.

#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "holotrace/io/run/save_run.h"
#include "holotrace/io/scene/scene_file.h"
#include "holotrace/run/pipeline.h"
#include "holotrace/viewer/session.h"
#include "support/temporary.h"

namespace holotrace::test {
namespace {

using Json = nlohmann::json;

// A near and a far square, left and right, lit from the front.
constexpr const char* scene = R"(wavelength = "532 nm"
[slm]
columns = 160
rows = 90
pitch = "8 um"
[trace]
columns = 48
rows = 27
field_of_view = "1.1 deg"
paths = 2
[render]
columns = 80
rows = 45
paths = 8
reference = "full"
[camera]
distances = "20 mm, 30 mm"
[[light]]
type = "rectangle"
corner = "-5 -5 5 mm"
edge_u = "0 10 0 mm"
edge_v = "10 0 0 mm"
radiance = 5
[[object]]
type = "quad"
width = "0.35 mm"
height = "0.45 mm"
position = "-0.25 0 -20 mm"
[[object]]
type = "quad"
width = "0.35 mm"
height = "0.45 mm"
position = "0.25 0 -30 mm"
)";

constexpr const char* aims_at_render = "[encode]\nmethod = \"sgd\"\ntarget = \"render\"\niterations = 5\n";

RunResults run_into(const std::string& folder, const std::string& more) {
  const Job job = load_job(make_file("scene.toml", scene + more));
  RunResults results = run(job);
  std::filesystem::create_directories(folder);
  save_run(folder, results, job, {}, {});
  return results;
}

// A run that aims at the scene's light is compared in the report with a render of its own; the folder has the target.
// The report rounds nothing, and render.exr holds the floats that the run compared: only the scale of the render, which
// does not count, differs. PNG clips light brighter than white: these figures would be wrong by 0.01 to 8 dB.
TEST(FolderOfARun, ItsViewsHaveTheQualityOfTheReport) {
  for (const char* more : {"", aims_at_render}) {
    const std::string folder = temporary("out");
    const RunResults results = run_into(folder, more);
    Session session({folder});
    int views = 0;
    for (const StageReport& stage : results.report.stages) {
      if (!stage.stage.starts_with("look at ")) continue;
      const std::string distance = stage.stage.substr(std::string("look at ").size());
      const Json metrics = Json::parse(session.metrics(session.state_of({{"distance", distance}})));
      const bool has_target = std::string(more).find("render") != std::string::npos;
      for (const auto& [name, fact] : stage.facts) {
        const bool is_of_folder = has_target ? name == "psnr_of_target_db"
                                             : name == "psnr_db" || name == "ssim" || name == "speckle_contrast";
        if (is_of_folder) {
          EXPECT_NEAR(metrics.at(has_target ? "psnr_db" : name).get<double>(), std::get<double>(fact), 1e-6)
              << stage.stage << more << name;
        }
      }
      ++views;
    }
    EXPECT_EQ(views, 2);
    // A folder of an earlier version has only the PNG.
    for (const char* name : {"/render.exr", "/render_2.exr"}) std::filesystem::remove(folder + name);
    Session earlier({folder});
    EXPECT_TRUE(Json::parse(earlier.metrics(earlier.state_of({}))).contains("psnr_db"));
  }
}

// Also a hologram by itself, which has no report: it knows how its run looked.
TEST(FolderOfARun, IsSeenAsItsRunSawIt) {
  std::string text = scene;
  text.replace(text.find("\"20 mm, 30 mm\""), 14, "\"30 mm, 20 mm\"\npupil = \"0.5 mm\"\neye = \"0.1 0 15 mm\"");
  const Job job = load_job(make_file("scene.toml", text));
  const std::string folder = temporary("out");
  std::filesystem::create_directories(folder);
  const RunResults results = run(job);
  save_run(folder, results, job, {}, {});
  for (const std::string& path : {folder, folder + "/hologram.png"}) {
    Session session({path});
    const ViewState state = session.state_of({});
    EXPECT_EQ(state.camera.distances, std::vector<double>{0.03}) << path;
    EXPECT_EQ(state.camera.pupil, 0.5e-3);
    EXPECT_EQ(state.camera.eye, (Vec3{0.1e-3, 0, 0.015}));
    EXPECT_EQ(session.view(state)->image.values, results.views.front().values);
    const Json defaults = Json::parse(session.describe()).at("defaults");
    EXPECT_EQ(defaults.at("distance_m"), 0.03);
    EXPECT_EQ(defaults.at("pupil_m"), 0.5e-3);
    EXPECT_EQ(defaults.at("eye_m"), (std::vector<double>{0.1e-3, 0, 0.015}));
    // The command line says the eye, too: holotrace show would take it from the first of the shown holograms.
    const std::string line = session.command_line({{"distance", "25 mm"}});
    for (const char* words : {"--distance '25 mm'", "--pupil '0.0005 m'", "--eye '0.0001 0 0.015 m'"})
      EXPECT_NE(line.find(words), std::string::npos) << line;
    EXPECT_EQ(session.state_of({{"pupil", "0 mm"}}).camera.pupil, 0);
  }
}

// A red square on the left and a green one on the right: the hologram of each laser is compared with the render in its
// own colour. A render of both in grey, or of the other laser, has light on the other side, too.
TEST(FolderOfARun, AColourIsComparedWithItsRender) {
  std::string text = scene;
  const auto replace = [&](const std::string& from, const std::string& to) {
    text.replace(text.find(from), from.size(), to);
  };
  replace("wavelength = \"532 nm\"", "wavelength = [\"638 nm\", \"532 nm\"]");
  replace("position = \"-0.25", "material = \"red\"\nposition = \"-0.25");
  replace("position = \"0.25", "material = \"green\"\nposition = \"0.25");
  text += "[materials.red]\nreflectance = [0.8, 0, 0]\n[materials.green]\nreflectance = [0, 0.8, 0]\n";
  const Job job = load_job(make_file("scene.toml", text));
  const std::string folder = temporary("out");
  std::filesystem::create_directories(folder);
  RunResults results = run(job);
  save_run(folder, results, job, {}, {});
  Session session({folder});
  for (const char* item : {"0", "1"}) {
    const auto render = session.reference(session.state_of({{"items", item}, {"distance", "20 mm"}}), {});
    ASSERT_TRUE(render);
    const Image& image = render->image;
    ASSERT_EQ(image.channels, 1);
    double left = 0, right = 0;
    for (int j = 0; j < image.ny; ++j)
      for (int i = 0; i < image.nx; ++i) (2 * i < image.nx ? left : right) += image(j, i);
    const double wanted = item == std::string("0") ? left : right, other = item == std::string("0") ? right : left;
    // Pure red has a little of its light at 532 nm and the other way round, through the broad curves of sRGB's primaries.
    EXPECT_GT(wanted, 5 * other) << item;
  }
}

// A run that aims at the render makes no waves. Its points lie on the squares, whose depths are 20 and 30 mm.
TEST(FolderOfARun, HasThePlacesOfTheSceneWithoutWaves) {
  const std::string folder = temporary("out");
  run_into(folder, aims_at_render);
  const std::vector<float> points = Session({folder}).points();
  int near = 0, far = 0;
  for (size_t i = 0; i + 3 < points.size(); i += 4) {
    const bool is_near = points[i] < 0;  // x
    EXPECT_NEAR(points[i + 2], is_near ? -0.02 : -0.03, 1e-6);
    EXPECT_LE(std::abs(std::abs(points[i]) - 0.25e-3), 0.175e-3 + 1e-9);
    EXPECT_LE(std::abs(points[i + 1]), 0.225e-3 + 1e-9);
    ++(is_near ? near : far);
  }
  // The raster of 256 × 256 rays has the tangents of the panel's half width, 0.64 mm at 20 mm: a square of 0.35 × 0.45 mm
  // there gets 256²·0.35·0.45/1.28² = 6300 rays, the far one 4/9 of them. Cells of one phase share a wave.
  EXPECT_GT(near, 1000);
  EXPECT_GT(far, 500);
}

}  // namespace
}  // namespace holotrace::test
