// holotrace estimate and run --estimate, by their command line. No time is asserted: the machine may be busy.

#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "end_to_end/scenes.h"
#include "support/program.h"

namespace holotrace::test {
namespace {

nlohmann::json json_of(const Workplace& work, const std::vector<std::string>& arguments) {
  const Outcome outcome = work.run(arguments);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  return nlohmann::json::parse(outcome.out);
}

const nlohmann::json& stage(const nlohmann::json& report, const std::string& name) {
  const auto& stages = report.at("stages");
  const auto found = std::find_if(stages.begin(), stages.end(), [&](const auto& s) { return s.at("stage") == name; });
  EXPECT_NE(found, stages.end()) << name;
  return *found;
}

TEST(EstimateCommand, HasATimeForEveryStageOfTheRun) {
  const Workplace work;
  work.write("scene.toml", mesh_scene());
  const Outcome run = work.run({"run", "scene.toml", "-o", "out", "--estimate"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  const auto report = nlohmann::json::parse(work.read("out/report.json"));
  const auto& estimate = stage(report, "estimate");
  double predicted = 0;
  for (const auto& entry : report.at("stages")) {
    const std::string name = entry.at("stage");
    if (name == "estimate") continue;
    ASSERT_TRUE(estimate.contains(name + " predicted_seconds")) << name;
    const double expected = estimate.at(name + " predicted_seconds"), taken = entry.at("seconds");
    EXPECT_GT(expected, 0) << name;
    EXPECT_NEAR(estimate.at(name + " ratio").get<double>(), expected / taken, 1e-9 * expected / taken) << name;
    predicted += expected;
    EXPECT_NE(run.out.find(name), std::string::npos) << name;
  }
  EXPECT_NEAR(estimate.at("all predicted_seconds").get<double>(), predicted, 1e-9 * predicted);
  EXPECT_GT(estimate.at("simulation ratio").get<double>(), 0);
  EXPECT_NE(run.out.find("predicted / taken"), std::string::npos);
}

TEST(EstimateCommand, CountsFramesColoursAndThePapersPixels) {
  const Workplace work;
  std::string scene = mesh_scene();
  scene.replace(scene.find("\"532 nm\""), 8, "[\"638 nm\", \"532 nm\"]");
  scene.replace(scene.find("paths = 4\n"), 10, "paths = 4\nframes = 3\npixel_samples = 5\n");
  work.write("scene.toml", scene);
  const auto one = json_of(work, {"estimate", "scene.toml", "--json", "--fps", "50"});
  EXPECT_EQ(one.at("holograms"), 6);  // 2 colours, 3 frames
  EXPECT_EQ(one.at("wavelengths"), 2);
  EXPECT_EQ(one.at("lights"), 1);
  // Eq. 16 and 23: N = P·S, (1 + l_avg)·N·T_t.
  EXPECT_EQ(one.at("per_pixel").at("paths"), 256 * 192 * 5);
  const double length = one.at("mean_path_length"), ray = one.at("seconds_per_ray");
  EXPECT_NEAR(one.at("per_pixel").at("seconds").get<double>() / (256 * 192 * 5 * (1 + length) * ray), 1, 1e-9);
  EXPECT_NEAR(one.at("probability_to_go_on").get<double>(), 1 - 1 / length, 1e-12);
  const auto& real = one.at("real_time");
  EXPECT_NEAR(real.at("times_this_machine").get<double>(), 50 * real.at("seconds_per_frame").get<double>(), 1e-9);
  EXPECT_GE(real.at("cores").get<double>(), real.at("times_this_machine").get<double>());
  EXPECT_GT(real.at("multiply_adds_per_second").get<double>(), 0);
  const auto& stages = one.at("stages");
  EXPECT_NEAR(
      real.at("seconds_per_frame").get<double>(),
      stages.at("trace").get<double>() + stages.at("synthesize").get<double>() + stages.at("encode").get<double>(),
      1e-9);
}

TEST(EstimateCommand, TellsBothAccelerators) {
  const Workplace work;
  work.write("scene.toml", mesh_scene());
  const auto cost = json_of(work, {"estimate", "scene.toml", "--accelerators", "--json"});
  EXPECT_EQ(cost.at("accelerator"), "Embree");
  EXPECT_GT(cost.at("seconds_per_ray_by_grid").get<double>(), 0);
  EXPECT_GT(cost.at("grid_predicted_cells_per_ray").get<double>(), 1);
  EXPECT_GT(cost.at("grid_predicted_seconds_per_ray_and_thread").get<double>(), 0);
  EXPECT_GT(cost.at("triangles").get<double>(), 100);
  std::string scene = mesh_scene();
  scene.replace(scene.find("[trace]\n"), 8, "[trace]\naccelerator = \"grid\"\n");
  work.write("grid.toml", scene);
  EXPECT_EQ(json_of(work, {"estimate", "grid.toml", "--json"}).at("accelerator"), "grid");
}

TEST(EstimateCommand, KnowsTheOtherStrategiesAndMethods) {
  const Workplace work;
  const auto with_trace = [](const std::string& keys) {
    std::string scene = mesh_scene();
    return scene.replace(scene.find("[trace]\n"), 8, "[trace]\n" + keys);
  };
  work.write("gather.toml", with_trace("strategy = \"gather\"\nphase = \"surface\"\npixel_samples = 2\n"));
  work.write("tiled.toml", with_trace("strategy = \"tiled\"\ntile_columns = 2\ntile_rows = 2\n"));
  work.write("exact.toml", mesh_scene() + "[synthesize]\nmethod = \"exact\"\n");
  work.write("triangles.toml", mesh_scene() + "[synthesize]\nmethod = \"triangles\"\n");
  for (const char* name : {"gather.toml", "tiled.toml", "exact.toml", "triangles.toml"}) {
    const auto cost = json_of(work, {"estimate", name, "--json"});
    EXPECT_FALSE(cost.contains("why_no_simulation")) << name << cost.value("why_no_simulation", "");
    for (const char* key : {"trace_seconds", "synthesis_seconds", "simulation_seconds", "render_seconds"})
      EXPECT_GT(cost.value(key, 0.0), 0) << name << " " << key;
  }
}

// A sphere between the rays of a coarse raster: it is 0.06 mm wide, as far as 32 rays across the panel's field of 2 mm
// are apart.
TEST(EstimateCommand, HasAllStagesOfAnObjectThatACoarseRasterMisses) {
  const Workplace work;
  work.write("scene.toml", scene_head() +
                               "[trace]\ncolumns = 512\nrows = 512\nframes = 2\n[camera]\ndistances = \"30 mm\"\n"
                               "[render]\nrows = 64\npaths = 4\n"
                               "[[light]]\ntype = \"point\"\nposition = \"1 2 -20 mm\"\nintensity = 1e-3\n"
                               "[[object]]\ntype = \"sphere\"\nsize = \"0.05 mm\"\nposition = \"0.03 0.02 -30 mm\"\n");
  const auto cost = json_of(work, {"estimate", "scene.toml", "--json"});
  EXPECT_FALSE(cost.contains("why_no_simulation")) << cost.value("why_no_simulation", "");
  for (const char* stage : {"render", "trace", "synthesize", "encode", "show", "look at 30 mm"})
    EXPECT_TRUE(cost.at("stages").contains(stage)) << stage;
  EXPECT_EQ(cost.at("holograms"), 2);
}

// If the stages of the display cannot run, there is no total.
TEST(EstimateCommand, RefusesWhatTheRunWouldRefuse) {
  const Workplace work;
  work.write("scene.toml", mesh_scene() + "[encode]\nmethod = \"complex\"\n");
  const Outcome outcome = work.run({"estimate", "scene.toml", "--json"});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_NE(outcome.err.find("expected an encoding for a panel that modulates only phase"), std::string::npos);
}

TEST(EstimateCommand, RefusesARateOfNothing) {
  const Workplace work;
  work.write("scene.toml", mesh_scene());
  const Outcome outcome = work.run({"estimate", "scene.toml", "--fps", "0"});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_NE(outcome.err.find("--fps: expected a number above 0, up to 1000000, got 0"), std::string::npos);
}

TEST(Accelerator, OfARunMayBeTheGrid) {
  const Workplace work;
  work.write("scene.toml", mesh_scene());
  EXPECT_EQ(work.run({"trace", "scene.toml", "-o", "embree.ply"}).exit_code, 0);
  EXPECT_EQ(work.run({"trace", "scene.toml", "-o", "grid.ply", "--accelerator", "grid"}).exit_code, 0);
  EXPECT_EQ(work.run({"field", "embree.ply", "-o", "embree.npy", "--slm", "scene.toml"}).exit_code, 0);
  EXPECT_EQ(work.run({"field", "grid.ply", "-o", "grid.npy", "--slm", "scene.toml"}).exit_code, 0);
  const auto metrics = json_of(work, {"compare", "embree.npy", "grid.npy", "--json"});
  // The same waves, except for paths that change at an edge by the rounding of single precision.
  EXPECT_LT(metrics.at("relative_l2_error").get<double>(), 0.02);
}

// A sphere that moves until 0.4 s: 3 of 5 times are computed, and what follows is the arithmetic of the figures given.
TEST(EstimateCommand, OfAFilmHasItsTimesAndWhatTheDisplayNeeds) {
  const Workplace work;
  std::string scene = mesh_scene();
  scene.replace(scene.find("position = \"0.3 0.1 -30 mm\""), 27,
                "position = { \"0 s\" = \"0.3 0.1 -30 mm\", \"400 ms\" = \"0.3 0.2 -30 mm\" }");
  work.write("scene.toml", scene);
  const auto film = json_of(work, {"estimate", "scene.toml", "--json", "--fps", "5", "--seconds", "1"}).at("film");
  EXPECT_EQ(film.at("times"), 5);
  EXPECT_EQ(film.at("times_afresh"), 3);
  EXPECT_EQ(film.at("times_equal"), 2);
  EXPECT_EQ(film.at("holograms"), 5);
  EXPECT_EQ(film.at("bit_planes_per_second"), 40);
  EXPECT_EQ(film.at("bytes_per_second"), 5.0 * small_panel.nx * small_panel.ny);
  EXPECT_GT(film.at("seconds"), 0);
  const double afresh = film.at("equation_17").at("rays_per_second"),
               again = film.at("equation_17").at("new_rays_per_second");
  EXPECT_NEAR(again, afresh * 3 / 5, 1e-9 * afresh);
  const Outcome text = work.run({"estimate", "scene.toml", "--fps", "30", "--refresh", "10"});
  EXPECT_NE(text.out.find("too many: the panel shows 10"), std::string::npos) << text.out;
}

}  // namespace
}  // namespace holotrace::test
