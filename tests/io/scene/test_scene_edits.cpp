#include <gtest/gtest.h>

#include "holotrace/io/scene/scene_edits.h"
#include "io/scene/scene_text.h"

// Values in place of those of a scene file.

namespace holotrace {
namespace {

using test::make_file;

// A scene that another one extends, with an object, a part of a shape, and a lamp.
std::string scene_file() {
  make_file("base.toml",
            "wavelength = \"532 nm\"\n[[light]]\ntype = \"point\"\nposition = \"0 0 100 mm\"\nintensity = 2\n"
            "[[object]]\ntype = \"quad\"\nwidth = \"2 mm\"\nheight = \"2 mm\"\nposition = \"0 0 -300 mm\"\n"
            "[[object]]\ntype = \"shape\"\nshape = \"pair\"\n[[shape.pair]]\ntype = \"box\"\nsize = \"1 1 1 mm\"\n"
            "position = { \"0 s\" = \"0 0 -290 mm\", \"1 s\" = \"9 0 -290 mm\" }\n");
  return make_file("scene.toml", "extends = \"base.toml\"\n[camera]\npupil = \"2 mm\"\n");
}

Job edited(const std::string& edit) {
  return load_job(scene_file(), Outside::refused, {}, "", std::nullopt, {parse_scene_edit(edit)});
}

std::string error_of_edit(const std::string& edit) {
  return error_of([&] { edited(edit); });
}

const PointLight& lamp_of(const Job& job) { return std::get<PointLight>(job.scene.lights.at(0)); }

TEST(SceneEdits, TakeThePlaceOfValues) {
  EXPECT_EQ(edited("camera.pupil=\"3 mm\"").camera.pupil, 3e-3);
  EXPECT_EQ(edited(" camera.pupil = 3 mm ").camera.pupil, 3e-3);
  EXPECT_EQ(edited("light.1.position=[\"1 mm\", \"2 mm\", \"3 mm\"]").scene.lights.size(), 1U);
  EXPECT_EQ(lamp_of(edited("light.1.position=1 2 3 mm")).position, (Vec3{1e-3, 2e-3, 3e-3}));
  EXPECT_EQ(edited("render.rows=40").render.rows, 40);  // of a table that the scene does not have
  EXPECT_EQ(edited("wavelength=633 nm").wavelengths, std::vector<double>{633e-9});
}

TEST(SceneEdits, ReachListsShapesAndKeysOverTime) {
  const Job before = edited("time=0 s"), moved = edited("shape.pair.1.position=0 5 -290 mm");
  EXPECT_EQ(before.scene.meshes.at(1).positions.at(0).y + 5e-3, moved.scene.meshes.at(1).positions.at(0).y);
  EXPECT_EQ(before.scene.meshes.at(0).positions.at(0), moved.scene.meshes.at(0).positions.at(0));
  EXPECT_FALSE(moved.last_key.has_value());
  const Job first = edited("object.1.position=0 1 -300 mm");
  EXPECT_EQ(before.scene.meshes.at(0).positions.at(0) + (Vec3{0, 1e-3, 0}), first.scene.meshes.at(0).positions.at(0));
}

TEST(SceneEdits, ErrorsNameTheEdit) {
  EXPECT_EQ(
      error_of_edit("camera.pupil=3"),
      "--set camera.pupil: expected a length with its unit, such as \"3 mm\", for \"pupil\", got the bare number 3");
  EXPECT_EQ(error_of_edit("camera.pupl=3 mm"), "--set camera.pupl: unknown key \"pupl\"; did you mean \"pupil\"?");
  EXPECT_EQ(error_of_edit("light.2.position=0 0 0 mm"),
            "--set light.2.position: expected the number of an element from 1 to 1, got \"2\"");
  EXPECT_TRUE(error_of_edit("light.0.position=0 0 0 mm").ends_with("from 1 to 1, got \"0\""));
  EXPECT_EQ(error_of_edit("wavelength.x=3"),
            "--set wavelength.x: expected a table or a list before \"x\", got a value");
  EXPECT_TRUE(error_of_edit("slms.x=3").starts_with("--set slms.x: unknown key \"slms\""));
  EXPECT_TRUE(error_of_edit("camera.pupil=\"1 mm\"\neye=\"0 0 1 mm\"").starts_with("--set camera.pupil: expected"));
  for (const char* text : {"camera.pupil", "=3", "camera.pupil=", ""})
    EXPECT_TRUE(error_of([&] { parse_scene_edit(text); }).starts_with("--set: expected KEY=VALUE")) << text;
}

TEST(SceneEdits, OfAModelAreItsParameters) {
  const std::string path = make_file("quad.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n");
  const auto load = [&](const ModelParams& params, const std::vector<SceneEdit>& edits) {
    return load_job(path, Outside::refused, params, "", std::nullopt, edits).scene.meshes.at(0).positions;
  };
  ModelParams turned;
  turned.rotation = {"y 20 deg"};
  EXPECT_EQ(load({}, {{"rotation", "y 20 deg"}}), load(turned, {}));
  EXPECT_NE(load({}, {{"rotation", "y 20 deg"}}), load({}, {}));
  EXPECT_TRUE(error_of([&] {
                load({}, {{"rotatoin", "y 20 deg"}});
              }).starts_with("--set: unknown parameter of a model \"rotatoin\"; did you mean \"rotation\"?"));
}

// What has keys over time, names, and files is left out; a place that an object does not give is there.
TEST(SceneEdits, EditableValuesAreNumbersAndTextsOfNumbers) {
  const std::string path = make_file(
      "values.toml",
      "wavelength = \"532 nm\"\n[materials.red]\ntype = \"diffuse\"\nreflectance = [1, 0.5, 0]\n[[object]]\nname = \"1a\"\n"
      "type = \"box\"\nsize = \"1 1 1 mm\"\nmaterial = \"red\"\nrotation = [\"x 20 deg\", \"y 5 deg\"]\n"
      "[[light]]\ntype = \"point\"\nposition = { \"0 s\" = \"0 0 1 mm\", \"1 s\" = \"0 0 2 mm\" }\nintensity = 2.1\n");
  const std::vector<SceneValue> expected{{{"object.1.rotation", "[\"x 20 deg\", \"y 5 deg\"]"}, "box 1a"},
                                         {{"object.1.size", "1 1 1 mm"}, "box 1a"},
                                         {{"object.1.position", "0 0 0 mm"}, "box 1a"},
                                         {{"light.1.intensity", "2.1"}, "point"},
                                         {{"materials.red.reflectance", "[1, 0.5, 0]"}, "diffuse"}};
  EXPECT_EQ(load_editable_values(path), expected);
  std::vector<SceneEdit> again;  // each may be given back as it is, but for the place, which is the panel's
  for (const SceneValue& value : expected) again.push_back(value.edit);
  again[2].value = "0 0 -300 mm";
  EXPECT_NO_THROW(load_job(path, Outside::refused, {}, "", std::nullopt, again));
}

}  // namespace
}  // namespace holotrace
