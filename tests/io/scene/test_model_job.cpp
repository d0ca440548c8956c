#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "holotrace/base/units.h"
#include "holotrace/data/shapes.h"
#include "holotrace/io/scene/model_job.h"
#include "holotrace/io/scene/scene_file.h"
#include "holotrace/io/scene/slm_file.h"
#include "support/data_files.h"
#include "support/gltf.h"
#include "support/temporary.h"

namespace holotrace {
namespace {

using namespace literals;

struct Box {
  Vec3 low{INFINITY, INFINITY, INFINITY}, high{-INFINITY, -INFINITY, -INFINITY};

  void add(Vec3 p) {
    low = {std::fmin(low.x, p.x), std::fmin(low.y, p.y), std::fmin(low.z, p.z)};
    high = {std::fmax(high.x, p.x), std::fmax(high.y, p.y), std::fmax(high.z, p.z)};
  }
};

const Mesh* floor_of(const Job& job) {
  const Mesh& last = job.scene.meshes.back();
  return last.name == "floor" ? &last : nullptr;
}

// The bounds of a model without its floor.
Box box_of(const Job& job) {
  Box box;
  for (const Mesh& mesh : job.scene.meshes)
    if (&mesh != floor_of(job))
      for (const Vec3 p : mesh.positions) box.add(p);
  return box;
}

// An L of two boxes: 2 wide, 1 deep, and 2 high on the side of +x; its front is a tile at z = 0.5, y up.
std::string letter(const std::string& up = "y") {
  std::string text;
  for (const Vec3 p :
       {Vec3{-1, 0, 0.5}, {1, 0, 0.5}, {1, 2, 0.5}, {0, 2, 0.5}, {0, 1, 0.5}, {-1, 1, 0.5}, {0, 0, -0.5}})
    text += up == "y" ? fmt::format("v {} {} {}\n", p.x, p.y, p.z) : fmt::format("v {} {} {}\n", p.x, -p.z, p.y);
  return text + "f 1 2 5\nf 2 3 5\nf 3 4 5\nf 1 5 6\nf 7 2 3\n";
}

Job job_of(const std::string& file, const ModelParams& params = {}) {
  return job_for_model(file, slm_preset("pluto"), params);
}

ModelParams upright_model() { return {.rotation = {"y 0 deg"}, .floor = ModelFloor::none}; }

// A model is scaled with what it absorbs: light loses as much on its way through it as before.
TEST(ModelJob, AbsorptionIsScaledWithItsModel) {
  test::GltfTriangle triangle;
  triangle.materials =
      R"([{"extensions": {"KHR_materials_transmission": {"transmissionFactor": 1}, "KHR_materials_volume":
    {"thicknessFactor": 1, "attenuationColor": [0.5, 1, 1], "attenuationDistance": 0.25}}}])";
  const std::string file = test::make_file("m.gltf", triangle.text());
  const auto distances = [](const Scene& scene) {
    std::vector<double> all;
    for (const Mesh& mesh : scene.meshes)
      if (const auto* layers = std::get_if<PrincipledMaterial>(&scene.materials[size_t(mesh.material)].surface))
        all.push_back(layers->attenuation_distance);
    return all;
  };
  const std::string text = "wavelength = \"532 nm\"\nbackground = 1\n[[object]]\ntype = \"mesh\"\nfile = \"m.gltf\"\n";
  const Job job = load_job(test::make_file("scene.toml", text + "fit = \"2 mm\"\nposition = \"0 0 -300 mm\"\n" +
                                                             text.substr(text.find("[[")) +
                                                             "scale = 3\nposition = \"0 0 -9 m\"\n"));
  ASSERT_EQ(distances(job.scene).size(), 2u);
  EXPECT_DOUBLE_EQ(distances(job.scene)[0], 0.25 * 2e-3);  // the sides of 1 m are 2 mm
  EXPECT_DOUBLE_EQ(distances(job.scene)[1], 0.25 * 3);
  const Job alone = job_of(file, upright_model());
  const Box box = box_of(alone);
  ASSERT_EQ(distances(alone.scene).size(), 1u);
  EXPECT_NEAR(distances(alone.scene)[0], 0.25 * (box.high.x - box.low.x), 1e-9);  // as the side of 1 m is
}

