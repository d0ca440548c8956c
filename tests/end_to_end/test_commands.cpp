// Every subcommand of section 4 of the design with its flags, run by its command line.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "end_to_end/scenes.h"
#include "end_to_end/succeed.h"
#include "holotrace/base/units.h"
#include "holotrace/io/field/field_file.h"
#include "holotrace/io/field/hologram_file.h"
#include "holotrace/io/field/sources_file.h"
#include "holotrace/io/picture/image_file.h"
#include "holotrace/wave/propagate/propagate.h"
#include "support/png.h"
#include "support/program.h"

namespace holotrace::test {
namespace {

using namespace literals;

TEST(Commands, RunWritesEveryBoxOfThePipeline) {
  const Workplace work;
  work.write("scene.toml", mesh_scene());
  const std::string summary = succeed(work, {"run", "scene.toml", "-o", "out"});
  for (const char* words :
       {"trace", " waves", "look at 30 mm", "view.png at 30 mm: PSNR ",
        " dB against the render (a black view: ", " of the view are lit; ", "all stages",
        "written to out: field.npy, field.npy.json, hologram.png, render.exr, render.png, report.json, "
        "sources.ply, view.png\n"})
    EXPECT_NE(summary.find(words), std::string::npos) << words << " is not in:\n" << summary;
  const std::set<std::string> expected{"scene.toml",         "out",
                                       "out/render.png",     "out/render.exr",
                                       "out/sources.ply",    "out/field.npy",
                                       "out/field.npy.json", "out/hologram.png",
                                       "out/view.png",       "out/report.json"};
  EXPECT_EQ(work.names(), expected);
  EXPECT_EQ(load_image(work.path("out/render.png")).ny, 64);                     // [render] rows of the scene
  EXPECT_GT(load_sources(work.path("out/sources.ply"), 0).waves.size(), 1000U);  // 48×48 first hits, almost all lit
  EXPECT_EQ(load_field(work.path("out/field.npy")).grid, small_panel);
  EXPECT_EQ(load_hologram(work.path("out/hologram.png")).levels, 256);  // 8 bit
  EXPECT_EQ(load_image(work.path("out/view.png")).nx, small_panel.nx);  // a sensor as large as the panel
}

TEST(Commands, TheReportTellsTimeCountsMethodMetricsVersionsAndSeed) {
  const Workplace work;
  work.write("scene.toml", mesh_scene());
  succeed(work, {"run", "scene.toml", "-o", "out"});
  const auto report = nlohmann::json::parse(work.read("out/report.json"));
  EXPECT_EQ(report.at("seed"), 1);
  EXPECT_TRUE(report.at("versions").contains("holotrace"));
  EXPECT_GT(report.at("seconds").get<double>(), 0);
  std::map<std::string, nlohmann::json> stages;
  for (const auto& stage : report.at("stages")) {
    EXPECT_GE(stage.at("seconds").get<double>(), 0);
    EXPECT_TRUE(stage.at("warnings").is_array());
    stages[stage.at("stage")] = stage;
  }
  EXPECT_GT(stages.at("trace").at("paths"), 0);
  EXPECT_GT(stages.at("trace").at("rays"), 0);
  EXPECT_GT(stages.at("synthesize").at("waves"), 0);
  EXPECT_GT(stages.at("synthesize").at("waves_pixels"), 0);
  EXPECT_TRUE(stages.at("synthesize").contains("method"));
  EXPECT_TRUE(stages.at("synthesize").contains("why"));
  EXPECT_TRUE(stages.at("look at 30 mm").contains("psnr_db"));
}

TEST(Commands, TheStagesOneByOneMakeTheSameFilesAsRun) {
  const Workplace work;
  work.write("scene.toml", mesh_scene());
  // run exposes its render like its view (CommonExposure), so the exposure is given, and the render is another test's.
  succeed(work, {"run", "scene.toml", "-o", "out", "--exposure", "20"});
  succeed(work, {"trace", "scene.toml", "-o", "sources.ply"});
  succeed(work, {"field", "scene.toml", "-o", "field.npy"});
  succeed(work, {"encode", "field.npy", "-o", "hologram.png", "--slm", "scene.toml"});
  succeed(work, {"show", "hologram.png", "-o", "view.png", "--distance", "30 mm", "--exposure", "20"});
  for (const char* name : {"sources.ply", "field.npy", "field.npy.json", "view.png"})
    EXPECT_TRUE(work.read(name) == work.read(std::string("out/") + name)) << name;
  // A field does not know where a camera will focus; the hologram of a run does.
  Hologram hologram = load_hologram(work.path("out/hologram.png"));
  EXPECT_EQ(hologram.viewing.distances, std::vector<double>{0.03});
  hologram.viewing = {};
  save_hologram(work.path("unknown.png"), hologram);
  EXPECT_TRUE(work.read("hologram.png") == work.read("unknown.png"));
}

// A render of a run is that of `render`, with another white: the ratio of their light is the same everywhere.
TEST(Commands, RenderAloneMakesTheRenderOfARun) {
  const Workplace work;
  work.write("scene.toml", mesh_scene());
  succeed(work, {"run", "scene.toml", "-o", "out", "--reference", "full"});
  succeed(work, {"render", "scene.toml", "-o", "render.png", "--background", "false",  // it sends no waves
                 "--denoise", "none"});                                                // as the references of a run
  const Image alone = load_image(work.path("render.png")), of_run = load_image(work.path("out/render.png"));
  ASSERT_EQ(alone.values.size(), of_run.values.size());
  double alone_sum = 0, run_sum = 0;
  for (const float v : alone.values) alone_sum += v;
  for (const float v : of_run.values) run_sum += v;
  // Half a step of 8 bits is at most 0.5/255·2.4/1.055·(v + 0.055) of linear light v, below 0.0047 at white.
  for (size_t i = 0; i < alone.values.size(); ++i)
    if (alone.values[i] < 1) {
      ASSERT_NEAR(of_run.values[i], alone.values[i] * run_sum / alone_sum, 2 * 0.0047) << i;
    }
}

TEST(Commands, RunMakesTheReferenceThatIsAskedFor) {
  const Workplace work;
  work.write("scene.toml", mesh_scene());
  const auto stages_with = [&](const std::string& reference) {
    succeed(work, {"run", "scene.toml", "-o", reference, "--reference", reference});
    return nlohmann::json::parse(work.read(reference + "/report.json"))["stages"];
  };
  const auto none = stages_with("none"), quick = stages_with("quick"), full = stages_with("full");
  EXPECT_FALSE(work.has("none/render.png"));
  EXPECT_EQ(none.front()["stage"], "trace");
  EXPECT_EQ(none.back()["why_no_metrics"], "the job asks for no reference");
  EXPECT_FALSE(none.back().contains("psnr_db"));
  EXPECT_EQ(quick.front()["stage"], "render");
  EXPECT_EQ(quick.front()["paths_per_pixel"], 2);  // of 4: two halves of one path each
  EXPECT_TRUE(quick.back().contains("speckle_contrast"));
  EXPECT_NEAR(quick.back()["ssim"].get<double>(), full.back()["ssim"].get<double>(), 0.02);  // 2 and 4 paths a pixel
  EXPECT_NEAR(quick.back()["psnr_db"].get<double>(), full.back()["psnr_db"].get<double>(),
              quick.back()["psnr_uncertainty_db"].get<double>() + 0.1);
  EXPECT_TRUE(full.back().contains("ssim"));
  for (const char* name : {"/hologram.png", "/field.npy", "/sources.ply"})
    EXPECT_TRUE(work.read(std::string("none") + name) == work.read(std::string("full") + name)) << name;
  // `render` has no such flag, and an estimate counts no render.
  EXPECT_EQ(work.run({"render", "scene.toml", "-o", "r.png", "--reference", "none"}).exit_code, 2);
  work.write("none.toml", "extends = \"scene.toml\"\n[render]\nreference = \"none\"\n");
  const auto estimate = nlohmann::json::parse(succeed(work, {"estimate", "none.toml", "--json"}));
  EXPECT_EQ(estimate.dump().find("\"render\""), std::string::npos) << estimate;
}

TEST(Commands, RunLooksAtSeveralDistancesInOneExposure) {
  const Workplace work;
  work.write("points.ply", point_file({{{0, 0, -0.02}}, {{0.0002, 0, -0.04}}}));
  work.write("scene.toml", scene_head() + points_object());
  expect_success(work,
                 {"run", "scene.toml", "-o", "out", "--distance", "20 mm, 40 mm"});  // two points warn: nearly black
  EXPECT_TRUE(work.has("out/view.png"));
  EXPECT_TRUE(work.has("out/view_2.png"));
  EXPECT_FALSE(work.read("out/view.png") == work.read("out/view_2.png"));
  expect_success(work, {"run", "scene.toml", "-o", "out", "--distance", "20 mm"});
  EXPECT_FALSE(work.has("out/view_2.png"));  // left by the earlier run
}

TEST(Commands, FieldTakesSourcesAndAPanelByName) {
  const Workplace work;
  work.write("points.ply", point_file({{{0, 0, -0.2}}, {{0.001, 0.002, -0.25}, 0.5}}));
  work.write("scene.toml", "wavelength = \"632.8 nm\"\n" + points_object());  // on the default panel, pluto
  succeed(work, {"trace", "scene.toml", "-o", "sources.ply"});
  succeed(work, {"field", "scene.toml", "-o", "from_scene.npy"});
  succeed(work, {"field", "sources.ply", "-o", "from_sources.npy", "--slm", "pluto", "--wavelength", "632.8 nm",
                 "--method", "auto", "--tolerance", "1e-3"});
  EXPECT_TRUE(work.read("from_scene.npy") == work.read("from_sources.npy"));
  EXPECT_TRUE(work.read("from_scene.npy.json") == work.read("from_sources.npy.json"));
}

TEST(Commands, FieldKeepsItsToleranceAgainstTheExactMethod) {
  const Workplace work;
  std::string scene = mesh_scene();
  scene.replace(scene.find("columns = 48"), 12, "columns = 6");  // exact is slow: an eighth of the waves suffices
  work.write("scene.toml", scene);
  succeed(work, {"field", "scene.toml", "-o", "exact.npy", "--method", "exact"});
  succeed(work, {"field", "scene.toml", "-o", "double.npy", "--double"});
  succeed(work, {"field", "scene.toml", "-o", "tiled.npy", "--method", "tiled", "--tolerance", "2e-3"});
  const auto error = [&](const char* name) {
    const auto json = nlohmann::json::parse(succeed(work, {"compare", "double.npy", name, "--json"}));
    return json.at("relative_l2_error").get<double>();
  };
  EXPECT_LT(error("tiled.npy"), 2e-3);  // the requested tolerance
  EXPECT_LT(error("exact.npy"), 6e-8);  // complex64 keeps 24 bits: 2⁻²⁴ relative
}

TEST(Commands, FieldsTravelThroughEveryFormat) {
  const Workplace work;
  work.write("scene.toml", mesh_scene());
  for (const char* name : {"f.npy", "f.h5", "f.exr"}) succeed(work, {"field", "scene.toml", "-o", name});
  for (const char* name : {"f.npy", "f.h5", "f.exr"}) succeed(work, {"encode", name, "-o", std::string(name) + ".png"});
  EXPECT_TRUE(work.read("f.npy.png") == work.read("f.h5.png"));
  EXPECT_TRUE(work.read("f.npy.png") == work.read("f.exr.png"));
}

TEST(Commands, EncodeTakesEveryMethod) {
  const Workplace work;
  work.write("scene.toml", mesh_scene());
  succeed(work, {"field", "scene.toml", "-o", "f.npy"});
  for (const std::string method : {"phase", "amplitude", "off-axis"}) {
    const Outcome outcome = work.run({"encode", "f.npy", "-o", method + ".png", "--method", method});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_EQ(nlohmann::json::parse(png_text(work.path(method + ".png"), "holotrace")).at("encoder"), method);
  }
}

TEST(Commands, ShowTakesAPanelByNameAndAHologramWithoutItsMetadata) {
  const Workplace work;
  work.write("points.ply", point_file({{{0, 0, -0.3}}}));
  work.write("scene.toml", "wavelength = \"632.8 nm\"\n" + points_object());
  succeed(work, {"field", "scene.toml", "-o", "f.npy"});
  succeed(work, {"encode", "f.npy", "-o", "h.png"});
  succeed(work, {"show", "h.png", "-o", "with.png", "--slm", "pluto", "--distance", "300 mm"});
  drop_metadata(work.path("h.png"));  // a bare PNG, as from another program
  succeed(work,
          {"show", "h.png", "-o", "without.png", "--slm", "pluto", "--distance", "300 mm", "--wavelength", "632.8 nm"});
  EXPECT_TRUE(work.read("with.png") == work.read("without.png"));
}

TEST(Commands, PropagateThereAndBackIsTheField) {
  const Workplace work;
  work.write("points.ply", point_file({{{0, 0, -0.03}}}));
  work.write("scene.toml", scene_head() + points_object());
  succeed(work, {"field", "scene.toml", "-o", "f.npy"});
  // A periodic window keeps all light: forward and back is the identity.
  succeed(work, {"propagate", "f.npy", "--distance", "10 mm", "-o", "g.npy", "--periodic", "true"});
  succeed(work, {"propagate", "g.npy", "--distance", "-10 mm", "-o", "back.npy", "--periodic", "true"});
  EXPECT_NEAR(load_field(work.path("g.npy")).z, 0.01, 1e-15);
  EXPECT_NEAR(load_field(work.path("back.npy")).z, 0, 1e-15);
  const auto json = nlohmann::json::parse(succeed(work, {"compare", "f.npy", "back.npy", "--json"}));
  EXPECT_LT(json.at("relative_l2_error").get<double>(), 1e-6);  // the design's bound for single precision
}

// The requested window contains the sum over the samples of the file at its own positions.
TEST(Commands, PropagateGoesToAWindowOfAnyPitchAndPlace) {
  const Workplace work;
  work.write("scene.toml", mesh_scene());
  succeed(work, {"field", "scene.toml", "-o", "f.npy", "--double"});
  succeed(work, {"propagate", "f.npy", "--distance", "150 mm", "-o", "g.npy", "--double", "--pitch", "21 um",
                 "--columns", "33", "--rows", "20", "--centre-x", "-0.4 mm", "--centre-y", "0.1 mm"});
  const FieldDouble from = load_field_double(work.path("f.npy")), to = load_field_double(work.path("g.npy"));
  EXPECT_EQ(to.grid, (Grid{33, 20, 21_um, -0.4_mm, 0.1_mm}));
  const auto expected =
      sum_rayleigh_sommerfeld(from, {{to.grid.x(0), to.grid.y(0), 0.15}, {to.grid.x(20), to.grid.y(11), 0.15}});
  const double most = std::max(std::abs(expected[0]), std::abs(expected[1]));
  EXPECT_LT(std::abs(to.samples(0, 0) - expected[0]), 1e-9 * most);
  EXPECT_LT(std::abs(to.samples(11, 20) - expected[1]), 1e-9 * most);
}

TEST(Commands, ShowHasASensorOfItsOwn) {
  const Workplace work;
  work.write("scene.toml", mesh_scene());
  succeed(work, {"field", "scene.toml", "-o", "f.npy"});
  succeed(work, {"encode", "f.npy", "-o", "h.png"});
  succeed(work, {"show", "h.png", "-o", "v.exr", "--distance", "30 mm", "--pixel", "11 um", "--width", "0.66 mm",
                 "--height", "0.33 mm", "--centre-x", "-50 um"});
  const Image view = load_image(work.path("v.exr"));
  EXPECT_EQ(view.nx, 60);
  EXPECT_EQ(view.ny, 30);
  EXPECT_GT(*std::max_element(view.values.begin(), view.values.end()), 0);
  EXPECT_NE(work.run({"show", "h.png", "-o", "v.exr", "--pixel", "1 m"}).err.find("at least one pixel of 1 m wide"),
            std::string::npos);
}

TEST(Commands, PropagateInDoubleKeepsComplex128) {
  const Workplace work;
  work.write("scene.toml", mesh_scene());
  succeed(work, {"field", "scene.toml", "-o", "f.npy"});
  succeed(work, {"propagate", "f.npy", "--distance", "10 mm", "-o", "single.npy"});
  succeed(work, {"propagate", "f.npy", "--distance", "10 mm", "-o", "double.npy", "--double"});
  const size_t samples = size_t(small_panel.pixels());
  EXPECT_EQ(work.read("single.npy").size(), 128 + 8 * samples);   // header, 2 × 4 bytes
  EXPECT_EQ(work.read("double.npy").size(), 128 + 16 * samples);  // header, 2 × 8 bytes
}

TEST(Commands, CompareTellsEqualFilesAndScaledOnes) {
  const Workplace work;
  work.write("scene.toml", mesh_scene());
  succeed(work, {"field", "scene.toml", "-o", "f.npy"});
  succeed(work, {"render", "scene.toml", "-o", "r.exr"});
  Field twice = load_field(work.path("f.npy"));
  for (auto& u : twice.samples.values) u *= 2;
  save_field(work.path("twice.npy"), twice);
  const auto fields = nlohmann::json::parse(succeed(work, {"compare", "f.npy", "twice.npy", "--json"}));
  EXPECT_NEAR(fields.at("relative_l2_error").get<double>(), 1, 1e-6);  // ‖2f − f‖/‖f‖
  EXPECT_NEAR(fields.at("scale_modulus").get<double>(), 0.5, 1e-6);
  const auto images = nlohmann::json::parse(succeed(work, {"compare", "r.exr", "r.exr", "--json"}));
  succeed(work, {"field", "scene.toml", "-o", "f.exr"});
  const auto exr = nlohmann::json::parse(succeed(work, {"compare", "f.npy", "f.exr", "--json"}));
  EXPECT_EQ(exr.at("relative_l2_error").get<double>(), 0);  // EXR keeps the same floats
  EXPECT_TRUE(images.at("psnr_db").is_null());              // infinite, which JSON cannot represent
  EXPECT_EQ(images.at("ssim").get<double>(), 1);
  EXPECT_NE(succeed(work, {"compare", "r.exr", "r.exr"}).find("infinite"), std::string::npos);
}

}  // namespace
}  // namespace holotrace::test
