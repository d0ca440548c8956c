#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "holotrace/base/units.h"
#include "holotrace/io/mesh/mesh_file.h"
#include "holotrace/io/scene/scene_file.h"
#include "support/error_of.h"
#include "support/gltf.h"
#include "support/temporary.h"

// Animations of glTF models, against closed forms.

namespace holotrace {
namespace {

using test::make_file;

constexpr double single = 1e-6;  // files have single precision: 6e-8 of numbers up to 10

// A model of the triangle (1,0,0), (2,0,0), (1,1,0), with accessors of floats for its animation.
struct AnimatedTriangle {
  std::string nodes = R"([{"mesh": 0}])", roots = "[0]", channels, samplers, more, attributes, primitive, mesh;
  std::string bytes = test::bytes_of(std::vector<float>{1, 0, 0, 2, 0, 0, 1, 1, 0});
  std::string accessors = R"({"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"})",
              views = R"({"buffer": 0, "byteOffset": 0, "byteLength": 36})";
  int count = 1;

  // Adds an accessor and returns its number.
  template <class T>
  int add(const std::vector<T>& values, const std::string& type, size_t each, int component = 5126) {
    const std::string added = test::bytes_of(values);
    views += R"(, {"buffer": 0, "byteOffset": )" + std::to_string(bytes.size()) + R"(, "byteLength": )" +
             std::to_string(added.size()) + "}";
    accessors += R"(, {"bufferView": )" + std::to_string(count) + R"(, "componentType": )" + std::to_string(component) +
                 R"(, "count": )" + std::to_string(values.size() / each) + R"(, "type": ")" + type + "\"}";
    bytes += added;
    return count++;
  }

  // Adds a channel with a sampler of its own.
  void move(const std::string& target, const std::vector<float>& times, const std::vector<float>& values,
            const std::string& type, size_t each, const std::string& interpolation = "LINEAR") {
    const int input = add(times, "SCALAR", 1), output = add(values, type, each);
    const auto number = std::count(samplers.begin(), samplers.end(), '{');
    samplers += std::string(number > 0 ? ", " : "") + R"({"input": )" + std::to_string(input) + R"(, "output": )" +
                std::to_string(output) + R"(, "interpolation": ")" + interpolation + "\"}";
    channels += std::string(number > 0 ? ", " : "") + R"({"sampler": )" + std::to_string(number) + R"(, "target": {)" +
                target + "}}";
  }

  std::string text() const {
    return R"({"asset": {"version": "2.0"}, "scenes": [{"nodes": )" + roots + R"(}], "nodes": )" + nodes +
           R"(, "meshes": [{"name": "triangle", )" + mesh + R"("primitives": [{"attributes": {"POSITION": 0)" +
           attributes + "}" + primitive + R"(}]}], "animations": [{"name": "first", "channels": [)" + channels +
           R"(], "samplers": [)" + samplers + R"(]}, {"name": "second", "channels": [], "samplers": []}], )" + more +
           R"("accessors": [)" + accessors + R"(], "bufferViews": [)" + views + R"(], "buffers": [{"byteLength": )" +
           std::to_string(bytes.size()) + R"(, "uri": "data:application/octet-stream;base64,)" + test::base64(bytes) +
           "\"}]}";
  }

  LoadedModel at(double seconds, const std::string& name = "", bool repeats = false) const {
    return load_meshes(make_file("m.gltf", text()), Outside::refused, {seconds, name, repeats});
  }

  // The first vertex, which is at (1, 0, 0) in its node.
  Vec3 vertex(double seconds) const { return at(seconds).meshes.at(0).positions.at(0); }
};

void expect_near(Vec3 one, Vec3 other, double time) {
  EXPECT_LT(length(one - other), single) << time << ": " << one.x << " " << one.y << " " << one.z;
}

std::string node(int number, const char* path) {
  return R"("node": )" + std::to_string(number) + R"(, "path": ")" + path + "\"";
}

// A quarter turn about z in 2 s, at constant speed; before and after, the ends. q and −q are the same rotation.
TEST(GltfAnimation, ANodeTurnsEvenly) {
  const float half = std::sqrt(0.5f);
  for (const float sign : {1.f, -1.f}) {
    AnimatedTriangle model;
    model.move(node(0, "rotation"), {1, 3}, {0, 0, 0, 1, 0, 0, sign * half, sign * half}, "VEC4", 4);
    for (const double time : {0.0, 1.0, 1.5, 2.2, 3.0, 9.0}) {
      const double angle = std::clamp((time - 1) / 2, 0.0, 1.0) * pi / 2;
      expect_near(model.vertex(time), {std::cos(angle), std::sin(angle), 0}, time);
    }
    EXPECT_EQ(model.at(0).last_key, 3);
    EXPECT_TRUE(model.at(0).warnings.empty());
  }
}