// Seen from 18° above, the bounds fill 0.8 of the height or width of the panel's window of 15.36 mm × 8.64 mm, in its
// middle, 300 mm away.
TEST(ModelJob, AModelAloneFillsTheView) {
  for (const auto& file :
       {test::make_file("m.gltf", test::GltfTriangle().text()), test::make_file("m.obj", letter())}) {
    ModelParams params;
    params.floor = ModelFloor::none;
    const Job job = job_of(file, params);
    const Box box = box_of(job);
    const Vec3 size = box.high - box.low, middle = (box.low + box.high) * 0.5;
    EXPECT_NEAR(std::fmax(size.x / 15.36e-3, size.y / 8.64e-3), 0.8, 1e-12);
    EXPECT_NEAR(length(middle - Vec3{0, 0, -0.3}), 0, 1e-15);
    EXPECT_EQ(floor_of(job), nullptr);
    EXPECT_EQ(job.slm.name, "pluto");
    EXPECT_EQ(job.encode.method, Encoding::automatic);  // choose_missing chooses
  }
}

TEST(ModelJob, AnotherPanelPlacesTheModelForItself) {
  const Slm slm{.name = "small", .grid = {256, 256, 8e-6}};
  ModelParams params = upright_model();
  params.fit = 0.5;
  const Job job = job_for_model(test::make_file("m.obj", letter()), slm, params);
  const Box box = box_of(job);
  EXPECT_NEAR(std::fmax(box.high.x - box.low.x, box.high.y - box.low.y), 0.5 * 2.048e-3, 1e-15);
  EXPECT_NEAR((box.low.z + box.high.z) / 2, -2.048e-3 * 300 / 15.36, 1e-15);
}

// The size is that of the view, which is as wide as the panel wherever the model stands; the lamps come along.
TEST(ModelJob, AModelStandsAtTheDistanceThatIsGiven) {
  const std::string file = test::make_file("m.obj", letter());
  ModelParams params = upright_model();
  const Job job = job_of(file, params);
  params.model_distance = 0.12;
  const Job nearer = job_of(file, params);
  const Box box = box_of(job), near_box = box_of(nearer);
  EXPECT_NEAR(length(near_box.low - box.low - Vec3{0, 0, 0.18}), 0, 1e-15);
  EXPECT_NEAR(length(near_box.high - box.high - Vec3{0, 0, 0.18}), 0, 1e-15);
  for (const double distance : nearer.camera.distances) {
    EXPECT_GE(distance, -near_box.high.z);
    EXPECT_LE(distance, -near_box.low.z);
  }
  const auto key = std::get<RectangleLight>(job.scene.lights[0]),
             near_key = std::get<RectangleLight>(nearer.scene.lights[0]);
  EXPECT_NEAR(length(near_key.edge_u), 0.4 * length(key.edge_u), 1e-15);  // 120 mm of 300 mm
}

// The floor touches the lowest point; its normal is up, which seen from 18° above is (0, cos 18°, sin 18°).
TEST(ModelJob, TheModelStandsOnAFloorThatFades) {
  const Job job = job_of(test::make_file("m.obj", letter()));
  const Mesh* floor = floor_of(job);
  ASSERT_NE(floor, nullptr);
  const Vec3 up = floor->normals.front();
  EXPECT_NEAR(length(up - Vec3{0, std::cos(18_deg), std::sin(18_deg)}), 0, 1e-12);
  double lowest = INFINITY;
  for (const Vec3 p : job.scene.meshes.front().positions)
    lowest = std::fmin(lowest, dot(p - floor->positions.front(), up));
  EXPECT_NEAR(lowest, 0, 1e-15);
  EXPECT_EQ(floor->colours.front(), (Vec3{1, 1, 1}));
  EXPECT_NEAR(floor->colours.back().x, 0, 1e-12);  // the last ring is its edge
  for (const auto& [a, b, c] : floor->triangles)
    EXPECT_GT(dot(cross(floor->positions[b] - floor->positions[a], floor->positions[c] - floor->positions[a]), up), 0);
}

