#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "holotrace/data/named_medium.h"
#include "holotrace/io/files/npy.h"
#include "holotrace/io/scene/scene_file.h"
#include "io/scene/scene_text.h"
#include "support/error_of.h"
#include "support/temporary.h"

namespace holotrace {
namespace {

using test::make_file;

std::string scene_with(const std::string& lines) {
  return make_file("scene.toml", "wavelength = \"532 nm\"\n[media.m]\n" + lines + "\n" + test::cube);
}

// The error without the folder and the line.
std::string error_of_media(const std::string& lines) {
  const std::string sentence = error_of([&] { load_job(scene_with(lines)); });
  const size_t start = sentence.find("expected");
  return start == std::string::npos ? sentence : sentence.substr(start);
}

std::string grid_file(const std::vector<float>& values, const std::vector<int64_t>& shape) {
  std::string bytes = npy_header("<f4", shape);
  bytes.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(float));
  return make_file("grid.npy", bytes);
}

TEST(SceneMedia, CoefficientsAreReadInTheirUnits) {
  const Scene scene = load_job(scene_with("mean_free_path = \"10 20 40 mm\"\nalbedo = [1, 0.5, 0]\nemission = 2\n"
                                          "concentration = 2\nanisotropy = -0.5"))
                          .scene;
  ASSERT_EQ(scene.media.size(), 1U);
  EXPECT_NEAR(length(scene.media[0].extinction - Vec3{200, 100, 50}), 0, 1e-9);
  EXPECT_TRUE(scene.media[0].is_open);
  const Material& particles = scene.materials.at(size_t(scene.media[0].material));
  EXPECT_EQ(std::get<ScatteringMaterial>(particles.surface).anisotropy, -0.5);
  EXPECT_NEAR(length(particles.emission - Vec3{0, 1, 2}), 0, 1e-12);  // (1 − albedo)·L_e
}

// Whole milk of Jensen et al. 2001: σ_s′ = 2.55, 3.21, 3.77 and σ_a = 0.0011, 0.0024, 0.014 per mm.
TEST(SceneMedia, SubstancesFillTheObjectsThatNameThem) {
  const Scene scene = load_job(scene_with("substance = \"whole milk\"\n[materials.glass]\ntype = \"dielectric\"\n"
                                          "medium = \"m\""))
                          .scene;
  EXPECT_NEAR(scene.media[0].extinction.z, 3784, 1e-6);
  EXPECT_NEAR(std::get<ScatteringMaterial>(scene.materials[0].surface).albedo.y, 3.21 / 3.2124, 1e-9);
  EXPECT_FALSE(scene.media[0].is_open);
  EXPECT_EQ(scene.materials[1].medium, 0);
}

TEST(SceneMedia, TemperaturesAreNumbersOrGrids) {
  const Scene even = load_job(scene_with("mean_free_path = \"1 mm\"\ntemperature = 1800")).scene;
  ASSERT_TRUE(even.media[0].temperature.values);
  EXPECT_EQ(even.media[0].temperature.values->values, std::vector<float>{1800});
  EXPECT_EQ(std::get<ScatteringMaterial>(even.materials.at(size_t(even.media[0].material)).surface).blackbody, 1);
  const std::string grid = grid_file({300, 1800}, {2, 1, 1}), box =
                                                                  "mean_free_path = \"1 mm\"\n"
                                                                  "box = [\"1 1 -1 mm\", \"0 0 -3 mm\"]\n";
  const Scene cells = load_job(scene_with(box + "temperature = \"" + grid + "\"\nblackbody = 0.5")).scene;
  EXPECT_EQ(cells.media[0].temperature.planes, 2);
  EXPECT_EQ((*cells.media[0].temperature.values)(1, 0), 1800);
  EXPECT_EQ(std::get<ScatteringMaterial>(cells.materials.at(size_t(cells.media[0].material)).surface).blackbody, 0.5);
  EXPECT_EQ(error_of_media("mean_free_path = \"1 mm\"\nblackbody = 2"),
            "expected a \"temperature\" for the light of a black body");
  EXPECT_EQ(error_of_media("mean_free_path = \"1 mm\"\ntemperature = -3"),
            "expected a number above 0, up to 100000 for \"temperature\", got -3");
  EXPECT_EQ(error_of_media(box + "temperature = \"" + grid_file({-1, 1800}, {2, 1, 1}) + "\""),
            "expected temperatures from 0 to 100000 K, got -1 in plane 0, row 0, column 0");
}

TEST(SceneMedia, GridsAreReadPlaneByPlane) {
  const std::string grid = grid_file({0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11}, {2, 3, 2});
  const Scene scene = load_job(scene_with("mean_free_path = \"1 mm\"\nbox = [\"1 1 -1 mm\", \"0 0 -3 mm\"]\n"
                                          "density = \"" +
                                          grid + "\""))
                          .scene;
  const Medium& medium = scene.media[0];
  EXPECT_EQ(medium.density.planes, 2);
  EXPECT_EQ((*medium.density.values)(3 * 1 + 2, 1), 11.0F);
  EXPECT_EQ(medium.box->low.z, -3e-3);
  EXPECT_EQ(medium.box->high.x, 1e-3);
}

TEST(SceneMedia, ErrorsSayWhatWasExpected) {
  EXPECT_EQ(error_of_media("albedo = 0.5"), "expected the key \"mean_free_path\" in [media.m], which is missing");
  EXPECT_EQ(error_of_media("mean_free_path = \"-1 mm\""),
            "expected a length above 0 m for \"mean_free_path\", got -1 mm");
  EXPECT_EQ(error_of_media("mean_free_path = \"1 mm\"\nalbedo = 1.5"),
            "expected finite numbers from 0 to 1 for \"albedo\", got 1.5");
  EXPECT_EQ(error_of_media("mean_free_path = \"1 2 mm\""),
            "expected one length or three, for red, green and blue, got 2");
  EXPECT_NE(error_of_media("mean_free_path = \"1 mm\"\nanisotropy = 1").find("\"anisotropy\", got 1"),
            std::string::npos);
  EXPECT_EQ(error_of_media("mean_free_path = \"1 mm\"\nanisotropy = 0.1\ndroplets = \"5 um\""),
            "expected either \"anisotropy\" or \"droplets\", got both");
  EXPECT_NE(error_of_media("substance = \"whole mlik\"").find("whole milk"), std::string::npos);
  EXPECT_EQ(error_of_media("mean_free_path = \"1 mm\"\ndensity = \"a.npy\""),
            "expected a \"box\" for the cells of the density");
  const std::string box = "mean_free_path = \"1 mm\"\nbox = [\"1 1 -1 mm\", \"0 0 -3 mm\"]\ndensity = \"";
  EXPECT_NE(error_of_media(box + "none.npy\"").find("a grid of cells"), std::string::npos);
  EXPECT_EQ(error_of_media(box + grid_file({0, NAN}, {1, 1, 2}) + "\""),
            "expected finite densities of 0 or more, got nan in plane 0, row 0, column 1");
  EXPECT_EQ(error_of_media(box + grid_file({0, 1}, {1, 2}) + "\""),
            "expected the shape (planes, rows, columns), each from 1 to 32768, got (1, 2)");
  EXPECT_EQ(
      error_of_media(box + grid_file({0, 1}, {1, 2, 2}) + "\""),
      "expected 16 bytes of samples for shape (1, 2, 2), got 8; the file is truncated or damaged, write it again");
  EXPECT_EQ(
      error_of_media("mean_free_path = \"1 mm\"\n[materials.wall]\nmedium = \"m\""),
      "expected a medium in a solid that light enters, such as a \"dielectric\" or an \"interface\", got an opaque or "
      "thin material");
  EXPECT_NE(
      error_of_media("mean_free_path = \"1 mm\"\n[materials.glass]\ntype = \"interface\"\nmedium = \"n\"").find("m"),
      std::string::npos);
  EXPECT_EQ(error_of_media("mean_free_path = \"1 mm\"\nbox = [\"1 1 -1 mm\", \"0 0 -3 mm\"]\n[materials.glass]\ntype = "
                           "\"interface\"\nmedium = \"m\""),
            "expected a medium that fills its box or objects, got \"m\" with a box and as the medium of a material");
  EXPECT_EQ(error_of_media("mean_free_path = \"1 mm\"\nemission = 1e300"),
            "expected finite numbers from 0 to 1e+18 for \"emission\", got 1e+300");
}

// Errors that need a whole medium, or all media, name the line of one.
TEST(SceneMedia, ErrorsOfMediaNameTheirLine) {
  const auto expect = [](const std::string& lines, int line, const std::string& sentence) {
    const std::string error = error_of([&] { load_job(scene_with(lines)); });
    EXPECT_NE(error.find("scene.toml:" + std::to_string(line) + ":"), std::string::npos) << error;
    EXPECT_NE(error.find(sentence), std::string::npos) << error;
  };
  expect("mean_free_path = \"1 mm\"\n[media.n]\nmean_free_path = \"1 mm\"", 4,
         "expected one medium without a box that fills the whole scene, got \"m\" and \"n\"");
  expect("mean_free_path = \"1 mm\"\nbox = [\"-1 -1 -5 mm\", \"1 1 5 mm\"]", 2,
         "expected the box of the medium \"m\" on one side of the panel, got one from z = -5 mm to 5 mm");
  expect("mean_free_path = \"1e-320 m\"", 2, "a mean free path of at least 1 nm");
  expect("mean_free_path = \"1 mm\"\nconcentration = 1e18", 2, "expected an extinction from 0 to 1e+09 /m");
  const std::string box = "mean_free_path = \"1 mm\"\nbox = [\"1 1 -1 mm\", \"0 0 -3 mm\"]\ndensity = \"";
  expect(box + grid_file({0, 1e7F}, {2, 1, 1}) + "\"", 2,
         "at most 10000 mean free paths thick, got 10000000 and 10000000");
}

}  // namespace
}  // namespace holotrace