// A child turns about its moved, scaled parent: p = T(t) + 2·R(t)·(x + offset).
TEST(GltfAnimation, ChildrenFollowTheirParents) {
  AnimatedTriangle model;
  model.nodes = R"([{"children": [1], "scale": [2, 2, 2]}, {"mesh": 0, "translation": [0, 3, 0]}])";
  model.move(node(0, "translation"), {0, 1}, {0, 0, 0, 4, 0, -8}, "VEC3", 3);
  model.move(node(1, "rotation"), {0, 1}, {0, 0, 0, 1, 0, 1, 0, 0}, "VEC4", 4);  // half a turn about y
  for (const double t : {0.0, 0.25, 0.75, 1.0})
    expect_near(model.vertex(t), Vec3{4 * t, 0, -8 * t} + Vec3{std::cos(pi * t), 3, -std::sin(pi * t)} * 2, t);
}

TEST(GltfAnimation, StepsKeepTheLastKey) {
  AnimatedTriangle model;
  model.move(node(0, "scale"), {0, 1, 2}, {1, 1, 1, 3, 1, 1, 5, 1, 1}, "VEC3", 3, "STEP");
  expect_near(model.vertex(0.99), {1, 0, 0}, 0.99);
  expect_near(model.vertex(1), {3, 0, 0}, 1);
  expect_near(model.vertex(1.99), {3, 0, 0}, 1.99);
  expect_near(model.vertex(2), {5, 0, 0}, 2);
}

// A cubic with the right slopes is a ballistic path itself: x = 3t, y = 5t − 4t², between keys at 0, 0.5 and 2 s.
TEST(GltfAnimation, ACubicSplineFollowsABallisticPath) {
  AnimatedTriangle model;
  std::vector<float> values;
  for (const float t : {0.f, 0.5f, 2.f}) {
    const float slope = 5 - 8 * t;
    for (const float v : {3.f, slope, 0.f, 3 * t, 5 * t - 4 * t * t, 0.f, 3.f, slope, 0.f}) values.push_back(v);
  }
  values.front() = values.back() = 99;  // slopes before the first and after the last key, which do not count
  model.move(node(0, "translation"), {0, 0.5f, 2}, values, "VEC3", 3, "CUBICSPLINE");
  for (const double t : {0.0, 0.2, 0.5, 0.8, 1.7, 2.0})
    expect_near(model.vertex(t), {1 + 3 * t, 5 * t - 4 * t * t, 0}, t);
}

// Two bones along x, each of length 1: the second, at (1, 0, 0), turns by 2·atan(t) while the first rests. The vertex (2, 0, 0) is
// bound to the second alone, (1, 1, 0) to both by half.
TEST(GltfAnimation, ASkinOfTwoBonesBends) {
  AnimatedTriangle model;
  model.nodes = R"([{"mesh": 0, "skin": 0}, {"children": [2]}, {"translation": [1, 0, 0]}])";
  model.roots = "[0, 1]";
  const int joints = model.add<uint8_t>({0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0}, "VEC4", 4, 5121);
  const int weights = model.add<float>({1, 0, 0, 0, 0, 1, 0, 0, 0.5f, 0.5f, 0, 0}, "VEC4", 4);
  const int binds = model.add<float>({1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0,  0, 0, 1,  // of the bone at the origin
                                      1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -1, 0, 0, 1},
                                     "MAT4", 16);
  model.attributes = R"(, "JOINTS_0": )" + std::to_string(joints) + R"(, "WEIGHTS_0": )" + std::to_string(weights);
  model.more = R"("skins": [{"joints": [1, 2], "inverseBindMatrices": )" + std::to_string(binds) + "}], ";
  const float half = std::sqrt(0.5f);
  model.move(node(2, "rotation"), {0, 1}, {0, 0, 0, 1, 0, 0, half, half}, "VEC4", 4);  // a quarter turn about z
  for (const double t : {0.0, 0.3, 1.0}) {
    const double c = std::cos(pi / 2 * t), s = std::sin(pi / 2 * t);
    const Mesh mesh = model.at(t).meshes.at(0);
    expect_near(mesh.positions.at(0), {1, 0, 0}, t);
    expect_near(mesh.positions.at(1), {1 + c, s, 0}, t);
    expect_near(mesh.positions.at(2), (Vec3{1, 1, 0} + Vec3{1 - s, c, 0}) / 2, t);
  }
}