// A lamp of radiance L, area A and distance d gives white that faces it the radiance L·A/(π·d²): 0.85 from the key
// light and 0.2 from the fill light. Both face the model, and are not seen.
TEST(ModelJob, TwoLampsFaceTheModel) {
  const Job job = job_of(test::make_file("m.obj", letter()));
  ASSERT_EQ(job.scene.lights.size(), 2u);
  const double white[] = {0.85, 0.2}, side[] = {-1, 1};
  for (size_t i = 0; i < 2; ++i) {
    const auto lamp = std::get<RectangleLight>(job.scene.lights[i]);
    const Vec3 front = cross(lamp.edge_u, lamp.edge_v), middle = lamp.corner + (lamp.edge_u + lamp.edge_v) * 0.5;
    const Vec3 way = Vec3{0, 0, -0.3} - middle;
    EXPECT_NEAR(dot(normalize(front), normalize(way)), 1, 1e-12);
    EXPECT_NEAR(lamp.radiance.x * length(front) / dot(way, way), pi * white[i], 1e-12);
    EXPECT_GT(middle.x * side[i], 0);
    EXPECT_GT(middle.y, 0);
    EXPECT_FALSE(lamp.is_visible);
  }
  EXPECT_FALSE(job.render.has_background);
}

// A triangle of 1 m in the plane z = 0, a light, and two cameras of 60° that look at it from 2 m: one along −z, one away.
std::string lit_model(const std::string& light) {
  test::GltfTriangle model;
  model.nodes = R"([{"mesh": 0, "children": [1, 2, 3]},
    {"translation": [0.3, 0.4, 1], "extensions": {"KHR_lights_punctual": {"light": 0}}},
    {"name": "front", "translation": [0.25, 0.25, 2], "camera": 0},
    {"name": "away", "translation": [0.25, 0.25, -2], "camera": 0}])";
  model.more = R"("extensions": {"KHR_lights_punctual": {"lights": [)" + light +
               R"(]}}, "cameras": [{"type": "perspective", "perspective": {"yfov": 1.0471975511965976}}], )";
  return test::make_file("lit.gltf", model.text());
}

double even_light(const Job& job) { return job.scene.background.x; }

// A point light of I lights the right corner of the triangle, (1, 0, 0), with I/d², whatever the size of the model; so does the
// sun's irradiance. The even light is 1/7 of the light from lamps (0.15 of 1.05), here at the middle of the model's bounds.
TEST(ModelJob, LightsOfTheFileTakeThePlaceOfLamps) {
  const ModelParams params = upright_model();
  const Job job = job_of(lit_model(R"({"type": "point", "intensity": 7})"), params);
  ASSERT_EQ(job.scene.lights.size(), 1u);
  const auto light = std::get<PointLight>(job.scene.lights[0]);
  Vec3 corner = job.scene.meshes[0].positions[0];
  for (const Vec3 p : job.scene.meshes[0].positions)
    if (p.x > corner.x) corner = p;
  const Vec3 way = light.position - corner, before = Vec3{0.3, 0.4, 1} - Vec3{1, 0, 0};
  EXPECT_NEAR(light.intensity.x / dot(way, way), 7 / dot(before, before), 1e-12);
  const Vec3 to_middle = Vec3{0.3, 0.4, 1} - Vec3{0.5, 0.5, 0};
  EXPECT_NEAR(even_light(job), 7 / dot(to_middle, to_middle) / pi / 7, 1e-12);

  const Job sunny = job_of(lit_model(R"({"type": "directional", "intensity": 3})"), params);
  EXPECT_EQ(std::get<DirectionalLight>(sunny.scene.lights.at(0)).irradiance, (Vec3{3, 3, 3}));
  EXPECT_NEAR(even_light(sunny), 3 / pi / 7, 1e-12);
}

