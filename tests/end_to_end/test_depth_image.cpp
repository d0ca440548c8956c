// A picture with depths, from its files to the view at each depth.

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "end_to_end/scenes.h"
#include "holotrace/io/field/field_file.h"
#include "holotrace/io/field/sources_file.h"
#include "holotrace/io/picture/image_file.h"
#include "holotrace/wave/propagate/propagate.h"
#include "support/program.h"

namespace holotrace::test {
namespace {

// Vertical bars on the left, near; horizontal bars on the right, far; black between; on the small panel's pixels.
constexpr int nx = small_panel.nx, ny = small_panel.ny, bar = 6;

bool is_left(int i, int j) { return i >= 30 && i < 108 && j >= 60 && j < 132; }
bool is_right(int i, int j) { return i >= 148 && i < 226 && j >= 60 && j < 132; }

void write_pictures(const Workplace& work, Vec3 left = {1, 1, 1}, Vec3 right = {1, 1, 1}) {
  Image picture(ny, nx, 3), depth(ny, nx, 1);
  for (int j = 0; j < ny; ++j)
    for (int i = 0; i < nx; ++i) {
      const Vec3 colour = is_left(i, j) && i / bar % 2 ? left : is_right(i, j) && j / bar % 2 ? right : Vec3{};
      picture(j, i, 0) = float(colour.x), picture(j, i, 1) = float(colour.y), picture(j, i, 2) = float(colour.z);
      depth(j, i) = float(is_left(i, j));
    }
  save_image(work.path("picture.png"), picture, 1, 8);
  save_image(work.path("depth.png"), depth, 1, 8);
}

std::vector<std::string> field_command(const std::vector<std::string>& more = {}) {
  std::vector<std::string> command{"field", "picture.png", "--depth", "depth.png",  "--near", "30 mm",
                                   "--far", "45 mm",       "--slm",   "scene.toml", "-o",     "f.npy"};
  command.insert(command.end(), more.begin(), more.end());
  return command;
}

// Ratio of the light of the bars to the light between them.
double contrast(const Image& view, bool left) {
  double bright = 0, dark = 0;
  for (int j = 0; j < ny; ++j)
    for (int i = 0; i < nx; ++i) {
      if (!(left ? is_left(i, j) : is_right(i, j))) continue;
      ((left ? i : j) / bar % 2 ? bright : dark) += view(j, i);
    }
  return bright / dark;
}

// All colours keep to the cone of the shortest wavelength, unless each is to have its own.
TEST(DepthImage, ColoursShareTheConeOfTheShortestWavelength) {
  const Workplace work;
  work.write("scene.toml", scene_head() + points_object());
  work.write("points.ply", point_file({{{0, 0, -0.02}}}));
  write_pictures(work);
  const auto cones = [&](const std::string& is_common) {
    expect_quiet_success(work, field_command({"--wavelength", "638 nm, 450 nm", "--common-cone", is_common}));
    std::vector<double> wavelengths;
    for (const Field& field : load_fields(work.path("f.npy"))) wavelengths.push_back(field.label.cone_wavelength);
    return wavelengths;
  };
  EXPECT_EQ(cones("true"), (std::vector<double>{450e-9, 450e-9}));
  EXPECT_EQ(cones("false"), (std::vector<double>{0, 0}));  // 0: its own
}

// Bars of 48 µm; the panel resolves λd/S = 8 … 16 µm. 15 mm out of focus, light spreads over 15/30 of 2 mm: bars
// vanish. A kinoform loses the modulus: noise of about a fifth of the light (4/π of the power of speckle) is
// everywhere.
TEST(DepthImage, IsSharpAtEachOfItsDepths) {
  const Workplace work;
  work.write("scene.toml", scene_head() + points_object());
  work.write("points.ply", point_file({{{0, 0, -0.02}}}));
  write_pictures(work);
  expect_quiet_success(work, field_command());
  expect_quiet_success(work, {"encode", "f.npy", "-o", "h.png"});
  expect_quiet_success(work, {"show", "h.png", "-o", "v.exr", "--distance", "30 45 mm"});
  const Image near = load_image(work.path("v.exr")), far = load_image(work.path("v_2.exr"));
  EXPECT_GT(contrast(near, true), 2.5);
  EXPECT_GT(contrast(far, false), 2.5);
  EXPECT_LT(contrast(near, false), 1.3);
  EXPECT_LT(contrast(far, true), 1.3);
}

TEST(DepthImage, OfColoursIsAFieldForEachWavelength) {
  const Workplace work;
  work.write("scene.toml", scene_head() + points_object());
  work.write("points.ply", point_file({{{0, 0, -0.02}}}));
  write_pictures(work, {1, 0, 0}, {0, 0, 1});
  expect_quiet_success(work,
                       field_command({"--wavelength", "630 nm, 460 nm", "--frame", "3", "--silhouettes", "true"}));
  const std::vector<Field> fields = load_fields(work.path("f.npy"));
  ASSERT_EQ(fields.size(), 2U);
  EXPECT_EQ(fields[0].wavelength, 630e-9);
  EXPECT_EQ(fields[1].label.frame, 3U);
  // Each field has a part of the same light, and the panel takes some of it: neither is dark.
  EXPECT_GT(power(fields[0]), 0.2 * power(fields[1]));
  EXPECT_GT(power(fields[1]), 0.2 * power(fields[0]));
}

TEST(DepthImage, OfColoursHasOneFieldOfViewForAll) {
  const Workplace work;
  work.write("scene.toml", scene_head() + points_object());
  work.write("points.ply", point_file({{{0, 0, -0.02}}}));
  write_pictures(work, {1, 1, 1}, {0, 0, 0});
  expect_quiet_success(work, field_command({"--wavelength", "638 nm, 450 nm", "--projection", "perspective"}));
  std::vector<double> middle;  // centre of the light in the plane of the bars [m]
  for (const Field& field : load_fields(work.path("f.npy"))) {
    const Field near = propagate(field, -0.03);
    double sum = 0, moment = 0;
    for (int j = 0; j < ny; ++j)
      for (int i = 0; i < nx; ++i) {
        sum += std::norm(near.samples(j, i));
        moment += std::norm(near.samples(j, i)) * near.grid.x(i);
      }
    middle.push_back(moment / sum);
  }
  // With their own acceptance they would be 638/450 = 1.42 apart. Both see about 5000 speckles of bars 0.6 mm wide at
  // 0.45 mm: the centres have an error of about 0.2 mm/√5000, below 1 %.
  EXPECT_NEAR(middle[0] / middle[1], 1, 0.05);
  EXPECT_LT(middle[0], -0.1e-3);
}

TEST(DepthImage, MistakesAreToldInASentence) {
  const Workplace work;
  work.write("scene.toml", scene_head() + points_object());
  work.write("points.ply", point_file({{{0, 0, -0.02}}}));
  write_pictures(work);
  const auto error = [&](const std::vector<std::string>& arguments) {
    const Outcome outcome = work.run(arguments);
    EXPECT_EQ(outcome.exit_code, 1);
    EXPECT_FALSE(work.has("f.npy"));
    return outcome.err;
  };
  EXPECT_EQ(error({"field", "picture.png", "-o", "f.npy"}),
            "holotrace: picture.png: expected --depth with a picture, got none; give its depth image\n");
  EXPECT_EQ(error({"field", "scene.toml", "--near", "3 mm", "-o", "f.npy"}),
            "holotrace: expected --depth with --near, which describes a picture with depths; give both or neither\n");
  for (const std::vector<std::string>& one : {std::vector<std::string>{}, {"--near", "3 mm"}, {"--far", "-3 mm"}}) {
    std::vector<std::string> arguments{"field", "picture.png", "--depth", "depth.png", "-o", "f.npy"};
    arguments.insert(arguments.end(), one.begin(), one.end());
    EXPECT_EQ(error(arguments),
              "holotrace: depth.png: expected --near and --far, the depths of its white and black; give both\n");
  }
  EXPECT_EQ(error(field_command({"--method", "tiled"})),
            "holotrace: expected the method layers for a picture with depths, got tiled; leave it out\n");
  EXPECT_EQ(
      error(field_command({"--double"})),
      "holotrace: expected --double with a scene or sources, which it sums wave by wave; got a picture with depths\n");
  EXPECT_EQ(error({"field", "scene.toml", "--depth", "depth.png", "-o", "f.npy"}),
            "holotrace: scene.toml: expected a picture (.png, .jpg, .tif, .exr) with --depth; leave out --depth\n");
}

// The method `layers` for a scene's waves, by the command line, against the exact method.
TEST(DepthImage, AndScenesTakeTheMethodLayers) {
  const Workplace work;
  std::vector<Luminous> points;
  for (int i = 0; i < 12; ++i)
    points.push_back({{0.2e-3 * (i % 4) - 0.3e-3, 0.2e-3 * (i / 4) - 0.2e-3, i % 2 ? -0.1 : -0.11}});
  work.write("points.ply", point_file(points));
  work.write("scene.toml", scene_head() + points_object());
  expect_quiet_success(work, {"field", "scene.toml", "-o", "exact.npy", "--method", "exact"});
  expect_quiet_success(work, {"field", "scene.toml", "-o", "layers.npy", "--method", "layers", "--tolerance", "1e-3"});
  const Outcome outcome = work.run({"compare", "exact.npy", "layers.npy", "--json"});
  EXPECT_LT(nlohmann::json::parse(outcome.out).at("relative_l2_error").get<double>(), 1e-3);
}

}  // namespace
}  // namespace holotrace::test