// Two targets: weights go from (1, 0) to (0, 2). Without an animation they are those of the node, or else of the mesh.
TEST(GltfAnimation, WeightsMoveMorphTargets) {
  AnimatedTriangle model;
  const int first = model.add<float>({0, -1, 0, 0, 0, 0, 0, 0, 0}, "VEC3", 3),
            second = model.add<float>({0, 0, 1, 0, 0, 0, 0, 0, 0}, "VEC3", 3);
  model.primitive =
      R"(, "targets": [{"POSITION": )" + std::to_string(first) + R"(}, {"POSITION": )" + std::to_string(second) + "}]";
  model.mesh = R"("weights": [0.5, 0], )";
  expect_near(model.vertex(0), {1, -0.5, 0}, 0);
  model.nodes = R"([{"mesh": 0, "weights": [0, 0.25]}])";
  expect_near(model.vertex(0), {1, 0, 0.25}, 0);
  model.move(node(0, "weights"), {0, 1}, {1, 0, 0, 2}, "SCALAR", 1);
  for (const double t : {0.0, 0.25, 1.0}) expect_near(model.vertex(t), {1, t - 1, 2 * t}, t);
}

TEST(GltfAnimation, PointersSetMaterialsAndHideNodes) {
  AnimatedTriangle model;
  model.nodes = R"([{"mesh": 0}, {"children": [2]}, {"mesh": 0}])";
  model.roots = "[0, 1]";
  model.more = R"("materials": [{"emissiveFactor": [0, 0, 0]}], )";
  model.primitive = R"(, "material": 0)";
  const auto pointer = [](const std::string& to) {
    return R"("path": "pointer", "extensions": {"KHR_animation_pointer": {"pointer": ")" + to + "\"}}";
  };
  model.move(pointer("/materials/0/emissiveFactor"), {0, 1}, {0, 0, 0, 1, 0.5f, 0}, "VEC3", 3);
  model.move(pointer("/materials/0/pbrMetallicRoughness/roughnessFactor"), {0, 1}, {0, 1}, "SCALAR", 1);
  model.move(pointer("/nodes/1/extensions/KHR_node_visibility/visible"), {0, 0.5f}, {0, 1}, "SCALAR", 1, "STEP");
  const LoadedModel before = model.at(0.25), after = model.at(0.5);
  EXPECT_EQ(before.materials.at(0).emission, (Vec3{0.25, 0.125, 0}));
  EXPECT_EQ(std::get<MetallicRoughnessMaterial>(after.materials.at(0).surface).roughness, 0.5);
  EXPECT_EQ(before.meshes.size(), 1u);  // the node 1 is hidden, with its child
  EXPECT_EQ(after.meshes.size(), 2u);
  EXPECT_TRUE(after.warnings.empty());
  model.move(pointer("/cameras/0/perspective/yfov"), {0}, {1}, "SCALAR", 1);
  ASSERT_EQ(model.at(0).warnings.size(), 1u);
  EXPECT_NE(model.at(0).warnings[0].find("the animation of /cameras/0/perspective/yfov is ignored"), std::string::npos);
}

TEST(GltfAnimation, AnAnimationIsChosenByNameAndMayRepeat) {
  AnimatedTriangle model;
  model.move(node(0, "translation"), {0, 2}, {0, 0, 0, 4, 0, 0}, "VEC3", 3);
  const auto x = [&](double seconds, const char* name, bool repeats) {
    return model.at(seconds, name, repeats).meshes.at(0).positions.at(0).x;
  };
  EXPECT_NEAR(x(1, "first", false), 3, single);
  EXPECT_NEAR(x(1, "second", false), 1, single);  // it moves nothing
  EXPECT_FALSE(model.at(1, "second").last_key.has_value());
  EXPECT_NEAR(x(4.5, "", true), 2, single);
  EXPECT_NEAR(x(-0.5, "", true), 4, single);
  const std::string path = test::temporary("m.gltf");
  EXPECT_EQ(error_of([&] { model.at(0, "fist"); }), path + ": unknown animation \"fist\"; did you mean \"first\"?");
}