TEST(ModelJob, LampsMayBeChosen) {
  ModelParams params;
  params.model_lights = ModelLights::studio;
  const std::string lit = lit_model(R"({"type": "point"})"), unlit = test::make_file("m.obj", letter());
  EXPECT_EQ(job_of(lit, params).scene.lights.size(), 2u);
  params.model_lights = ModelLights::file;
  EXPECT_EQ(job_of(lit, params).scene.lights.size(), 1u);
  EXPECT_EQ(error_of([&] { job_of(unlit, params); }),
            unlit + ": expected a model with lights, got one without; leave out --model-lights");
}

// The camera sees 2·tan 30°·2 m at the triangle, which becomes the height of the panel; the triangle stays as wide as it is high,
// and what the camera looks at is in the middle.
TEST(ModelJob, ACameraOfTheFileShowsItsView) {
  ModelParams params;
  params.model_camera = "front";
  const std::string file = lit_model(R"({"type": "point"})");
  const Job job = job_of(file, params);
  EXPECT_EQ(floor_of(job), nullptr);
  const double factor = job.slm.grid.height() / (4 * std::tan(pi / 6));
  const std::vector<Vec3>& seen = job.scene.meshes.at(0).positions;
  EXPECT_LT(length(seen[0] - Vec3{-0.25 * factor, -0.25 * factor, -0.3}), 1e-15);
  EXPECT_LT(length(seen[1] - Vec3{0.75 * factor, -0.25 * factor, -0.3}), 1e-15);
  EXPECT_LT(length(seen[2] - Vec3{-0.25 * factor, 0.75 * factor, -0.3}), 1e-15);
  EXPECT_EQ(job.camera.distances, std::vector<double>{0.3});

  params.model_camera = "away";
  EXPECT_EQ(error_of([&] { job_of(file, params); }),
            file + ": expected a camera that sees the model, got \"away\", which does not; choose another");
  params.model_camera = "frnt";
  EXPECT_NE(error_of([&] { job_of(file, params); }).find("\"front\""), std::string::npos);
  params.rotation = {"y 10 deg"};
  EXPECT_EQ(error_of([&] { job_of(file, params); }), "expected either a rotation or a camera of the model, got both");
}

// In a scene, `camera` places a model by its name or number, and its light: the same closed form, 200 mm away. Nothing of the panel's
// frame moves: the quad stays.
TEST(ModelJob, ASceneTakesTheCameraOfAModel) {
  lit_model(R"({"type": "point", "intensity": 7})");
  for (const std::string camera : {"front", "1"}) {
    const std::string scene =
        test::make_file("scene.toml",
                        "wavelength = \"532 nm\"\n[[object]]\ntype = \"quad\"\nwidth = \"1 mm\"\nheight = \"1 mm\"\n"
                        "position = \"0 0 -100 mm\"\n[[object]]\ntype = \"mesh\"\nfile = \"lit.gltf\"\nlights = true\n"
                        "distance = \"200 mm\"\ncamera = \"" +
                            camera + "\"\n");
    const Job job = load_job(scene);
    const double factor = job.slm.grid.height() / (4 * std::tan(pi / 6));
    EXPECT_EQ(job.scene.meshes.at(0).positions[0].z, -0.1);
    EXPECT_LT(length(job.scene.meshes.at(1).positions[1] - Vec3{0.75 * factor, -0.25 * factor, -0.2}), 1e-15);
    const auto light = std::get<PointLight>(job.scene.lights.at(0));
    EXPECT_LT(length(light.position - Vec3{0.05 * factor, 0.15 * factor, factor - 0.2}), 1e-15);
    EXPECT_NEAR(light.intensity.x, 7 * factor * factor, 1e-12);
  }
  const auto error_with = [](const std::string& lines) {
    return error_of([&] {
      load_job(test::make_file("bad.toml",
                               "wavelength = \"532 nm\"\n[[object]]\ntype = \"mesh\"\nfile = \"lit.gltf\"\n" + lines));
    });
  };
  EXPECT_NE(error_with("camera = \"front\"\nfit = \"1 mm\"\n")
                .find("expected either a \"camera\" of the model or \"fit\", got both"),
            std::string::npos);
  EXPECT_NE(error_with("camera = \"frnt\"\n").find("bad.toml:5:10: "), std::string::npos);
  EXPECT_NE(error_with("camera = \"3\"\n").find("unknown camera \"3\""), std::string::npos);
}

