// Time multiplexing: frames with different random phases, averaged by the camera.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "end_to_end/scenes.h"
#include "holotrace/base/units.h"
#include "holotrace/io/field/field_file.h"
#include "holotrace/io/field/hologram_file.h"
#include "holotrace/io/field/sources_file.h"
#include "holotrace/io/picture/image_file.h"
#include "holotrace/run/pipeline.h"
#include "holotrace/slm/encode/encode.h"
#include "holotrace/slm/panel/show.h"
#include "holotrace/view/camera.h"
#include "holotrace/view/combine_views.h"
#include "holotrace/view/compare.h"
#include "support/program.h"

namespace holotrace::test {
namespace {

// A flat, uniform square of points, each with its own random phase.
Sources patch(double side, int points, double depth = 0.03, uint64_t seed = 1) {
  Sources sources;
  sources.wavelength = test_wavelength;
  sources.seed = seed;
  for (int j = 0; j < points; ++j)
    for (int i = 0; i < points; ++i) {
      const double x = side * ((i + 0.5) / points - 0.5), y = side * ((j + 0.5) / points - 0.5);
      const uint64_t key = sources.waves.size();
      sources.waves.push_back({{x, y, -depth}, 0.01F, float(random_phase(seed, 0, key))});
      sources.phase_keys.push_back(key);
    }
  return sources;
}

// The middle of a view, divided by the roll-off of the panel's pixels: sinc²(p·sin/λ) along each axis.
Image middle(const Image& view, double side, double depth, bool has_roll_off) {
  const int half = int(side / view.pitch / 2);
  const Grid grid{view.nx, view.ny, view.pitch};
  const auto mean_at = [&](double x) {
    const double a = pi * 8e-6 * x / std::hypot(x, depth) / test_wavelength;
    return has_roll_off && a != 0 ? std::pow(std::sin(a) / a, 2) : 1;
  };
  Image part(2 * half, 2 * half, 1);
  for (int j = 0; j < part.ny; ++j)
    for (int i = 0; i < part.nx; ++i) {
      const int row = view.ny / 2 - half + j, column = view.nx / 2 - half + i;
      part(j, i) = float(view(row, column) / mean_at(grid.x(column)) / mean_at(grid.y(row)));
    }
  return part;
}

const Grid square_panel{256, 256, 8e-6};

TEST(Frames, SpeckleOfAHologramFallsAsOneOverTheRootOfTheFrames) {
  // A panel of 0.77 mm has grains of λd/S = 83 µm at 120 mm, 72² = 5200 of them in 6 mm: the contrast has an error of
  // 1/√5200 = 1.4 % for one frame and 1 % for many. Points 18 µm apart, about 20 per grain, make the speckle a sum of
  // enough phases: their number lowers the contrast by 1 %. All boxes, ±4 mm, contain the panel. The kinoform's own
  // noise is speckle, too, so the law holds for the hologram and for the field itself.
  const double depth = 0.12;
  const Grid grid{96, 96, 8e-6};
  const Sources sources = patch(7e-3, 390, depth);
  const Slm slm{.name = "test", .grid = grid, .fill_factor = 1};
  const CameraParams camera{.distances = {depth}, .width = 7e-3, .height = 7e-3};
  CombinedViews by_hologram, by_field;
  for (uint32_t frame = 0; frame < 16; ++frame) {
    const Field field = fields_of_frame({{sources}, {}}, frame, grid, {}).front();
    EXPECT_EQ(field.label.frame, frame);
    const Hologram hologram = encode(field, slm, {});
    by_hologram.add(test_wavelength, "", hologram.illumination, look(show(hologram, slm, {}), slm, depth, {}, camera));
    by_field.add(test_wavelength, "", 1, look(field, slm, depth, {}, camera));
    const uint32_t frames = frame + 1;
    if (frames == 1 || frames == 4 || frames == 16) {
      const double of_field = speckle_contrast(middle(by_field.image(), 6e-3, depth, false)) * std::sqrt(frames);
      const double of_hologram = speckle_contrast(middle(by_hologram.image(), 6e-3, depth, true)) * std::sqrt(frames);
      EXPECT_NEAR(of_field, 1, 0.03) << frames;
      EXPECT_NEAR(of_hologram, 1, 0.03) << frames;
      // Compared with the flat patch, the PSNR is this law in decibels, 10·log₁₀M, with 6.02 dB more for
      // four times the frames: 3 % of the contrast are 0.26 dB.
      for (const Image& view :
           {middle(by_field.image(), 6e-3, depth, false), middle(by_hologram.image(), 6e-3, depth, true)}) {
        double mean = 0;
        for (const float value : view.values) mean += value / double(view.values.size());
        Image flat = view;
        std::fill(flat.values.begin(), flat.values.end(), float(mean));
        EXPECT_NEAR(compare(flat, view).psnr_unscaled, 10 * std::log10(frames), 0.26) << frames;
      }
    }
  }
}

TEST(Frames, AreIndependentOfEachOtherAndReproducible) {
  const Sources sources = patch(1e-3, 60);
  const auto frame = [&](uint32_t m) { return fields_of_frame({{sources}, {}}, m, square_panel, {}).front(); };
  const Field first = frame(0), second = frame(1), third = frame(2);
  // 3600 random phases: the correlation of independent fields has the modulus 1/√3600 = 0.017, a Rayleigh variable;
  // it exceeds 4 times this with the probability e⁻¹⁶.
  EXPECT_LT(std::abs(compare(first, second).correlation), 4 / 60.);
  EXPECT_LT(std::abs(compare(first, third).correlation), 4 / 60.);
  EXPECT_LT(std::abs(compare(second, third).correlation), 4 / 60.);
  EXPECT_EQ(frame(2).samples.values, third.samples.values);
  // Frame 2 after frame 1, as in a loop: the same phases, to a float rounding error of each.
  Sources moved = sources;
  set_frame(moved, 1);
  set_frame(moved, 2);
  EXPECT_LT(compare(third, fields_of_frame({{moved}, {}}, 2, square_panel, {}).front()).relative_error, 1e-5);
}

// The cone of all colours, that of 450 nm, is kept at a longer wavelength. At a shorter one the panel's own is narrower.
TEST(Frames, SourcesAtAnotherWavelengthKeepTheirConeWhileThePanelHoldsIt) {
  const Workplace work;
  Sources sources = patch(1e-3, 4);
  sources.label.cone_wavelength = 450e-9;
  save_sources(work.path("s.ply"), sources);
  for (const auto& [wavelength, cone] : {std::pair{500e-9, 450e-9}, {450e-9, 450e-9}, {400e-9, 0.0}}) {
    const std::string text = fmt::format("{:.0f} nm", wavelength * 1e9);
    expect_success(work, {"field", "s.ply", "--columns", "64", "--rows", "48", "--wavelength", text, "-o", "f.npy"});
    const Field field = load_field(work.path("f.npy"));
    EXPECT_DOUBLE_EQ(field.wavelength, wavelength);
    EXPECT_DOUBLE_EQ(field.label.cone_wavelength, cone) << text;
    // Moving a field changes neither.
    expect_success(work, {"propagate", "f.npy", "--distance", "1 mm", "-o", "moved.npy"});
    EXPECT_EQ(load_field(work.path("moved.npy")).wavelength, field.wavelength);
    EXPECT_EQ(load_field(work.path("moved.npy")).label.cone_wavelength, field.label.cone_wavelength) << text;
  }
}

TEST(Frames, TheProgramAveragesThemAsThoseMadeOneByOne) {
  const Workplace work;
  save_sources(work.path("s.ply"), patch(1e-3, 40));
  work.write("points.ply", point_file({{{0, 0, -0.03}}}));
  work.write("scene.toml", scene_head(square_panel) + points_object());
  std::vector<std::string> together{"show"};
  std::vector<Image> views;
  std::vector<double> illuminations;
  for (const std::string m : {"0", "1", "2"}) {
    expect_success(work, {"field", "s.ply", "--slm", "scene.toml", "--frame", m, "-o", "f" + m + ".npy"});
    EXPECT_EQ(std::to_string(load_field(work.path("f" + m + ".npy")).label.frame), m);
    expect_success(work, {"encode", "f" + m + ".npy", "--slm", "scene.toml", "-o", "h" + m + ".png"});
    expect_success(work, {"show", "h" + m + ".png", "--distance", "30 mm", "-o", "v" + m + ".exr"});
    views.push_back(load_image(work.path("v" + m + ".exr")));
    const Hologram hologram = load_hologram(work.path("h" + m + ".png"));
    EXPECT_EQ(std::to_string(hologram.label.frame), m);
    illuminations.push_back(hologram.illumination);
    together.push_back("h" + m + ".png");
  }
  together.insert(together.end(), {"--distance", "30 mm", "-o", "v.exr"});
  expect_success(work, together);
  const Image mean = load_image(work.path("v.exr"));
  const double brightest = *std::max_element(illuminations.begin(), illuminations.end());
  for (size_t i = 0; i < mean.values.size(); ++i) {
    double expected = 0;
    for (size_t m = 0; m < 3; ++m) expected += views[m].values[i] * illuminations[m] / brightest / 3;
    ASSERT_NEAR(mean.values[i], expected, 1e-6 * expected + 1e-12);  // a float rounding error
  }
}

TEST(Frames, RunWritesEveryHologramOfColoursAndFramesAndRemovesOlderOnes) {
  const Workplace work;
  work.write("scene.toml", mesh_scene());
  expect_success(work, {"run", "scene.toml", "-o", "out", "--wavelength", "638 nm, 520 nm, 450 nm", "--frames", "2",
                        "--distance", "30 mm, 32 mm"});
  const std::set<std::string> expected{"scene.toml",         "out",
                                       "out/render.png",     "out/report.json",
                                       "out/render.exr",     "out/sources.ply",
                                       "out/sources_2.ply",  "out/sources_3.ply",
                                       "out/field.npy",      "out/field.npy.json",
                                       "out/hologram.png",   "out/hologram_2.png",
                                       "out/hologram_3.png", "out/hologram_4.png",
                                       "out/hologram_5.png", "out/hologram_6.png",
                                       "out/view.png",       "out/view_2.png"};
  EXPECT_EQ(work.names(), expected);
  EXPECT_EQ(load_fields(work.path("out/field.npy")).size(), 3u);
  EXPECT_EQ(load_image(work.path("out/view.png")).channels, 3);
  EXPECT_EQ(load_hologram(work.path("out/hologram_5.png")).wavelength, 520e-9);
  // The view from the saved files is the same.
  std::vector<std::string> again{"show"};
  for (int i = 0; i < 6; ++i) again.push_back(i == 0 ? "out/hologram.png" : fmt::format("out/hologram_{}.png", i + 1));
  again.insert(again.end(), {"--distance", "30 mm, 32 mm", "-o", "view.png"});
  expect_success(work, again);
  EXPECT_TRUE(work.read("view.png") == work.read("out/view.png"));
  EXPECT_TRUE(work.read("view_2.png") == work.read("out/view_2.png"));

  expect_success(work, {"run", "scene.toml", "-o", "out"});
  const std::set<std::string> fewer{"scene.toml",       "out",
                                    "view.png",         "view_2.png",
                                    "out/render.png",   "out/report.json",
                                    "out/render.exr",   "out/sources.ply",
                                    "out/field.npy",    "out/field.npy.json",
                                    "out/hologram.png", "out/view.png"};
  EXPECT_EQ(work.names(), fewer);
}

TEST(Frames, FieldsInColourPassThroughEveryCommand) {
  const Workplace work;
  work.write("scene.toml", mesh_scene());
  const std::string lines = "638 nm, 520 nm, 450 nm";
  expect_success(work, {"run", "scene.toml", "-o", "out", "--wavelength", lines});
  expect_success(work, {"trace", "scene.toml", "-o", "s.ply", "--wavelength", lines});
  expect_success(work, {"field", "scene.toml", "-o", "f.h5", "--wavelength", lines});
  expect_success(work, {"field", "s.ply", "s_2.ply", "s_3.ply", "--slm", "scene.toml", "-o", "f.npy"});
  EXPECT_TRUE(work.read("f.npy") == work.read("out/field.npy"));
  EXPECT_TRUE(work.read("f.npy.json") == work.read("out/field.npy.json"));
  expect_success(work, {"encode", "f.h5", "--slm", "scene.toml", "-o", "h.png"});
  const Hologram alone = load_hologram(work.path("h_3.png")), of_run = load_hologram(work.path("out/hologram_3.png"));
  EXPECT_EQ(alone.level.values, of_run.level.values);
  EXPECT_EQ(alone.illumination, of_run.illumination);
  expect_success(work, {"propagate", "f.npy", "--distance", "10 mm", "-o", "g.h5", "--periodic", "true"});
  expect_success(work, {"propagate", "g.h5", "--distance", "-10 mm", "-o", "b.npy", "--periodic", "true"});
  const std::vector<Field> back = load_fields(work.path("b.npy")), there = load_fields(work.path("f.npy"));
  ASSERT_EQ(back.size(), 3u);
  EXPECT_LT(relative_error(there, back), 1e-6);  // the design's bound for single precision
  const Outcome outcome = work.run({"compare", "f.npy", "b.npy", "--json"});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("\"fields\""), std::string::npos);
  EXPECT_NE(work.run({"info", "g.h5"}).out.find("638 nm, 520 nm, 450 nm"), std::string::npos);
  EXPECT_NE(work.run({"field", "scene.toml", "-o", "f.exr", "--wavelength", lines}).err.find(".exr holds one"),
            std::string::npos);
}

TEST(Frames, WhatCannotBeShownIsRefusedBeforeAFolderIsMade) {
  const Workplace work;
  work.write("scene.toml", mesh_scene());
  save_sources(work.path("s.ply"), patch(1e-3, 4));
  const std::vector<std::pair<std::vector<std::string>, std::string>> cases{
      {{"run", "scene.toml", "-o", "out", "--frames", "-1"},
       "holotrace: --frames: expected a whole number of 0 or more, got -1\n"},
      {{"run", "scene.toml", "-o", "out", "--wavelength", "638 nm, 638 nm"},
       "holotrace: expected wavelengths that differ, got 638 nm twice; leave one out, or ask for frames\n"},
      {{"run", "scene.toml", "-o", "out", "--wavelength", "638 nm, -1 nm"},
       "holotrace: --wavelength: expected a length above 0 m, got -1 nm\n"},
      {{"field", "s.ply", "s.ply", "--slm", "scene.toml", "-o", "f.npy"},
       "holotrace: expected sources of different wavelengths or names, got s.ply and s.ply at 532 nm; put "
       "them into one file if they are coherent, or make a hologram of each\n"},
      {{"field", "s.ply", "--slm", "scene.toml", "-o", "f.npy", "--wavelength", "638 nm, 450 nm"},
       "holotrace: --wavelength: expected one length, or one for each of 1 files of sources, got 2\n"}};
  for (const auto& [arguments, sentence] : cases) {
    const Outcome outcome = work.run(arguments);
    EXPECT_EQ(outcome.exit_code, 1);
    EXPECT_EQ(outcome.err, sentence);
  }
  const Outcome many = work.run({"run", "scene.toml", "-o", "out", "--frames", "1000000000"});
  EXPECT_NE(many.err.find("a run of 1000000000 hologram(s)"), std::string::npos) << many.err;
  EXPECT_EQ(work.names(), (std::set<std::string>{"scene.toml", "s.ply"}));
}

TEST(Frames, AreCountedByTheEstimate) {
  const Workplace work;
  std::string scene = mesh_scene();
  scene.replace(scene.find("[trace]\n"), 8, "[trace]\nframes = 8\n");
  work.write("scene.toml", scene);
  const Outcome outcome = work.run({"estimate", "scene.toml", "--json"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const auto json = nlohmann::json::parse(outcome.out);
  EXPECT_EQ(json.at("frames"), 8);
  EXPECT_EQ(json.at("holograms"), 8);
  const double parts = json.at("render_seconds").get<double>() + json.at("trace_seconds").get<double>() +
                       json.at("synthesis_seconds").get<double>() + json.at("simulation_seconds").get<double>();
  EXPECT_NEAR(json.at("seconds").get<double>() / parts, 1, 1e-9);
}

}  // namespace
}  // namespace holotrace::test