TEST(GltfAnimation, DamageIsAnErrorInOneSentence) {
  const std::string path = test::temporary("m.gltf");
  const auto error = [&](const std::string& target, const std::vector<float>& times, const std::vector<float>& values,
                         const std::string& type, size_t each) {
    AnimatedTriangle model;
    model.move(target, times, values, type, each);
    return error_of([&] { model.at(0); });
  };
  EXPECT_EQ(error(node(0, "translation"), {1, 0}, {0, 0, 0, 1, 1, 1}, "VEC3", 3),
            path + ": expected times in their order in an animation, got others; export it again");
  EXPECT_EQ(
      error(node(0, "translation"), {0, 1}, {0, 0, 0}, "VEC3", 3),
      path +
          ": expected 6 finite numbers for the 2 keys of /nodes/0/translation in an animation, got 3; export it again");
  EXPECT_EQ(
      error(node(7, "scale"), {0}, {1, 1, 1}, "VEC3", 3),
      path + ": expected an animation of a node or material of the file, got one of /nodes/7/scale; export it again");
  for (const char* to : {"/materials/99999999999/x", "/materials/-/x", "/materials//x", "/materials/0", "/materials"}) {
    const std::string sentence =
        error(R"("path": "pointer", "extensions": {"KHR_animation_pointer": {"pointer": ")" + std::string(to) + "\"}}",
              {0}, {1}, "SCALAR", 1);
    EXPECT_TRUE(sentence.starts_with(path + ": expected an animation of a node or material") || sentence == "no error")
        << to << sentence;
  }
}

// In a scene, the animation follows the scene's time, or keys of its own.
TEST(GltfAnimation, AScenePlaysItsModels) {
  AnimatedTriangle model;
  model.move(node(0, "translation"), {0, 2}, {0, 0, 0, 4, 0, 0}, "VEC3", 3);
  make_file("m.gltf", model.text());
  const auto job = [&](const std::string& lines, double time) {
    const std::string scene =
        make_file("scene.toml",
                  "wavelength = \"532 nm\"\n[[object]]\ntype = \"mesh\"\nfile = \"m.gltf\"\nscale = 0.001\n"
                  "position = \"0 0 -300 mm\"\n" +
                      lines);
    return load_job(scene, Outside::refused, {}, "", time);
  };
  const auto x = [&](const std::string& lines, double time) {
    return job(lines, time).scene.meshes.at(0).positions.at(0).x * 1e3;
  };
  EXPECT_NEAR(x("", 0.5), 2, single);
  EXPECT_EQ(job("", 0).last_key, 2);
  EXPECT_NEAR(x("animation_time = \"1 s\"\n", 0.5), 3, single);
  EXPECT_FALSE(job("animation_time = \"1 s\"\n", 0).last_key.has_value());
  const std::string slow = "animation_time = { \"0 s\" = \"0 s\", \"8 s\" = \"2 s\" }\n";
  EXPECT_NEAR(x(slow, 2), 2, single);
  EXPECT_EQ(job(slow, 0).last_key, 8);
  EXPECT_NEAR(x("animation_repeats = true\n", 4.5), 2, single);
  EXPECT_NE(error_of([&] { job("animation = \"third\"\n", 0); }).find("scene.toml:4:8: "), std::string::npos);
}

// A camera of 90° whose place goes from (1.3, 0.4, 2) to (1.7, 0.4, 2) in 2 s sees the triangle 2 before it, 4 high, in its middle. It
// keeps the size that it has at 0 s, and moves against the camera.
TEST(GltfAnimation, ASceneFollowsTheCameraOfAModel) {
  AnimatedTriangle model;
  model.nodes = R"([{"mesh": 0, "children": [1]}, {"name": "eye", "camera": 0}])";
  model.more = R"("cameras": [{"type": "perspective", "perspective": {"yfov": 1.5707963267948966}}], )";
  model.move(node(1, "translation"), {0, 2}, {1.3F, 0.4F, 2, 1.7F, 0.4F, 2}, "VEC3", 3);
  make_file("m.gltf", model.text());
  const std::string scene = make_file("scene.toml",
                                      "wavelength = \"532 nm\"\n[[object]]\ntype = \"mesh\"\nfile = \"m.gltf\"\n"
                                      "camera = \"eye\"\ndistance = \"250 mm\"\n");
  for (const double time : {0.0, 0.5, 2.0}) {
    const Job job = load_job(scene, Outside::refused, {}, "", time);
    const double metre = job.slm.grid.height() / 4;
    EXPECT_LT(
        length(job.scene.meshes.at(0).positions.at(0) - Vec3{(1 - 1.3 - 0.2 * time) * metre, -0.4 * metre, -0.25}),
        single * metre)
        << time;
    EXPECT_EQ(job.last_key, 2);
  }
}

