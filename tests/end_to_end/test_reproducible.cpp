// The same input and seed give the same bytes, on any number of threads, in the first run on a machine and later. These and all
// other tests that compare bytes compare results of one processor; tests/compare_processors.py compares those of two, by
// tolerance. Across processors only integers hold exactly: random numbers (test_random.cpp) and files of given content.

#include <gtest/gtest.h>

#include "end_to_end/scenes.h"
#include "holotrace/io/field/field_file.h"
#include "holotrace/io/picture/image_file.h"
#include "support/fields.h"
#include "support/program.h"

namespace holotrace::test {
namespace {

const std::vector<std::string> outputs{"render.png",     "sources.ply",  "field.npy",
                                       "field.npy.json", "hologram.png", "view.png"};  // all but the report's times

TEST(Reproducible, TheSameBytesComeFromOneTwoAndSevenThreads) {
  const Workplace work;
  work.write("scene.toml", mesh_scene());
  for (const std::string threads : {"1", "2", "7"})  // fewer, as many, and more than the cores of a small machine
    expect_success(work, {"run", "scene.toml", "-o", "out" + threads, "--threads", threads});
  for (const std::string& name : outputs) {
    EXPECT_TRUE(work.read("out1/" + name) == work.read("out2/" + name)) << name;
    EXPECT_TRUE(work.read("out1/" + name) == work.read("out7/" + name)) << name;
  }
}

// Nothing that a run measures or keeps changes how a later one rounds.
TEST(Reproducible, TheFirstRunOnAMachineGivesTheBytesOfTheNext) {
  const Workplace work;
  work.write("scene.toml", mesh_scene());
  expect_success(work, {"field", "scene.toml", "-o", "f.npy"});
  for (const std::string name : {"g1.npy", "g2.npy", "g3.npy"}) {
    if (name != "g3.npy") work.clear_cache();
    expect_success(work, {"propagate", "f.npy", "--distance", "30 mm", "-o", name, "--threads", "3"});
  }
  EXPECT_TRUE(work.read("g1.npy") == work.read("g2.npy"));
  EXPECT_TRUE(work.read("g1.npy") == work.read("g3.npy"));
}

TEST(Reproducible, TheSameSeedGivesTheSameBytesAndAnotherSeedOthers) {
  const Workplace work;
  work.write("scene.toml", mesh_scene());
  expect_success(work, {"trace", "scene.toml", "-o", "one.ply", "--seed", "1"});
  expect_success(work, {"trace", "scene.toml", "-o", "again.ply", "--seed", "1"});
  expect_success(work, {"trace", "scene.toml", "-o", "two.ply", "--seed", "2"});
  EXPECT_TRUE(work.read("one.ply") == work.read("again.ply"));
  EXPECT_FALSE(work.read("one.ply") == work.read("two.ply"));
  expect_success(work, {"render", "scene.toml", "-o", "one.exr", "--seed", "1"});
  expect_success(work, {"render", "scene.toml", "-o", "again.exr", "--seed", "1"});
  expect_success(work, {"render", "scene.toml", "-o", "two.exr", "--seed", "2"});
  EXPECT_TRUE(work.read("one.exr") == work.read("again.exr"));
  EXPECT_FALSE(work.read("one.exr") == work.read("two.exr"));
}

TEST(Reproducible, TheSeedOfASceneReachesEveryStageOfARun) {
  const Workplace work;
  std::string scene = mesh_scene();
  work.write("one.toml", scene);
  scene.replace(scene.find("[trace]\n"), 8, "[trace]\nseed = 2\n");
  work.write("two.toml", scene);
  expect_success(work, {"run", "one.toml", "-o", "one"});
  expect_success(work, {"run", "two.toml", "-o", "two"});
  for (const std::string name : {"sources.ply", "field.npy", "hologram.png", "view.png"})
    EXPECT_FALSE(work.read("one/" + name) == work.read("two/" + name)) << name;
}

TEST(Reproducible, TheSeedOnTheCommandLineIsThatOfTracingAndOfRendering) {
  const Workplace work;
  std::string scene = mesh_scene();
  work.write("scene.toml", scene);
  for (const std::string table : {"[trace]\n", "[render]\n"}) {
    ASSERT_NE(scene.find(table), std::string::npos);
    scene.insert(scene.find(table) + table.size(), "seed = 3\n");
  }
  work.write("seeded.toml", scene);
  expect_success(work, {"run", "scene.toml", "-o", "flag", "--seed", "3"});
  expect_success(work, {"run", "seeded.toml", "-o", "file"});
  for (const std::string& name : outputs) EXPECT_TRUE(work.read("flag/" + name) == work.read("file/" + name)) << name;
}

TEST(Reproducible, ARunOverAnOlderOneReplacesIt) {
  const Workplace work;
  work.write("scene.toml", mesh_scene());
  expect_success(work, {"run", "scene.toml", "-o", "fresh"});
  work.write("old/field.npy", "no field at all");
  work.write("old/view.png", "no image at all");
  expect_success(work, {"run", "scene.toml", "-o", "old"});
  for (const std::string& name : outputs) EXPECT_TRUE(work.read("fresh/" + name) == work.read("old/" + name)) << name;
}

// Every kind of material and light, three wavelengths, two path groups, two frames.
std::string everything() {
  return "wavelength = [\"638 nm\", \"532 nm\", \"450 nm\"]\n" +
         scene_head(small_panel).substr(scene_head(small_panel).find('[')) +
         "[trace]\nstrategy = \"tiled\"\npattern = \"random\"\nphase = \"path\"\nsamples = 1500\npaths = 3\n"
         "tile_columns = 3\ntile_rows = 2\nmax_depth = 6\npath_expressions = [\"EL\", \"E(D|G|S).*L\"]\n"
         "separate_path_groups = true\nframes = 2\n"
         "[render]\nrows = 48\npaths = 4\nlens = \"panel\"\n"
         "[camera]\ndistances = \"30 mm\"\n"
         "[environment]\nmap = \"sky.exr\"\n"
         "[materials.glass]\ntype = \"dielectric\"\nglass = \"BK7\"\n"
         "[materials.mirror]\ntype = \"conductor\"\n"
         "[materials.paint]\ntype = \"metallic-roughness\"\nbase_color = [0.8, 0.3, 0.2]\nmetallic = 0\n"
         "roughness = 0.4\n"
         "[materials.lamp]\nemission = [3, 2, 1]\n"
         "[[light]]\ntype = \"point\"\nposition = \"1 2 -20 mm\"\nintensity = 1e-3\n"
         "[[light]]\ntype = \"rectangle\"\ncorner = \"-2 2 -31 mm\"\nedge_u = \"4 0 0 mm\"\nedge_v = \"0 0 4 mm\"\n"
         "radiance = 2\n"
         "[[object]]\ntype = \"sphere\"\nsize = \"0.8 mm\"\nmaterial = \"glass\"\nposition = \"0.4 0 -29 mm\"\n"
         "[[object]]\ntype = \"sphere\"\nsize = \"0.6 mm\"\nmaterial = \"paint\"\nposition = \"-0.5 0.3 -30 mm\"\n"
         "[[object]]\ntype = \"box\"\nsize = \"0.3 0.3 0.3 mm\"\nmaterial = \"lamp\"\nposition = \"-0.3 -0.4 -30 mm\"\n"
         "[[object]]\ntype = \"quad\"\nwidth = \"1 mm\"\nheight = \"2 mm\"\nmaterial = \"mirror\"\n"
         "rotation = \"y 40 deg\"\nposition = \"-0.9 0 -31 mm\"\n"
         "[[object]]\ntype = \"quad\"\nwidth = \"4 mm\"\nheight = \"4 mm\"\nposition = \"0 0 -33 mm\"\n";
}

TEST(Reproducible, ASceneWithEverythingGivesTheSameBytesOnAnyNumberOfThreadsAndAgain) {
  const Workplace work;
  Image sky(8, 16, 3);  // a bright window in a dim room
  for (size_t i = 0; i < sky.values.size(); ++i) sky.values[i] = i % 16 < 3 ? 5.0F : 0.1F;
  save_image(work.path("sky.exr"), sky, 1, 8);
  work.write("scene.toml", everything());
  for (const std::string threads : {"1", "2", "7"})
    expect_success(work, {"run", "scene.toml", "-o", "out" + threads, "--threads", threads});
  expect_success(work, {"run", "scene.toml", "-o", "again", "--threads", "7"});
  int files = 0;
  for (const std::string& name : work.names()) {
    if (name.rfind("out1/", 0) != 0 || name == "out1/report.json") continue;  // it has times
    const std::string part = name.substr(5);
    for (const char* other : {"out2/", "out7/", "again/"})
      EXPECT_TRUE(work.read(name) == work.read(other + part)) << other << part;
    ++files;
  }
  EXPECT_GE(files, 12 + 6) << "2 frames of 3 colours in 2 layers are 12 holograms; sources and fields beside them";
}

}  // namespace
}  // namespace holotrace::test