// A camera of 90° is at (0.25, 0.25, 2). Its picture is filled most by a triangle ten times as large at z = 0, 2 before it: that is
// the middle, and what is in the picture of it is from the triangle's corner at (0, 0) to 0.25 + 2 in y and 0.25 + 2·16/9 in x.
// Of the triangle at z = 1.5 its corner above y = 0.25 + 0.5 is cut away; that at z = 3 is behind the camera, and that at
// z = −2, beside the picture but beyond the middle, stays whole.
TEST(ModelJob, WhatACameraDoesNotSeeIsCutAway) {
  test::GltfTriangle model;
  model.nodes =
      R"([{"children": [1, 2, 3, 4, 5]}, {"translation": [0.25, 0.25, 2], "camera": 0}, {"mesh": 0, "scale": [10, 10, 1]},
    {"mesh": 0, "translation": [0, 0, 3]}, {"mesh": 0, "translation": [0, 0, 1.5]}, {"mesh": 0, "translation": [9, 0, -2]}])";
  model.more = R"("cameras": [{"name": "c", "type": "perspective", "perspective": {"yfov": 1.5707963267948966}}], )";
  ModelParams params;
  params.model_camera = "c";
  const Job job = job_of(test::make_file("four.gltf", model.text()), params);
  const double metre = job.slm.grid.height() / 4;
  std::vector<double> areas, places;  // in the file's units
  for (const Mesh& mesh : job.scene.meshes) {
    areas.push_back(0);
    for (const auto& [a, b, c] : mesh.triangles)
      areas.back() +=
          cross(mesh.positions[b] - mesh.positions[a], mesh.positions[c] - mesh.positions[a]).z / 2 / metre / metre;
    places.push_back((mesh.positions[0].z + 0.3) / metre);
  }
  const std::vector<double> expected_areas{2.25 * (0.25 + 32.0 / 9), 0.5 - 0.25 * 0.25 / 2, 0.5},
      expected_places{0, 1.5, -2};
  ASSERT_EQ(areas.size(), 3u);
  for (size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(areas[i], expected_areas[i], 1e-11) << i;
    EXPECT_NEAR(places[i], expected_places[i], 1e-12) << i;
  }
}

// The same of an orthographic camera, whose picture is 2·0.5 high everywhere: of a triangle at z = 0, which is the middle, the
// corner above y = 0.25 + 0.5 is cut away.
TEST(ModelJob, AnOrthographicPictureIsAsHighEverywhere) {
  test::GltfTriangle model;
  model.nodes = R"([{"mesh": 0, "children": [1]}, {"translation": [0.25, 0.25, 2], "camera": 0}])";
  model.more = R"("cameras": [{"name": "c", "type": "orthographic", "orthographic": {"xmag": 1, "ymag": 0.5}}], )";
  ModelParams params;
  params.model_camera = "c";
  const Job job = job_of(test::make_file("flat.gltf", model.text()), params);
  ASSERT_EQ(job.scene.meshes.size(), 1u);
  double highest = 0;
  for (const Vec3 p : job.scene.meshes[0].positions) highest = std::fmax(highest, p.y);
  EXPECT_NEAR(highest, job.slm.grid.height() / 2, 1e-15);
}

