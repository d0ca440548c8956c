#include <gtest/gtest.h>

#include <cmath>

#include "holotrace/base/units.h"
#include "holotrace/data/params/animate.h"
#include "holotrace/io/scene/scene_file.h"
#include "holotrace/io/scene/scene_tables.h"
#include "io/scene/scene_text.h"
#include "support/temporary.h"

// Keys over time in scene files.

namespace holotrace {
namespace {

using test::error_with;
using test::make_file;

constexpr double rounding = 1e-15;  // of places of a few hundred millimetres

Job load_at(const std::string& lines, double time) {
  return load_job(make_file("scene.toml", "wavelength = \"532 nm\"\n" + lines), Outside::refused, {}, "", time);
}

Vec3 corner_of_first(const Job& job) { return job.scene.meshes.at(0).positions.at(0); }

std::string moving_quad(const std::string& lines) {
  return "[[object]]\ntype = \"quad\"\nwidth = \"2 mm\"\nheight = \"2 mm\"\n" + lines;
}

TEST(SceneKeys, APlaceIsInterpolatedAndStaysAtTheEnds) {
  const std::string scene = moving_quad("position = { \"1 s\" = \"0 0 -300 mm\", \"3 s\" = \"10 20 -100 mm\" }\n");
  const Vec3 corner = corner_of_first(load_at(moving_quad("position = \"0 0 -300 mm\"\n"), 0));
  const auto moved = [&](double time) { return corner_of_first(load_at(scene, time)) - corner; };
  EXPECT_EQ(moved(-5), (Vec3{0, 0, 0}));
  EXPECT_EQ(moved(1), (Vec3{0, 0, 0}));
  EXPECT_LT(length(moved(1.5) - Vec3{2.5e-3, 5e-3, 0.05}), rounding);
  EXPECT_LT(length(moved(9) - Vec3{10e-3, 20e-3, 0.2}), rounding);
  EXPECT_EQ(load_at(scene, 0).last_key, 3);
  EXPECT_EQ(load_at(scene, 0.25).time, 0.25);
}

TEST(SceneKeys, KeysMayStandBelowAHeading) {
  const Job job =
      load_at(moving_quad("[object.position]\n\"0 s\" = \"0 0 -300 mm\"\n\"500 ms\" = \"0 0 -200 mm\"\n"), 0.25);
  EXPECT_NEAR(corner_of_first(job).z, -0.25, rounding);
}

// y 720 deg are two turns: after 1/8 of the time, a quarter turn about y. The corner (−1, −1, 0) mm goes to (0, −1, 1) mm.
TEST(SceneKeys, TurnsAboutOneAxisGoByAngle) {
  const std::string scene =
      moving_quad("rotation = { \"0 s\" = \"y 0 deg\", \"8 s\" = \"y 720 deg\" }\nposition = \"0 0 -300 mm\"\n");
  const Vec3 start = corner_of_first(load_at(scene, 0)), turned = corner_of_first(load_at(scene, 1));
  const Vec3 p = start + Vec3{0, 0, 0.3};
  EXPECT_LT(length(turned - Vec3{p.z, p.y, -p.x - 0.3}), rounding);
}

// From no turn to a quarter turn about y, then about x: the shortest way is one turn of 120° about (1, 1, 1)/√3.
TEST(SceneKeys, TurnsAboutOtherAxesGoTheShortestWay) {
  const std::string scene = moving_quad(
      "rotation = { \"0 s\" = \"x 0 deg\", \"1 s\" = [\"y 90 deg\", \"x 90 deg\"] }\nposition = \"0 0 -300 mm\"\n");
  const Vec3 p = corner_of_first(load_at(scene, 0)) + Vec3{0, 0, 0.3},
             q = corner_of_first(load_at(scene, 0.5)) + Vec3{0, 0, 0.3};
  const Vec3 axis = normalize(Vec3{1, 1, 1});
  const double angle = 60 * pi / 180;
  const Vec3 expected =
      p * std::cos(angle) + cross(axis, p) * std::sin(angle) + axis * (dot(axis, p) * (1 - std::cos(angle)));
  EXPECT_LT(length(q - expected), rounding);
}

TEST(SceneKeys, LightsColoursAnglesAndDirectionsChange) {
  const Job job = load_at(
      "background = { \"0 s\" = 0, \"1 s\" = [1, 2, 4] }\n"
      "[[light]]\ntype = \"spot\"\nposition = { \"0 s\" = \"0 0 0 mm\", \"1 s\" = \"0 4 0 mm\", interpolation = \"smooth\" }\n"
      "direction = { \"0 s\" = [0, 0, -1], \"1 s\" = [1, 0, 0] }\nintensity = { \"0 s\" = 1, \"1 s\" = [3, 1, 1] }\n"
      "outer_angle = { \"0 s\" = \"10 deg\", \"1 s\" = \"20 deg\" }\n" +
          test::cube,
      0.5);
  EXPECT_EQ(job.scene.background, (Vec3{0.5, 1, 2}));
  const auto& light = std::get<SpotLight>(job.scene.lights.at(0));
  EXPECT_EQ(light.position, (Vec3{0, 2e-3, 0}));
  EXPECT_LT(length(light.direction - normalize(Vec3{1, 0, -1})), rounding);
  EXPECT_EQ(light.intensity, (Vec3{2, 1, 1}));
  EXPECT_NEAR(light.outer_angle, 15 * pi / 180, rounding);
}

TEST(SceneKeys, TheCameraAndItsEyeMoveSmoothly) {
  const std::string scene = test::cube +
                            "[camera]\npupil = \"3 mm\"\n"
                            "eye = { \"0 s\" = \"0 0 250 mm\", \"1 s\" = \"8 0 250 mm\", interpolation = \"smooth\" }\n"
                            "distances = { \"0 s\" = \"290 310 mm\", \"1 s\" = \"300 320 mm\" }\n";
  const Job job = load_at(scene, 0.25);
  const double t = 0.25, part = 3 * t * t - 2 * t * t * t;
  EXPECT_NEAR(job.camera.eye.x, 8e-3 * part, rounding);
  EXPECT_NEAR(job.camera.distances.at(0), 0.2925, rounding);
  EXPECT_NEAR(job.camera.distances.at(1), 0.3125, rounding);
  EXPECT_TRUE(job.are_distances_given);
}

// A count, a name of a material and a flag are those of the last key.
TEST(SceneKeys, ValuesWithoutABetweenKeepTheLastKey) {
  const std::string scene =
      "[materials.red]\nreflectance = [0.8, 0, 0]\n[materials.blue]\nreflectance = [0, 0, 0.8]\n" +
      moving_quad(
          "position = \"0 0 -300 mm\"\nmaterial = { \"0 s\" = \"red\", \"1 s\" = \"blue\" }\n"
          "[trace]\nseed = { \"0 s\" = 1, \"1 s\" = 2 }\n");
  const auto material = [&](double time) { return load_at(scene, time).scene.meshes.at(0).material; };
  EXPECT_NE(material(0.999), material(1));
  EXPECT_EQ(load_at(scene, 0.999).trace.seed, 1);
  EXPECT_EQ(load_at(scene, 1).trace.seed, 2);
}

TEST(SceneKeys, AStillIsReadAtTheTimeOfTheFile) {
  const std::string scene = moving_quad("position = { \"0 s\" = \"0 0 -300 mm\", \"1 s\" = \"0 0 -200 mm\" }\n");
  EXPECT_NEAR(corner_of_first(test::load("time = \"500 ms\"\n" + scene)).z, -0.25, rounding);
  const std::string file = make_file("scene.toml", "time = \"500 ms\"\n" + scene);
  EXPECT_EQ(load_job(file, Outside::refused, {}, "", 1.0).time, 1);  // what is asked for goes first
}

// Numbers of tables in memory are in SI units, and their keys have no order.
TEST(SceneKeys, TablesInMemoryHaveKeys) {
  const toml::table scene{{"wavelength", 532e-9},
                          {"object", toml::array{toml::table{{"type", "wireframe_cube"},
                                                             {"size", toml::table{{"10 s", 0.03}, {"2 s", 0.01}}},
                                                             {"points_per_edge", 2},
                                                             {"position", toml::array{0.0, 0.0, -0.3}}}}}};
  const Job job = job_of_tables(scene, {}, Outside::refused, 6);
  double highest = 0;
  for (const ScenePoint& point : job.scene.points) highest = std::max(highest, point.position.y);
  EXPECT_NEAR(highest, 0.01, rounding);  // half of 20 mm
  EXPECT_EQ(job.last_key, 10);
}

TEST(SceneKeys, ASceneThatExtendsAnotherReplacesAllKeys) {
  make_file("base.toml", "wavelength = \"532 nm\"\n" + test::cube +
                             "[camera]\npupil = { \"0 s\" = \"1 mm\", \"9 s\" = \"9 mm\" }\n");
  const std::string file = make_file(
      "scene.toml", "extends = \"base.toml\"\n[camera]\npupil = { \"1 s\" = \"3 mm\", \"2 s\" = \"5 mm\" }\n");
  const Job job = load_job(file, Outside::refused, {}, "", 1.5);
  EXPECT_NEAR(job.camera.pupil, 4e-3, rounding);
  EXPECT_EQ(job.last_key, 2);
}

// Tables whose names begin with a digit are no keys over time.
TEST(SceneKeys, NamesMayBeginWithADigit) {
  const Job job = load_at(
      "[materials.2wood]\nreflectance = 0.5\n" + moving_quad("position = \"0 0 -300 mm\"\nmaterial = \"2wood\"\n"), 0);
  EXPECT_EQ(
      std::get<DiffuseMaterial>(job.scene.materials.at(size_t(job.scene.meshes.at(0).material)).surface).reflectance.x,
      0.5);
}

TEST(SceneKeys, NothingChangesWithoutKeys) { EXPECT_FALSE(load_at(test::cube, 5).last_key.has_value()); }

TEST(SceneKeyErrors, ArePlaced) {
  const auto error = [](const std::string& keys) {
    return error_with("[[object]]\ntype = \"wireframe_cube\"\nsize = \"20 mm\"\nposition = " + keys + "\n");
  };
  EXPECT_EQ(
      error("{ \"1 s\" = \"0 0 -1 mm\", \"0 s\" = \"0 0 -1 mm\" }"),
      "5:35: expected the keys over time of \"position\" in their order, each time once, got \"0 s\" after \"1 s\"");
  EXPECT_EQ(
      error("{ \"1 s\" = \"0 0 -1 mm\", \"1000 ms\" = \"0 0 -1 mm\" }"),
      "5:35: expected the keys over time of \"position\" in their order, each time once, got \"1000 ms\" after \"1 s\"");
  EXPECT_EQ(error("{ \"1\" = \"0 0 -1 mm\" }"),
            "5:14: expected a time with its unit, such as \"0.5 s\", got \"1\" without a unit as a key over time of "
            "\"position\"");
  EXPECT_EQ(
      error("{ \"1 h\" = \"0 0 -1 mm\" }"),
      "5:14: expected a time in one of the units s, ms, us, µs, min, got \"1 h\" as a key over time of \"position\"");
  EXPECT_EQ(error("{ \"0 s\" = \"0 0 mm\" }"),
            "5:22: expected three lengths for \"position\", such as \"0 0 -300 mm\", got 2");
  EXPECT_EQ(error("{ \"0 s\" = \"0 0 -1 mm\", interpolation = \"cubic\" }").substr(0, 39),
            "5:51: unknown interpolation \"cubic\"; kn");
  EXPECT_EQ(error("{ interpolation = \"smooth\" }"),
            "5:12: expected keys over time { \"0 s\" = …, \"1 s\" = … } for \"position\", got none");
  EXPECT_EQ(
      error_with(test::cube + "[trace]\nseed = { \"0 s\" = 1, interpolation = \"linear\" }\n"),
      "8:37: expected the interpolation \"step\" for \"seed\", which has no values between its keys, got \"linear\"");
  EXPECT_EQ(error_with(test::cube + "[slm]\npitch = { \"0 s\" = \"8 um\" }\n"),
            "8:9: expected one value for \"pitch\" in [slm], got a table; these values do not change over time");
  EXPECT_EQ(error_with(test::cube + "[camera]\ndistances = { \"0 s\" = \"290 mm\", \"1 s\" = \"290 300 mm\" }\n"),
            "8:41: expected as many numbers at each time of \"distances\", got 1 and 2");
  EXPECT_EQ(error_with("background = { \"0 s\" = 1, \"1 s\" = -1 }\n" + test::cube),
            "2:35: expected finite numbers of 0 or more for \"background\", got -1");
}

TEST(TimesOfAFilm, AreEvenlySpacedFromItsStart) {
  AnimateParams params;
  params.fps = 4;
  EXPECT_EQ(times_of(params, 1.0), (std::vector<double>{0, 0.25, 0.5, 0.75}));
  params.start = 0.5;
  EXPECT_EQ(times_of(params, 1.0), (std::vector<double>{0.5, 0.75}));
  params.seconds = 0.25;
  EXPECT_EQ(times_of(params, std::nullopt), (std::vector<double>{0.5}));
  params.times = {0, 3};
  EXPECT_EQ(times_of(params, std::nullopt), (std::vector<double>{0, 3}));
}

TEST(TimesOfAFilm, AreRefusedInOneSentence) {
  AnimateParams params;
  EXPECT_EQ(
      error_of([&] { times_of(params, std::nullopt); }),
      "expected the duration of the film, got none, and nothing in the scene changes over time; give seconds (a flag, "
      "or a key below [animate]), keys over time to what moves, or --turntable to a model");
  params.start = 2;
  EXPECT_EQ(
      error_of([&] { times_of(params, 1.0); }),
      "expected a start before the last key of the scene at 1 s, got 2 s; give the duration of the film as seconds");
  params = {.seconds = 1e6, .fps = 1000};
  EXPECT_EQ(
      error_of([&] { times_of(params, 1.0); }),
      "expected at most 100000 times of a film, got 1e+09: 1e+06 s with 1000 per second; shorten it, or make films of "
      "its parts");
  params = {.times = {1, 0.5}};
  EXPECT_EQ(error_of([&] { times_of(params, 1.0); }),
            "expected the times of a film in their order, got 500 ms after 1 s");
}

// Between opposite directions there is none, at whatever time one looks; steps need none.
TEST(SceneKeys, OppositeDirectionsAreRefused) {
  const std::string lamp =
      "[[light]]\ntype = \"directional\"\nirradiance = 1\ndirection = { \"0 s\" = [0, 0, -1], \"1 s\" = [0, 0, 1]";
  const std::string scene = moving_quad("position = \"0 0 -300 mm\"\n");
  for (const double time : {0.0, 0.25, 0.5, 3.0})
    EXPECT_NE(error_of([&] { load_at(scene + lamp + " }\n", time); }).find("got opposite ones; add a key between"),
              std::string::npos)
        << time;
  EXPECT_NO_THROW(load_at(scene + lamp + ", interpolation = \"step\" }\n", 0.25));
}

}  // namespace
}  // namespace holotrace
