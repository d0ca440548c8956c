// Bad input on the command line: exit code 1, one helpful sentence on stderr, and no new file.

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "end_to_end/expect_error.h"
#include "end_to_end/scenes.h"
#include "holotrace/io/field/field_file.h"
#include "support/program.h"

namespace holotrace::test {
namespace {

// A correct scene except for `line`, which replaces `instead_of`.
std::string scene_with(const std::string& instead_of, const std::string& line) {
  std::string scene = mesh_scene();
  const size_t at = scene.find(instead_of);
  EXPECT_NE(at, std::string::npos) << instead_of;
  return scene.replace(at, instead_of.size(), line);
}

struct BadScene {
  std::string instead_of, line;
  Words words;
};

void expect_scene_errors(const std::vector<BadScene>& cases) {
  const Workplace work;
  for (const BadScene& bad : cases) {
    work.write("scene.toml", scene_with(bad.instead_of, bad.line));
    expect_error(work, {"run", "scene.toml", "-o", "out"}, bad.words);
  }
}

TEST(BadInput, MissingFilesAreNamed) {
  const Workplace work;
  expect_error(work, {"run", "none.toml", "-o", "out"}, {"none.toml", "no such file"});
  expect_error(work, {"render", "none.toml", "-o", "x.png"}, {"none.toml", "no such file"});
  expect_error(work, {"trace", "none.toml", "-o", "x.ply"}, {"none.toml", "no such file"});
  expect_error(work, {"field", "none.toml", "-o", "x.npy"}, {"none.toml", "no such file"});
  expect_error(work, {"field", "none.ply", "-o", "x.npy"}, {"none.ply", "no such file"});
  expect_error(work, {"encode", "none.npy", "-o", "x.png"}, {"none.npy", "no such file"});
  expect_error(work, {"show", "none.png", "-o", "x.png"}, {"none.png", "no such file"});
  expect_error(work, {"propagate", "none.npy", "--distance", "1 mm", "-o", "x.npy"}, {"none.npy", "no such file"});
  expect_error(work, {"compare", "none.png", "none.png"}, {"none.png", "no such file"});
  expect_error(work, {"estimate", "none.toml"}, {"none.toml", "no such file"});
  expect_error(work, {"info", "none"}, {"none", "no such file"});
}

TEST(BadInput, BrokenTomlIsPlacedByLineAndColumn) {
  const Workplace work;
  work.write("scene.toml", "wavelength = \"532 nm\"\n[slm\ncolumns = 3\n");
  expect_error(work, {"run", "scene.toml", "-o", "out"}, {"scene.toml:2:5: expected a table"});
  work.write("scene.toml", "wavelength = = 3\n");
  expect_error(work, {"run", "scene.toml", "-o", "out"}, {"scene.toml:1:14: expected a value"});  // the second =
  work.write("scene.toml", "");
  expect_error(work, {"run", "scene.toml", "-o", "out"}, {"scene.toml", "at least one object"});
  work.write("scene.toml", std::string("\xff\xfe\x00\x01", 4));
  expect_error(work, {"run", "scene.toml", "-o", "out"}, {"scene.toml: expected text in UTF-8, got UTF-16"});
}

TEST(BadInput, UnknownKeysSuggestTheNearestAndTellTheirPlace) {
  expect_scene_errors({
      {"pitch =", "pich =", {"scene.toml:6:1", "pich", "did you mean \"pitch\""}},
      {"paths = 4\n", "path = 4\n", {"scene.toml:10:1", "did you mean \"paths\""}},
      {"intensity = 1e-3", "intensty = 1e-3", {"did you mean \"intensity\""}},
      {"type = \"sphere\"", "type = \"spere\"", {"did you mean \"sphere\""}},
      {"[camera]", "[camra]", {"did you mean \"camera\""}},
      {"pitch = \"8 um\"", "preset = \"plutto\"", {"did you mean \"pluto\""}},
      {"[trace]\n", "[trace]\nphase = \"randum\"\n", {"did you mean \"random\""}},
  });
}

TEST(BadInput, LengthsWithoutAUnitAreRefused) {
  expect_scene_errors({
      {"\"8 um\"", "\"8\"", {"scene.toml:6:", "unit", "\"8\"", "pitch"}},
      {"\"8 um\"", "8", {"scene.toml:6:", "unit", "pitch"}},
      {"\"8 um\"", "\"8 furlong\"", {"scene.toml:6:", "nm", "furlong"}},
      {"\"532 nm\"", "532e-9", {"scene.toml:1:", "unit", "wavelength"}},
      {"\"0.3 0.1 -30 mm\"", "\"0.3 0.1 -30\"", {"unit", "position"}},
  });
}

TEST(BadInput, NumbersThatAreNotFiniteOrOutOfRangeAreRefused) {
  expect_scene_errors({
      {"intensity = 1e-3", "intensity = nan", {"intensity", "nan"}},
      {"intensity = 1e-3", "intensity = inf", {"intensity", "inf"}},
      {"intensity = 1e-3", "intensity = -1", {"intensity", "-1"}},
      {"\"0.8 mm\"", "\"nan mm\"", {"finite", "nan", "size"}},
      {"\"0.8 mm\"", "\"1e400 mm\"", {"1e400", "size"}},
      {"\"532 nm\"", "\"0 nm\"", {"wavelength", "above 0"}},
      {"\"532 nm\"", "\"-532 nm\"", {"wavelength", "-532"}},
      {"\"8 um\"", "\"-8 um\"", {"pitch", "-8"}},
      {"\"8 um\"", "\"0 um\"", {"pitch", "above 0"}},
      {"columns = 256", "columns = 0", {"1 or more", "columns", "got 0"}},
      {"columns = 256", "columns = -5", {"columns", "-5"}},
      {"columns = 256", "columns = 25.5", {"whole number", "25.5"}},
      {"paths = 4", "paths = 0", {"paths", "1 or more"}},
      {"rows = 64", "rows = 0", {"rows", "1 or more"}},
      {"distances = \"30 mm\"", "bits = 12", {"bits", "8 or 16", "scene.toml:15:"}},
      {"background = 0.1", "background = -0.1", {"background", "-0.1"}},
  });
}

TEST(BadInput, PointsOnThePanelAreRefused) {
  const Workplace work;
  work.write("points.ply", point_file({{{0, 0, -0.1}}, {{0, 0, 0}}}));
  work.write("scene.toml", scene_head() + points_object());
  expect_error(work, {"run", "scene.toml", "-o", "out"}, {"behind the panel", "in front of it", "z = 0 m"});
}

TEST(BadInput, AnEmptySceneIsRefused) {
  const Workplace work;
  work.write("scene.toml", scene_head());
  expect_error(work, {"run", "scene.toml", "-o", "out"}, {"at least one object"});
}

TEST(BadInput, DamagedMeshesAreRefused) {
  const Workplace work;
  const auto expect = [&](const std::string& file, const std::string& bytes, const Words& words) {
    work.write(file, bytes);
    work.write("scene.toml", scene_head() + "[[object]]\ntype = \"mesh\"\nfile = \"" + file +
                                 "\"\nposition = \"0 0 -30 mm\"\nscale = 0.001\n");
    expect_error(work, {"run", "scene.toml", "-o", "out"}, words);
  };
  expect("empty.obj", "", {"empty.obj"});
  expect("points.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n", {"points.obj"});
  expect("range.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n", {"range.obj"});
  expect("nan.obj", "v 0 0 nan\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", {"nan.obj"});
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n";
  expect("range.ply", ply + "3 0 1 7\n", {"range.ply"});
  expect("negative.ply", ply + "3 0 1 -1\n", {"negative.ply"});
  expect("short.ply", ply, {"short.ply"});
  expect("mesh.step", "ISO-10303-21;\n", {"mesh.step", ".obj", "a STEP file"});
  expect("mesh.stl", "solid\nendsolid\n", {"mesh.stl", "expected a mesh"});
  expect("broken.gltf", "{ \"asset\": ", {"broken.gltf"});
  work.write("scene.toml", scene_head() + "[[object]]\ntype = \"mesh\"\nfile = \"no.obj\"\nposition = \"0 0 -1 mm\"\n");
  expect_error(work, {"run", "scene.toml", "-o", "out"}, {"scene.toml:8:", "no.obj", "no such file"});
}

TEST(BadInput, FilesThatAreNotImagesAreRefused) {
  const Workplace work;
  work.write("no.png", "this is text\n");
  expect_error(work, {"show", "no.png", "-o", "x.png"}, {"no.png", "not an image"});
  expect_error(work, {"compare", "no.png", "no.png"}, {"no.png", "not an image"});
  work.write("scene.toml", scene_with("[[light]]", "[materials.m]\ntexture = \"no.png\"\n[[light]]"));
  expect_error(work, {"run", "scene.toml", "-o", "out"}, {"scene.toml:", "no.png", "not an image"});
}

TEST(BadInput, ImpossibleMaterialsArePlaced) {
  const auto material = [](const std::string& lines) { return "[materials.m]\n" + lines + "\n[[light]]"; };
  expect_scene_errors({
      {"[[light]]",
       material("type = \"glas\""),
       {"scene.toml:17:8", "unknown material type \"glas\"", "known: diffuse"}},
      {"[[light]]", material("type = \"dielectrick\""), {"scene.toml:17:8", "did you mean \"dielectric\""}},
      {"[[light]]", material("type = \"conductor\"\nmetal = \"Unobtainium\""), {"scene.toml:18:9", "metal", "known: "}},
      {"[[light]]", material("type = \"dielectric\"\nglass = \"BK77\""), {"scene.toml:18:9", "did you mean \"BK7\""}},
      {"[[light]]", material("type = \"conductor\"\nroughness = 2"), {"scene.toml:18:13", "from 0 to 1", "got 2"}},
      {"[[light]]", material("texture = \"no.png\""), {"scene.toml:17:11", "no.png", "no such file"}},
      {"[[light]]", material("normal_map = \"no.png\""), {"scene.toml:17:14", "no.png", "no such file"}},
      {"[[light]]", material("emission = nan"), {"scene.toml:17:12", "emission", "nan"}},
      {"[[light]]", material("reflectance = 0.9\ntransmittance = 0.9"), {"scene.toml:18:17", "at most 1", "1.8"}},
  });
}

TEST(BadInput, LightsThatPointNowhereArePlaced) {
  const auto light = [](const std::string& lines) { return "[[light]]\n" + lines + "\n[[light]]"; };
  const std::string sun = "type = \"directional\"\nirradiance = 1\n";
  expect_scene_errors({
      {"[[light]]", light(sun + "direction = [0, 0, 0]"), {"scene.toml:19:13", "points nowhere"}},
      {"[[light]]", light(sun + "direction = \"down\""), {"scene.toml:19:13", "[x, y, z]", "down"}},
      {"[[light]]", light(sun), {"scene.toml:16:1", "direction", "missing"}},
      {"[[light]]", light("type = \"laser\""), {"scene.toml:17:8", "unknown light type \"laser\""}},
  });
}

TEST(BadInput, InvalidEnvironmentMapsAreNamed) {
  const Workplace work;
  work.write("text.exr", "this is text\n");
  const auto scene = [&](const std::string& map) {
    work.write("scene.toml", scene_with("[[light]]", "[environment]\nmap = \"" + map + "\"\n[[light]]"));
  };
  scene("text.exr");
  expect_error(work, {"run", "scene.toml", "-o", "out"}, {"scene.toml:17:7", "text.exr", "not an image"});
  scene("none.exr");
  expect_error(work, {"run", "scene.toml", "-o", "out"}, {"scene.toml:17:7", "none.exr", "no such file"});
  work.write("plain.toml", mesh_scene());
  ASSERT_EQ(work.run({"render", "plain.toml", "-o", "square.png", "--rows", "8", "--columns", "8"}).exit_code, 0);
  scene("square.png");
  expect_error(work, {"run", "scene.toml", "-o", "out"},
               {"scene.toml:17:7", "square.png", "environment map", "twice as wide as high", "8 × 8"});
}

TEST(BadInput, WrongWavelengthListsArePlaced) {
  expect_scene_errors({
      {"\"532 nm\"", "[]", {"scene.toml:1:14", "one length or more"}},
      {"\"532 nm\"", "[\"532 nm\", \"532 nm\"]", {"scene.toml:1:14", "each wavelength once", "532 nm twice"}},
      {"\"532 nm\"", "[\"638 nm\", 532]", {"scene.toml:1:25", "unit", "532"}},
      {"\"532 nm\"", "\"638 532 parsecs\"", {"scene.toml:1:14", "wavelength", "parsecs"}},
  });
}

TEST(BadInput, DamagedModelsAreRefusedAlone) {
  const Workplace work;
  expect_error(work, {"run", "none.glb", "-o", "out"}, {"none.glb", "a model", "no such file"});
  work.write("broken.glb", "glTF");
  expect_error(work, {"run", "broken.glb", "-o", "out"}, {"broken.glb", "truncated", "export it again"});
  work.write("old.gltf", R"({"asset": {"version": "1.0"}})");
  expect_error(work, {"render", "old.gltf", "-o", "x.png"}, {"old.gltf", "version 2", "1.0"});
  work.write("needs.gltf", R"({"asset": {"version": "2.0"}, "extensionsRequired": ["EXT_unheard_of"]})");
  expect_error(work, {"render", "needs.gltf", "-o", "x.png"}, {"needs.gltf", "EXT_unheard_of", "export it without"});
}

TEST(BadInput, ATruncatedImageIsRefused) {
  const Workplace work;
  work.write("scene.toml", mesh_scene());
  ASSERT_EQ(work.run({"run", "scene.toml", "-o", "out"}).exit_code, 0);
  const std::string whole = work.read("out/hologram.png");
  work.write("out/hologram.png", whole.substr(0, whole.size() / 2));
  expect_error(work, {"show", "out/hologram.png", "-o", "x.png", "--distance", "30 mm"}, {"hologram.png", "truncated"});
}

TEST(BadInput, APanelTooLargeForMemorySaysItsNeedBeforeAnythingIsDone) {
  const Workplace work;
  work.write("points.ply", point_file({{{0, 0, -0.1}}}));
  work.write("scene.toml", scene_head({2000000, 2000000, 8e-6}) + points_object());
  // 4e12 samples of 8 bytes are 29.1 TiB.
  expect_error(work, {"run", "scene.toml", "-o", "out"}, {"2000000 × 2000000", "29.1 TiB", "memory"});
  expect_error(work, {"field", "scene.toml", "-o", "f.npy"}, {"2000000 × 2000000", "29.1 TiB", "memory"});
  expect_error(work, {"field", "scene.toml", "-o", "f.npy", "--double"}, {"2000000 × 2000000", "58.2 TiB", "memory"});
  expect_error(work, {"estimate", "scene.toml"}, {"2000000 × 2000000", "29.1 TiB", "memory"});
  work.write("scene.toml", mesh_scene());
  expect_error(work, {"render", "scene.toml", "-o", "r.png", "--rows", "1000000"}, {"memory", "TiB"});
  expect_error(work, {"trace", "scene.toml", "-o", "s.ply", "--columns", "2000000000", "--rows", "2000000000"},
               {"memory", "TiB"});
}

TEST(BadInput, OutputsThatCannotBeWrittenAreRefusedBeforeTheWork) {
  const Workplace work;
  work.write("scene.toml", mesh_scene());
  work.write("file", "in the way");
  expect_error(work, {"field", "scene.toml", "-o", "missing/f.npy"}, {"missing", "does not exist"});
  expect_error(work, {"trace", "scene.toml", "-o", "missing/s.ply"}, {"missing", "does not exist"});
  expect_error(work, {"render", "scene.toml", "-o", "missing/r.png"}, {"missing", "does not exist"});
  expect_error(work, {"run", "scene.toml", "-o", "file"}, {"file", "choose another place"});
  expect_error(work, {"run", "scene.toml", "-o", "file/out"}, {"file/out"});
  expect_error(work, {"field", "scene.toml", "-o", "file/f.npy"}, {"file"});
  // Not even root can make a file in /proc, so this also holds in containers.
  expect_error(work, {"field", "scene.toml", "-o", "/proc/f.npy"}, {"/proc/f.npy"});
  expect_error(work, {"run", "scene.toml", "-o", "/proc/holotrace"}, {"/proc/holotrace"});
}

TEST(BadInput, AFolderWithoutPermissionIsRefused) {
  if (geteuid() == 0) GTEST_SKIP() << "root may write everywhere";
  const Workplace work;
  work.write("scene.toml", mesh_scene());
  std::filesystem::create_directory(work.path("locked"));
  std::filesystem::permissions(work.path("locked"),
                               std::filesystem::perms::owner_read | std::filesystem::perms::owner_exec);
  expect_error(work, {"field", "scene.toml", "-o", "locked/f.npy"}, {"locked", "not writable"});
}

TEST(BadInput, OutputsOfAnUnknownFormatAreRefusedBeforeTheWork) {
  const Workplace work;
  work.write("scene.toml", mesh_scene());
  expect_error(work, {"field", "scene.toml", "-o", "f.txt"}, {".npy or .h5 or .exr", "f.txt"});
  expect_error(work, {"field", "scene.toml", "-o", "f.exr", "--double"}, {".npy or .h5", "f.exr"});
  expect_error(work, {"trace", "scene.toml", "-o", "s.npy"}, {".ply", "s.npy"});
  expect_error(work, {"render", "scene.toml", "-o", "r.gif"}, {".png or .jpg or .jpeg or .exr", "r.gif"});
  expect_error(work, {"render", "scene.toml", "-o", "r"}, {".png or .jpg or .jpeg or .exr"});
}

// A complex64 field file made without holotrace, so that it can be invalid.
void write_field(const Workplace& work, const std::string& name, int ny, int nx, std::complex<float> middle = 1.0F,
                 const std::string& sidecar = "{\"pitch_m\": 8e-6, \"wavelengths_m\": [532e-9]}") {
  std::string header = fmt::format("{{'descr': '<c8', 'fortran_order': False, 'shape': ({}, {}), }}", ny, nx);
  header.resize(117, ' ');  // 128 = 10 bytes of preamble, this, and the newline
  header += '\n';
  std::string bytes("\x93NUMPY\x01\x00\x76\x00", 10);  // 0x76 = 118
  bytes += header;
  std::vector<std::complex<float>> samples(size_t(ny) * size_t(nx), 1.0F);
  samples[samples.size() / 2] = middle;
  bytes.append(reinterpret_cast<const char*>(samples.data()), samples.size() * sizeof samples[0]);
  work.write(name + ".npy", bytes);
  work.write(name + ".npy.json", sidecar);
}

TEST(BadInput, DistancesThatNoMethodCanSampleSayWhatWould) {
  const Workplace work;
  write_field(work, "f", 16, 1920);
  expect_error(work, {"propagate", "f.npy", "--distance", "300 mm", "-o", "g.npy"},
               {"no method", "300 mm", "in y", "or wider", "or finer"});
  // The remedy in the message works: 1.6 mm are the 200 rows of √(16λz) = 1.598 mm.
  write_field(work, "f", 200, 1920);
  EXPECT_EQ(work.run({"propagate", "f.npy", "--distance", "300 mm", "-o", "g.npy"}).exit_code, 0);
}

TEST(BadInput, DamagedFieldsAreRefused) {
  const Workplace work;
  const auto expect = [&](const Words& words) { expect_error(work, {"encode", "f.npy", "-o", "h.png"}, words); };
  write_field(work, "f", 8, 8, {std::numeric_limits<float>::quiet_NaN(), 0});
  expect({"f.npy", "nan", "row 4, column 0"});  // sample 32 of 8 × 8
  expect_error(work, {"propagate", "f.npy", "--distance", "1 mm", "-o", "g.npy"}, {"f.npy", "nan", "row 4, column 0"});
  write_field(work, "f", 8, 8, {0, std::numeric_limits<float>::infinity()});
  expect({"f.npy", "inf", "row 4, column 0"});
  write_field(work, "f", 8, 8);
  const std::string whole = work.read("f.npy");
  for (const size_t length : {size_t(0), size_t(5), size_t(60), whole.size() - 1}) {
    work.write("f.npy", whole.substr(0, length));
    expect({"f.npy"});
  }
  work.write("f.npy", whole + "x");
  expect({"f.npy", "513"});  // 8·8·8 bytes and one more
  write_field(work, "f", 8, 8, 1.0F, "{\"wavelengths_m\": [532e-9]}");
  expect({"f.npy.json", "pitch_m", "missing"});
  write_field(work, "f", 8, 8, 1.0F, "{\"pitch_m\": -8e-6, \"wavelengths_m\": [532e-9]}");
  expect({"pitch", "-8e-06"});
  write_field(work, "f", 8, 8, 1.0F, "{\"pitch_m\": 8e-6, ");
  expect({"f.npy.json:1", "JSON"});
  std::filesystem::remove(work.path("f.npy.json"));
  expect({"f.npy.json", "no such file"});
}

// Names in files reach no terminal as they are: they could move the cursor or hide what follows.
TEST(BadInput, ControlCharactersInNamesAreEscaped) {
  const Workplace work;
  work.write("m.gltf", "{\"asset\": {\"version\": \"2.0\"}, \"extensionsRequired\": [\"\\u001b[2Jx\"]}");
  expect_error(work, {"info", "m.gltf"}, {"\\x1b[2Jx"});
  work.write("scene.toml", scene_with("type = \"sphere\"", "type = \"\\u001b[31msphere\""));
  expect_error(work, {"run", "scene.toml", "-o", "out"}, {"unknown object type \"\\x1b[31msphere\""});
}

}  // namespace
}  // namespace holotrace::test