// After either of these turns the L is the same: z up is turned to y up first.
TEST(ModelJob, UpAndRotationTurnTheModel) {
  const Box upright = box_of(job_of(test::make_file("y.obj", letter()), upright_model()));
  ModelParams params = upright_model();
  params.up = UpAxis::z;
  const Box from_z = box_of(job_of(test::make_file("z.obj", letter("z")), params));
  EXPECT_NEAR(length(upright.low - from_z.low), 0, 1e-12);
  EXPECT_NEAR(length(upright.high - from_z.high), 0, 1e-12);
  params = upright_model();
  params.rotation = {"z 180 deg", " z 180 deg"};
  const Box turned_twice = box_of(job_of(test::make_file("y.obj", letter()), params));
  EXPECT_NEAR(length(upright.low - turned_twice.low), 0, 1e-12);
  params.rotation = {"30 deg"};
  EXPECT_EQ(error_of([&] { job_of(test::make_file("y.obj", letter()), params); }),
            "expected turns about axes for the rotation of the model, such as \"y 30 deg, x 10 deg\", got \"30 deg\"");
}

// The axis is in the middle of the view. Half a turn takes each place to the other side of it; in a quarter, what was in front goes to
// the right. The L, 2 wide and 1 deep about its middle, is widest as the circle of its far corners.
TEST(ModelJob, ATurntableTurnsTheModelOnceWithinTheView) {
  const std::string file = test::make_file("m.obj", letter());
  ModelParams params = upright_model();
  params.turntable = 4;
  const auto at = [&](double time) { return job_for_model(file, slm_preset("pluto"), params, Outside::refused, time); };
  const std::vector<Vec3> start = at(0).scene.meshes[0].positions, quarter = at(1).scene.meshes[0].positions,
                          half = at(2).scene.meshes[0].positions, whole = at(4).scene.meshes[0].positions;
  EXPECT_EQ(at(0).last_key, 4.0);
  double to_right = 0;
  for (size_t i = 0; i < start.size(); ++i) {
    EXPECT_NEAR(start[i].x, -half[i].x, 1e-12);
    EXPECT_LT(length(start[i] - whole[i]), 1e-12);
    to_right += quarter[i].x * (start[i].z - (start[i].z + half[i].z) / 2);
  }
  EXPECT_GT(to_right, 0);
  Box all;
  for (int step = 0; step < 400; ++step) {
    const Box now = box_of(at(step / 100.0));
    all.add(now.low), all.add(now.high);
  }
  const Vec3 size = all.high - all.low;
  EXPECT_NEAR(std::fmax(size.x / 15.36e-3, size.y / 8.64e-3), 0.8, 1e-3);
  EXPECT_NEAR(all.low.x, -all.high.x, 1e-5);
  params.rotation.clear();
  params.model_camera = "c";
  EXPECT_EQ(error_of([&] { at(0); }), "expected either a turntable or a camera of the model, got both");
}

// A flat plate with four pits on one side, and nothing on the others: the side with the pits is turned to the viewer.
TEST(ModelJob, AModelWithoutADeclaredFrontShowsItsDetail) {
  const auto plate = [](double z) {
    std::string text = "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nf 1 2 3 4\n";
    int vertex = 5;
    for (const double x : {-0.5, 0.5})
      for (const double y : {-0.5, 0.5}) {
        text += fmt::format("v {} {} {}\nv {} {} {}\nv {} {} {}\nv {} {} {}\n", x - 0.3, y - 0.3, z / 10, x + 0.3,
                            y - 0.3, z / 10, x, y + 0.3, z / 10, x, y, z);
        text +=
            fmt::format("f {0} {1} {3}\nf {1} {2} {3}\nf {2} {0} {3}\n", vertex, vertex + 1, vertex + 2, vertex + 3);
        vertex += 4;
      }
    return test::make_file("plate.obj", text);
  };
  for (const double z : {0.5, -0.5}) {
    ModelParams params;
    params.floor = ModelFloor::none;
    const Job job = job_of(plate(z), params);
    const std::vector<Vec3>& p = job.scene.meshes.front().positions;
    EXPECT_GT(p[7].z, (p[4].z + p[5].z + p[6].z) / 3);  // the tip of a pit is nearer than its base
  }
}

