// Flags that cannot be, and files of the wrong kind: exit code 1, one helpful sentence on stderr, and no new file.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "end_to_end/expect_error.h"
#include "end_to_end/scenes.h"
#include "holotrace/io/field/field_file.h"

namespace holotrace::test {
namespace {

TEST(BadInput, FlagsOfTheWrongKindAreNamed) {
  const Workplace work;
  work.write("scene.toml", mesh_scene());
  ASSERT_EQ(work.run({"run", "scene.toml", "-o", "out"}).exit_code, 0);
  const std::string f = "out/field.npy", h = "out/hologram.png";
  expect_error(work, {"show", h, "-o", "v.png", "--distance", "300"}, {"--distance:", "unit", "300"});
  expect_error(work, {"show", h, "-o", "v.png", "--distance", ""}, {"--distance:", "unit"});
  expect_error(work, {"show", h, "-o", "v.png", "--bits", "9"}, {"8 or 16", "9"});
  expect_error(work, {"show", h, "-o", "v.png", "--distance", "30 mm", "--width", "1 nm"}, {"sensor", "8 µm", "1 nm"});
  expect_error(work, {"propagate", f, "-o", "g.npy", "--distance", "300"}, {"--distance:", "unit", "300"});
  expect_error(work, {"propagate", f, "-o", "g.npy", "--distance", "nan mm"}, {"--distance:", "finite"});
  expect_error(work, {"field", "scene.toml", "-o", "f.npy", "--wavelength", "632.8"}, {"--wavelength:", "unit"});
  expect_error(work, {"field", "scene.toml", "-o", "f.npy", "--slm", "plutto"}, {"did you mean \"pluto\""});
  expect_error(work, {"field", "scene.toml", "-o", "f.npy", "--method", "tield"}, {"did you mean \"tiled\""});
  expect_error(work, {"field", "scene.toml", "-o", "f.npy", "--tolerance", "small"},
               {"--tolerance:", "number", "small"});
  expect_error(work, {"field", "scene.toml", "-o", "f.npy", "--tolerance", "-1"},
               {"tolerance", "above 0 and below 1", "-1"});
  expect_error(work, {"field", "scene.toml", "-o", "f.npy", "--wavelength", "-1 nm"}, {"wavelength", "above 0"});
  expect_error(work, {"encode", f, "-o", "h.png", "--method", "phaze"}, {"did you mean \"phase\""});
  expect_error(work, {"encode", f, "-o", "h.png", "--levels", "1"}, {"levels", "2 to"});
  expect_error(work, {"encode", f, "-o", "h.png", "--eye", "0 0 250 mm"},
               {"--eye only with a light field", "run the scene"});
  expect_error(work, {"encode", f, "-o", "h.png", "--quality", "best"}, {"--quality only in a run", "--iterations"});
  EXPECT_TRUE(work.run({"rnu", f, "-o", "x"}).err.starts_with("unknown command \"rnu\"; did you mean \"run\"?"));
  expect_error(work, {"show", h, "-o", "v.png", "--slm", "gaia"}, {"did you mean \"gaea\""});
  expect_error(work, {"trace", "scene.toml", "-o", "s.ply", "--field-of-view", "3"}, {"--field-of-view:", "unit"});
  expect_error(work, {"trace", "scene.toml", "-o", "s.ply", "--paths", "many"}, {"--paths:", "whole number"});
  expect_error(work, {"limits", "--wavelength", "633"}, {"--wavelength:", "unit"});
  expect_error(work, {"limits", "--wavelength", "-633 nm"}, {"wavelength", "above 0"});
  expect_error(work, {"limits", "--size", "100 mm"}, {"--size", "--angle"});
  expect_error(work, {"limits", "--angle", "15"}, {"--angle:", "unit", "15"});
  expect_error(work, {"limits", "--period", "16"}, {"--period:", "unit", "16"});
}

TEST(BadInput, FlagsThatWouldBeIgnoredAreRefused) {
  const Workplace work;
  work.write("scene.toml", mesh_scene());
  const std::vector<std::string> field{"field", "scene.toml", "-o", "f.npy", "--double"};
  const auto with = [](std::vector<std::string> arguments, const std::vector<std::string>& more) {
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  };
  expect_error(work, with(field, {"--method", "tiled"}), {"--double", "methods exact", "leave out --method tiled"});
  expect_error(work, with(field, {"--tolerance", "1e-2"}), {"--double", "leave out --tolerance"});
  expect_error(work, with(field, {"--method", "planes"}), {"--double", "leave out --method planes"});
  const std::vector<std::string> single{"field", "scene.toml", "-o", "f.npy"};
  expect_error(work, with(single, {"--silhouettes", "true"}), {"--silhouettes", "--method layers", "auto"});
  expect_error(work, with(single, {"--shading", "flat", "--method", "tiled"}), {"--shading", "--method triangles"});
  expect_error(work, with(single, {"--slices", "-1"}), {"--slices", "0", "-1"});
  const std::vector<std::string> angle{"limits", "--angle", "15 deg"};
  expect_error(work, with(angle, {"--period", "16 um"}), {"--angle", "--period"});
  expect_error(work, with(angle, {"--order", "2"}), {"--angle", "--order"});
  expect_error(work, with(angle, {"--slm", "pluto"}), {"--angle", "--slm"});
  expect_error(work, with(angle, {"--distance", "1 m"}), {"--angle", "--distance"});
  expect_error(work, with(angle, {"--frames", "30"}), {"--frames", "--size"});
  expect_error(work, {"limits", "--order", "2"}, {"--order", "--period"});
  expect_error(work, {"limits", "--colours", "3"}, {"--colours", "--frames"});
  expect_error(work, {"limits", "--frames", "-30"}, {"--frames", "above 0", "-30"});
  expect_error(work, {"limits", "--frames", "30", "--colours", "0"}, {"--colours", "1 or more", "0"});
}

TEST(BadInput, AFieldIsNotComparedWithAnImage) {
  const Workplace work;
  work.write("scene.toml", mesh_scene());
  for (const char* name : {"f.npy", "f.exr"}) ASSERT_EQ(work.run({"field", "scene.toml", "-o", name}).exit_code, 0);
  ASSERT_EQ(work.run({"render", "scene.toml", "-o", "r.exr"}).exit_code, 0);
  expect_error(work, {"compare", "f.exr", "r.exr"}, {"two images or two fields", "field f.exr", "image r.exr"});
  expect_error(work, {"compare", "r.exr", "f.npy"}, {"two images or two fields", "image r.exr", "field f.npy"});
}

TEST(BadInput, WhatAFileIsDecidesTheMessage) {
  const Workplace work;
  work.write("scene.toml", mesh_scene());
  ASSERT_EQ(work.run({"render", "scene.toml", "-o", "r.png"}).exit_code, 0);
  ASSERT_EQ(work.run({"trace", "scene.toml", "-o", "s.ply"}).exit_code, 0);
  ASSERT_EQ(work.run({"field", "s.ply", "-o", "f.npy"}).exit_code, 0);
  expect_error(work, {"run", "r.png", "-o", "out"}, {"r.png", "a PNG, a picture", "holotrace encode"});
  expect_error(work, {"run", "f.npy", "-o", "out"}, {"f.npy", "a field in NPY", "holotrace propagate"});
  expect_error(work, {"run", "s.ply", "-o", "out"}, {"s.ply", "sources of waves", "holotrace field"});
  expect_error(work, {"propagate", "scene.toml", "--distance", "1 mm", "-o", "g.npy"},
               {"scene.toml", "a field .npy, .h5, .mat or .exr", "a scene or panel file", "holotrace run"});
}

TEST(BadInput, FilesOutsideAModelsFolderNeedAFlag) {
  const Workplace work;
  std::filesystem::create_directory(work.path("models"));
  work.write("out.mtl", "newmtl a\nKd 1 1 1\n");
  work.write("models/m.obj", "mtllib ../out.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  work.write("scene.toml", scene_head() + "[[object]]\ntype = \"mesh\"\nfile = \"models/m.obj\"\n" +
                               "position = \"0 0 -30 mm\"\nscale = 0.001\n");
  for (const std::vector<std::string>& command : {std::vector<std::string>{"info", "models/m.obj"},
                                                  {"info", "scene.toml"},
                                                  {"trace", "scene.toml", "-o", "s.ply"}}) {
    expect_error(work, command, {"models/m.obj: expected files in its own folder", "../out.mtl", "--allow-outside"});
    std::vector<std::string> allowed = command;
    allowed.emplace_back("--allow-outside");
    EXPECT_EQ(work.run(allowed).exit_code, 0) << command.back();
  }
}

}  // namespace
}  // namespace holotrace::test
