#include <gtest/gtest.h>

#include <cmath>

#include "holotrace/base/units.h"
#include "holotrace/io/picture/image_file.h"
#include "holotrace/io/scene/scene_file.h"
#include "io/scene/scene_text.h"
#include "support/data_files.h"
#include "support/gltf.h"
#include "support/temporary.h"

namespace holotrace {
namespace {

using test::cube;
using test::error_with;
using test::load;
using test::make_file;

TEST(SceneFile, ASmallSceneTakesEveryDefault) {
  const Job job = load("wavelength = \"632.8 nm\"\n" + cube);
  EXPECT_EQ(job.wavelengths.front(), 632.8e-9);
  EXPECT_EQ(job.slm.name, "pluto");
  EXPECT_EQ(job.slm.grid, (Grid{1920, 1080, 8e-6}));
  ASSERT_EQ(job.scene.points.size(), 20u);  // 12·3 − 16
  EXPECT_EQ(job.scene.points[0].position, (Vec3{-0.01, -0.01, -0.3 - 0.01}));
  EXPECT_EQ(job.trace.columns, TraceParams{}.columns);
  EXPECT_EQ(job.camera.distances, CameraParams{}.distances);
}

TEST(SceneFile, ThePanelIsAPresetWithChanges) {
  const Job job =
      load("wavelength = \"532 nm\"\n[slm]\npreset = \"gaea\"\nlevels = 16\nmodulation = \"amplitude\"\n" + cube);
  EXPECT_EQ(job.slm.grid, (Grid{4160, 2464, 3.74e-6}));
  EXPECT_EQ(job.slm.levels, 16);
  EXPECT_EQ(job.slm.modulation, Modulation::amplitude);
  EXPECT_EQ(job.slm.name, "gaea");
  const Job own = load(
      "wavelength = \"532 nm\"\n[slm]\ncolumns = 512\nrows = 256\npitch = \"10 um\"\nfill_factor = 1\n"
      "design_wavelength = \"633 nm\"\n" +
      cube);
  EXPECT_EQ(own.slm.grid, (Grid{512, 256, 10e-6}));
  EXPECT_EQ(own.slm.fill_factor, 1);
  EXPECT_EQ(own.slm.design_wavelength, 633e-9);
  EXPECT_EQ(own.slm.name, "custom");
}

TEST(SceneFile, EveryStageReadsItsTable) {
  const Job job = load(R"(wavelength = "532 nm"
background = [0.1, 0.2, 0.3]
[trace]
pattern = "random"
samples = 1000
phase = "constant"
field_of_view = "2 deg"
seed = 7
[render]
rows = 100
[synthesize]
method = "exact"
tolerance = 1e-4
[encode]
method = "off-axis"
image = "real"
with_bias = false
reference_angle_x = "-1 deg"
[show]
subpixels = 3
wavelength = "633 nm"
[propagate]
method = "fresnel"
[camera]
distances = "290 300 mm"
bits = 16
exposure = 2
)" + cube);
  EXPECT_EQ(job.scene.background, (Vec3{0.1, 0.2, 0.3}));
  EXPECT_EQ(job.trace.pattern, Pattern::random);
  EXPECT_EQ(job.trace.samples, 1000);
  EXPECT_EQ(job.trace.phase, SourcePhase::constant);
  EXPECT_DOUBLE_EQ(job.trace.field_of_view, 2 * pi / 180);
  EXPECT_EQ(job.trace.seed, 7);
  EXPECT_EQ(job.render.rows, 100);
  EXPECT_EQ(job.synthesize.method, SynthesisMethod::exact);
  EXPECT_EQ(job.synthesize.tolerance, 1e-4);
  EXPECT_EQ(job.encode.method, Encoding::off_axis);
  EXPECT_EQ(job.encode.image, ImageSide::real_image);
  EXPECT_FALSE(job.encode.with_bias);
  EXPECT_DOUBLE_EQ(job.encode.reference_angle_x, -pi / 180);
  EXPECT_EQ(job.show.subpixels, 3);
  EXPECT_EQ(job.show.wavelength, 633e-9);
  EXPECT_EQ(job.propagate.method, PropagationMethod::fresnel);
  EXPECT_EQ(job.camera.distances, (std::vector<double>{0.29, 0.3}));
  EXPECT_EQ(job.camera.bits, 16);
}

TEST(SceneFile, LightsAndMaterialsAreRead) {
  const std::string texture = test::temporary("white.png");
  Image white(1, 1, 3);
  white.values = {1, 1, 1};
  save_image(texture, white, 1, 8);
  const Job job = load(R"(wavelength = "532 nm"
[materials.paper]
texture = "white.png"
[materials.lamp]
type = "diffuse"
reflectance = 0.5
emission = [1, 2, 3]
[[light]]
type = "point"
position = ["1 mm", "2 mm", "3 m"]
intensity = 4
[[light]]
type = "rectangle"
corner = "0 0 -100 mm"
edge_u = "10 0 0 mm"
edge_v = "0 10 0 mm"
radiance = [1, 2, 3]
[[light]]
type = "rectangle"
visible = false
corner = "0 0 -100 mm"
edge_u = "10 0 0 mm"
edge_v = "0 10 0 mm"
radiance = 1
[[object]]
type = "quad"
width = "10 mm"
height = "20 mm"
material = "lamp"
position = "0 0 -300 mm"
)");
  ASSERT_EQ(job.scene.materials.size(), 2u);
  ASSERT_EQ(job.scene.lights.size(), 3u);
  const auto& point = std::get<PointLight>(job.scene.lights[0]);
  EXPECT_EQ(point.position, (Vec3{1e-3, 2e-3, 3}));
  EXPECT_EQ(point.intensity, (Vec3{4, 4, 4}));
  const auto& rectangle = std::get<RectangleLight>(job.scene.lights[1]);
  EXPECT_EQ(rectangle.corner, (Vec3{0, 0, -0.1}));
  EXPECT_EQ(rectangle.radiance, (Vec3{1, 2, 3}));
  EXPECT_TRUE(rectangle.is_visible);
  EXPECT_FALSE(std::get<RectangleLight>(job.scene.lights[2]).is_visible);
  const Material& lamp = job.scene.materials[size_t(job.scene.meshes[0].material)];
  EXPECT_EQ(std::get<DiffuseMaterial>(lamp.surface).reflectance, (Vec3{0.5, 0.5, 0.5}));
  EXPECT_EQ(lamp.emission, (Vec3{1, 2, 3}));
  int with_texture = 0;
  for (const Material& material : job.scene.materials)
    with_texture += std::get<DiffuseMaterial>(material.surface).texture != nullptr;
  EXPECT_EQ(with_texture, 1);
}

// A quarter turn about x takes y to z, then one about y takes z to x; then the position is added.
TEST(SceneFile, ObjectsAreScaledThenTurnedInOrderThenPlaced) {
  const Job job = load(
      "wavelength = \"532 nm\"\n[[object]]\ntype = \"box\"\nsize = \"1 2 3 mm\"\nscale = 2\n"
      "rotation = [\"x 90 deg\", \"y 90 deg\"]\nposition = \"10 20 -300 mm\"\n");
  Vec3 low{1, 1, 1}, high{-1, -1, -1};
  for (Vec3 p : job.scene.meshes[0].positions) {
    low = {std::fmin(low.x, p.x), std::fmin(low.y, p.y), std::fmin(low.z, p.z)};
    high = {std::fmax(high.x, p.x), std::fmax(high.y, p.y), std::fmax(high.z, p.z)};
  }
  // x → z, y → x, z → y: sides of 2·(2, 3, 1) mm; a few ulps of 0.3.
  EXPECT_NEAR(high.x - low.x, 4e-3, 1e-15);
  EXPECT_NEAR(high.y - low.y, 6e-3, 1e-15);
  EXPECT_NEAR(high.z - low.z, 2e-3, 1e-15);
  EXPECT_NEAR(high.x + low.x, 20e-3, 1e-15);
  EXPECT_NEAR(high.z + low.z, -600e-3, 1e-15);
}

TEST(SceneFile, FitGivesTheLargestSideAndCentres) {
  make_file("m.obj", "v 5 5 5\nv 7 5 5\nv 5 6 5\nf 1 2 3\n");
  const Job job = load(
      "wavelength = \"532 nm\"\n[[object]]\ntype = \"mesh\"\nfile = \"m.obj\"\nfit = \"8 mm\"\n"
      "position = \"0 0 -300 mm\"\nname = \"leaf\"\n");
  const auto& p = job.scene.meshes[0].positions;
  EXPECT_EQ(job.scene.meshes[0].name, "leaf");
  EXPECT_NEAR(p[0].x, -4e-3, 1e-17);
  EXPECT_NEAR(p[1].x, 4e-3, 1e-17);
  EXPECT_NEAR(p[0].y, -2e-3, 1e-17);
  EXPECT_EQ(p[0].z, -0.3);
}

TEST(SceneFile, PositionsGiveCopies) {
  const Job job = load(
      "wavelength = \"532 nm\"\n[[object]]\ntype = \"sphere\"\nsize = \"1 mm\"\nsegments = 8\n"
      "positions = [\"0 0 -100 mm\", \"0 0 -200 mm\", \"5 0 -200 mm\"]\n");
  EXPECT_EQ(job.scene.meshes.size(), 3u);
  EXPECT_EQ(job.scene.materials.size(), 1u);  // one default material
}

TEST(SceneFile, AShapeIsPlacedWithTheMaterialOfWhoeverUsesIt) {
  const Job job = load(R"(wavelength = "532 nm"
[materials.ivory]
[materials.gold]
[[shape.king]]
type = "lathe"
profile = { unit = "mm", points = [[0, 0], [5, 0], [3, 10], [0, 10]] }
segments = 12
[[shape.king]]
type = "extrusion"
outline = { unit = "mm", points = [[-1, 0], [1, 0], [1, 4], [-1, 4]] }
depth = "1 mm"
position = "0 10 0 mm"
material = "gold"
[[object]]
type = "shape"
shape = "king"
material = "ivory"
scale = 2
position = "0 0 -300 mm"
[[object]]
type = "shape"
shape = "king"
position = "50 0 -300 mm"
)");
  ASSERT_EQ(job.scene.meshes.size(), 4u);
  EXPECT_EQ(job.scene.meshes[0].material, job.scene.meshes[0].material);
  EXPECT_NE(job.scene.meshes[0].material, job.scene.meshes[1].material);
  EXPECT_EQ(job.scene.meshes[1].material, job.scene.meshes[3].material);  // gold in both
  EXPECT_NE(job.scene.meshes[0].material, job.scene.meshes[2].material);  // ivory and the default
  double top = 0;
  for (Vec3 p : job.scene.meshes[1].positions) top = std::fmax(top, p.y);
  EXPECT_DOUBLE_EQ(top, 28e-3);  // 2·(10 + 4) mm
}

TEST(SceneFile, PointObjectsHaveAmplitudeAndPhase) {
  save_image(
      test::temporary("quarter.exr"),
      [] {
        Image image(1, 1, 1);
        image.values = {0.25f};
        return image;
      }(),
      1, 8);
  for (const char* type : {"point_quad", "textured_quad"}) {
    const Job job = load(std::string("wavelength = \"532 nm\"\n[[object]]\ntype = \"") + type +
                         "\"\nwidth = \"4 mm\"\nheight = \"2 mm\"\ncolumns = 3\nrows = 2\ntexture = \"quarter.exr\"\n"
                         "amplitude = 3\nphase = \"90 deg\"\nposition = \"0 0 -300 mm\"\n");
    ASSERT_EQ(job.scene.points.size(), 6u);
    EXPECT_FLOAT_EQ(job.scene.points[0].amplitude, 1.5f);  // 3·√0.25
    EXPECT_FLOAT_EQ(job.scene.points[0].phase, float(pi / 2));
  }
}

TEST(SceneFile, PointsOfAFileStandWhereScaleAndDistancePutThem) {
  const Job job =
      load("wavelength = \"532 nm\"\n[[object]]\ntype = \"points\"\nfile = '" + test::data_file("helix_points.ply") +
           "'\nscale = 0.01\ndistance = \"100 mm\"\nchannel = \"green\"\n");
  ASSERT_EQ(job.scene.points.size(), 500u);
  // The first point is at (0.5, −0.5, 0) in the unit of the file, with green 255; the last has no colour.
  EXPECT_LT(length(job.scene.points[0].position - Vec3{0.005, -0.005, -0.1}), 1e-15);
  EXPECT_FLOAT_EQ(job.scene.points[0].amplitude, 1);
  EXPECT_FLOAT_EQ(job.scene.points[499].amplitude, 0);
}

TEST(SceneFile, WarningsOfModelsReachTheJob) {
  test::GltfTriangle triangle;
  triangle.more = R"("extensionsUsed": ["EXT_unheard_of"], )";
  const std::string file = test::make_file("unheard_of.gltf", triangle.text());
  const Job job = load("wavelength = \"532 nm\"\nbackground = 1\n[[object]]\ntype = \"mesh\"\nfile = '" + file +
                       "'\nfit = \"20 mm\"\nposition = \"0 0 -300 mm\"\n");
  EXPECT_EQ(job.warnings, (std::vector<std::string>{file + ": the extension EXT_unheard_of is ignored"}));
  for (const Mesh& mesh : job.scene.meshes) EXPECT_LT(size_t(mesh.material), job.scene.materials.size());
}

// The panel is 15.36 mm wide and 8.64 mm high: of the triangle's 40 × 40 mm, 8.3 % lie before it.
TEST(SceneFile, ModelsOfWhichACameraSeesLittleAreNoticed) {
  const std::string file = test::make_file("large.gltf", test::GltfTriangle{}.text());
  const auto warnings = [&](const std::string& more, const std::string& rest = "") {
    return load("wavelength = \"532 nm\"\nbackground = 1\n[[object]]\ntype = \"mesh\"\nfile = '" + file + "'\n" + more +
                rest)
        .warnings;
  };
  const std::string large = "scale = 0.04\nposition = \"-20 -20 -300 mm\"\n",
                    beside = "scale = 0.002\nposition = \"20 0 -300 mm\"\n";
  ASSERT_EQ(warnings(large).size(), 1u);
  EXPECT_NE(warnings(large)[0].find(
                "the model is 40 mm wide and 40 mm high, of which a camera sees 15.36 mm × 8.64 mm; set its "
                "\"fit\", such as \"8.64 mm\", or its \"scale\""),
            std::string::npos)
      << warnings(large)[0];
  EXPECT_TRUE(warnings("scale = 0.03\nposition = \"-15 -15 -300 mm\"\n").empty());  // 15 %
  ASSERT_EQ(warnings(beside).size(), 1u);
  EXPECT_NE(warnings(beside)[0].find("the model lies beside what a camera sees"), std::string::npos)
      << warnings(beside)[0];
  for (const char* camera : {"[camera]\nwidth = \"40 mm\"\nheight = \"40 mm\"\n",
                             "[camera]\neye = \"0 0 250 mm\"\npupil = \"3 mm\"\n", "[encode]\neye = \"0 0 250 mm\"\n"})
    EXPECT_TRUE(warnings(large, camera).empty()) << camera;
  EXPECT_TRUE(warnings("scale = 0.002\npositions = [\"0 0 -300 mm\", \"20 0 -300 mm\"]\n").empty());
  EXPECT_TRUE(
      warnings("scale = 0.002\nposition = { \"0 s\" = \"20 0 -300 mm\", \"1 s\" = \"0 0 -300 mm\" }\n").empty());
}

// A model is scaled from 1 m to 20 mm: a point light of 1 W/sr to (1/50)². The lights of two copies are two.
TEST(SceneFile, LightsOfModelsAreTakenIfAsked) {
  test::GltfTriangle triangle;
  triangle.nodes = R"([{"mesh": 0, "translation": [0, 0, 1], "extensions": {"KHR_lights_punctual": {"light": 0}}}])";
  triangle.more = R"("extensions": {"KHR_lights_punctual": {"lights": [{"type": "point"}]}}, )";
  const std::string scene = "wavelength = \"532 nm\"\nbackground = 1\n[[object]]\ntype = \"mesh\"\nfile = '" +
                            test::make_file("lit.gltf", triangle.text()) +
                            "'\nfit = \"20 mm\"\npositions = [\"0 0 -300 mm\", \"10 0 -300 mm\"]\n";
  const Job job = load(scene + "lights = true\n");
  ASSERT_EQ(job.scene.lights.size(), 2u);
  EXPECT_TRUE(job.warnings.empty());
  const auto light = std::get<PointLight>(job.scene.lights[1]);
  EXPECT_NEAR(light.intensity.x, 1.0 / 2500, 1e-18);
  EXPECT_LT(length(light.position - job.scene.meshes[1].positions[0]), 1e-15);  // both at their node
  EXPECT_TRUE(load(scene + "lights = false\n").warnings.empty());
  const Job unlit = load(scene);
  EXPECT_TRUE(unlit.scene.lights.empty());
  ASSERT_EQ(unlit.warnings.size(), 1u);
  EXPECT_NE(unlit.warnings[0].find("the model's lights are ignored; \"lights = true\" takes them into the scene"),
            std::string::npos);
}

TEST(SceneFile, CentresMayBeOfEitherSign) {
  const Job job = load("wavelength = \"532 nm\"\n" + cube +
                       "[propagate]\ncentre_x = \"-2 mm\"\npitch = \"4 um\"\n"
                       "[camera]\ncentre_y = \"-30 um\"\ncentre_x = \"1 mm\"\n");
  EXPECT_DOUBLE_EQ(job.propagate.centre_x, -2e-3);
  EXPECT_DOUBLE_EQ(job.camera.centre_y, -30e-6);
  EXPECT_DOUBLE_EQ(job.camera.centre_x, 1e-3);
  EXPECT_EQ(error_with("[camera]\ncentre_x = 3\n" + cube),
            "3:12: expected a length with its unit, such as \"300 mm\", for \"centre_x\", got the bare number 3");
  EXPECT_EQ(error_with("[camera]\npixel = \"-3 um\"\n" + cube),
            "3:9: expected a length of 0 m or more for \"pixel\", got -3 µm");
}

}  // namespace
}  // namespace holotrace