// Each turn shows the same of a sphere up to its facets, so the first one is taken; glTF says where its front is.
TEST(ModelJob, TheFirstTurnIsTakenUnlessAnotherShowsMore) {
  EXPECT_EQ(turn_that_shows_most({make_sphere(1, 64)}, {0.5, 1.5, 2.5}, Frame{}), 0.5);
}

TEST(ModelJob, ColoursOfAModelDecideItsWavelengths) {
  EXPECT_EQ(job_of(test::make_file("m.obj", letter())).wavelengths, (std::vector<double>{532e-9}));
  test::make_file("m.mtl", "newmtl red\nKd 0.8 0.2 0.2\n");
  const Job job = job_of(test::make_file("m.obj", "mtllib m.mtl\nusemtl red\n" + letter()));
  EXPECT_EQ(job.wavelengths, (std::vector<double>{638e-9, 532e-9, 450e-9}));
  ASSERT_FALSE(job.chosen.empty());
  EXPECT_EQ(job.chosen[0].parameter, "wavelength");
  EXPECT_EQ(job.chosen[0].why, "the scene has colours");
}

// The L upright, its front 0.5 before its middle, is one plane that faces the panel from 18° above; the depth of focus is
// 2λ(d/w)² = 0.41 mm.
TEST(ModelJob, TheCameraLooksAtTheNearestAndTheFarthestSurface) {
  const Job job = job_of(test::make_file("m.obj", letter()));
  ASSERT_EQ(job.camera.distances.size(), 2u);
  const Box box = box_of(job);
  EXPECT_GT(job.camera.distances[0], -box.high.z);
  EXPECT_LT(job.camera.distances[1], -box.low.z);
  EXPECT_GT(job.camera.distances[1] - job.camera.distances[0], 0.41e-3);
  EXPECT_EQ(job.render.focus, job.camera.distances[0]);
  ModelParams facing = upright_model();
  facing.rotation = {"x -18 deg"};  // straight to the panel
  EXPECT_EQ(job_of(test::make_file("m.obj", "v -1 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"), facing).camera.distances.size(),
            1u);
}

TEST(ModelJob, AModelWithoutAnExtentIsRefused) {
  const std::string path = test::make_file("m.obj", "v 1 1 1\nv 1 1 1\nv 1 1 1\nf 1 2 3\n");
  EXPECT_EQ(
      error_of([&] { load_job(path); }),
      path + ": expected a mesh with triangles, got only triangles without an area; are all its parts scaled to 0?");
}

TEST(ModelJob, EveryKindOfModelLoadsThroughASceneAndAlone) {
  size_t meshes = 0, textured = 0, coloured = 0;
  for (const auto& entry : std::filesystem::directory_iterator(test::data_folder())) {
    const std::string file = entry.path().string(), kind = entry.path().extension().string();
    if (kind != ".obj" && kind != ".glb" && kind != ".ply") continue;
    SCOPED_TRACE(file);
    EXPECT_NE(floor_of(load_job(file)), nullptr);
    const Job job =
        load_job(test::make_file("scene.toml", "wavelength = \"532 nm\"\n[[object]]\ntype = \"mesh\"\nfile = '" + file +
                                                   "'\nfit = \"7 mm\"\ndistance = \"200 mm\"\n"));
    EXPECT_NEAR(max_component(box_of(job).high - box_of(job).low), 7e-3, 1e-15);
    ++meshes;
    for (const Material& material : job.scene.materials) {
      const auto* surface = std::get_if<MetallicRoughnessMaterial>(&material.surface);
      textured += surface && surface->base_texture;
      coloured += surface && surface->base_color.x != surface->base_color.z;
    }
  }
  EXPECT_EQ(meshes, 7u);    // one of them of points
  EXPECT_EQ(textured, 1u);  // the box
  EXPECT_EQ(coloured, 1u);  // the pump's base
}

}  // namespace
}  // namespace holotrace