// A model that grows from 0 s to 2 s fits at 0 s, and is three times as large at the end.
TEST(GltfAnimation, AFittedModelKeepsTheSizeOfItsStart) {
  AnimatedTriangle model;
  model.move(node(0, "scale"), {0, 2}, {1, 1, 1, 3, 3, 3}, "VEC3", 3);
  make_file("m.gltf", model.text());
  const std::string scene = make_file("scene.toml",
                                      "wavelength = \"532 nm\"\n[[object]]\ntype = \"mesh\"\nfile = \"m.gltf\"\n"
                                      "fit = \"4 mm\"\nposition = \"0 0 -300 mm\"\n");
  const auto width = [&](double time) {
    const auto places = load_job(scene, Outside::refused, {}, "", time).scene.meshes.at(0).positions;
    return places.at(1).x - places.at(0).x;
  };
  EXPECT_NEAR(width(0), 4e-3, 4e-3 * single);
  EXPECT_NEAR(width(2), 12e-3, 12e-3 * single);
}

TEST(GltfAnimation, AModelMayBeHiddenForATime) {
  AnimatedTriangle model;
  model.move(node(0, "scale"), {0, 1}, {0, 0, 0, 1, 1, 1}, "VEC3", 3, "STEP");
  const std::string path = make_file("m.gltf", model.text());
  EXPECT_TRUE(load_meshes(path).meshes.empty());
  EXPECT_EQ(load_meshes(path, Outside::refused, {1}).meshes.size(), 1U);
  const std::string scene = make_file("scene.toml",
                                      "wavelength = \"532 nm\"\n[[object]]\ntype = \"mesh\"\nfile = \"m.gltf\"\n"
                                      "fit = \"4 mm\"\nposition = \"0 0 -300 mm\"\n[[object]]\ntype = \"quad\"\n"
                                      "width = \"1 mm\"\nheight = \"1 mm\"\nposition = \"0 0 -200 mm\"\n");
  EXPECT_EQ(load_job(scene, Outside::refused, {}, "", 0).scene.meshes.size(), 1U);  // the quad
  EXPECT_EQ(load_job(scene, Outside::refused, {}, "", 1).scene.meshes.size(), 2U);
  EXPECT_NE(error_of([&] { load_job(path, Outside::refused, {}, "", 1); }).find("hides all then; put it into a scene"),
            std::string::npos);
}

// What cannot move says so.
TEST(GltfAnimation, IgnoredAnimationsAreWarnings) {
  AnimatedTriangle fixed;
  fixed.nodes = R"([{"mesh": 0, "matrix": [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1]}])";
  fixed.move(node(0, "translation"), {0, 2}, {0, 0, 0, 4, 0, 0}, "VEC3", 3);
  const LoadedModel still = load_meshes(make_file("fixed.gltf", fixed.text()), Outside::refused, {2});
  EXPECT_EQ(still.meshes.at(0).positions.at(0).x, 1);
  ASSERT_EQ(still.warnings.size(), 1U);
  EXPECT_NE(still.warnings[0].find("because the node has a matrix"), std::string::npos);

  AnimatedTriangle red;
  red.more = R"("materials": [{}], )";
  red.move(
      R"("path": "pointer", "extensions": {"KHR_animation_pointer": {"pointer": "/materials/0/emissiveFactor/0"}})",
      {0, 2}, {0, 1}, "SCALAR", 1);
  const LoadedModel element = load_meshes(make_file("red.gltf", red.text()), Outside::refused, {2});
  ASSERT_EQ(element.warnings.size(), 1U);
  EXPECT_NE(element.warnings[0].find("/materials/0/emissiveFactor/0 is ignored"), std::string::npos);
}

TEST(GltfAnimation, TheLastKeyMayBeBeforeZero) {
  AnimatedTriangle model;
  model.move(node(0, "translation"), {-1, -0.5}, {0, 0, 0, 4, 0, 0}, "VEC3", 3);
  EXPECT_EQ(load_meshes(make_file("m.gltf", model.text())).last_key, -0.5);
}

TEST(GltfAnimation, TimesOfAStillModelAreRefused) {
  make_file("m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  for (const char* line : {"animation_time = \"1 s\"\n", "animation_repeats = true\n"}) {
    const std::string scene =
        make_file("scene.toml", std::string("wavelength = \"532 nm\"\n[[object]]\ntype = \"mesh\"\nfile = \"m.obj\"\n"
                                            "scale = 0.001\nposition = \"0 0 -300 mm\"\n") +
                                    line);
    EXPECT_NE(error_of([&] { load_job(scene); }).find("expected a model with an animation"), std::string::npos) << line;
  }
}

}  // namespace
}  // namespace holotrace
