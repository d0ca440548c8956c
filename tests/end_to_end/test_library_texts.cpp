// Damaged files of every kind, given to every command that takes them: the answer is in our words, not in a library's.

#include <gtest/gtest.h>

#include <algorithm>
#include <regex>
#include <string>
#include <vector>

#include "end_to_end/scenes.h"
#include "support/program.h"

namespace holotrace::test {
namespace {

// Words of nlohmann-json, toml++, HDF5, Assimp, the standard library and CLI11.
const std::regex library_text(
    "json[.]exception|basic_string|std::|vector::|number overflow|H5[A-Z]_|HDF5-DIAG|Assimp|stoi|stod|map::at|bad_alloc|"
    "terminate|Error while parsing|while parsing|value-terminator|saw EOF|end-of-file|Encountered|Could not convert|"
    "179769313486231",
    std::regex::icase);

// Every command that reads a file, with the file in its place.
std::vector<std::vector<std::string>> commands_with(const std::string& file) {
  return {{"info", file},
          {"info", "--slm", file},
          {"run", file, "-o", "run"},
          {"trace", file, "-o", "x.ply"},
          {"field", file, "-o", "x.npy"},
          {"field", "scene.toml", "--slm", file, "-o", "x.npy"},
          {"encode", file, "-o", "x.png"},
          {"show", file, "-o", "x.png", "--distance", "30 mm"},
          {"propagate", file, "--distance", "1 mm", "-o", "x.npy"},
          {"compare", file, "field.npy"},
          {"estimate", file},
          {"calibrate", "fit", file, "folder", "-o", "panel.toml"}};
}

void expect_our_words(const Workplace& work, const std::string& file) {
  for (const auto& command : commands_with(file)) {
    const Outcome outcome = work.run(command);
    const std::string what = command[0] + " " + file + ": " + outcome.err;
    EXPECT_EQ(outcome.exit_code, 1) << what;
    EXPECT_FALSE(std::regex_search(outcome.err, library_text)) << what;
    EXPECT_EQ(outcome.err.rfind("holotrace: ", 0), size_t(0)) << what;
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << what;  // one sentence
  }
}

class LibraryTexts : public ::testing::Test {
 protected:
  void SetUp() override {
    work.write("scene.toml", mesh_scene());
    ASSERT_EQ(work.run({"field", "scene.toml", "-o", "field.npy"}).exit_code, 0);
  }
  Workplace work;
};

TEST_F(LibraryTexts, AreNotShownForTexts) {
  work.write("key.toml", "wavelength = 1e400\n");
  work.write("open.toml", "wavelength = \"532 nm\n");
  work.write("bytes.toml", std::string("a = \"\xff\xfe\x80\"\n"));
  for (const char* file : {"key.toml", "open.toml", "bytes.toml"}) expect_our_words(work, file);
}

TEST_F(LibraryTexts, AreNotShownForModels) {
  work.write("number.gltf", "{\"asset\": {\"version\": 1e400}}");
  work.write("open.gltf", "{\"asset\": {\"version\": \"2.0\"}, \"meshes\": [");
  work.write("open.ply", "ply\nformat ascii 1.0\nelement vertex 99999999999999999999\n");
  work.write("open.obj", "v 0 0\nf 1 2 99999999999999999999\n");
  for (const char* file : {"number.gltf", "open.gltf", "open.ply", "open.obj"}) expect_our_words(work, file);
}

TEST_F(LibraryTexts, AreNotShownForFields) {
  const std::string bytes = work.read("field.npy"), sidecar = work.read("field.npy.json");
  work.write("half.npy", bytes.substr(0, bytes.size() / 2));
  work.write("half.npy.json", sidecar);
  work.write("number.npy", bytes);
  work.write("number.npy.json", "{\"pitch_m\": 1e400}");
  work.write("open.npy", bytes);
  work.write("open.npy.json", "{\"pitch_m\": [8e-6, {");
  work.write("kind.npy", bytes);
  work.write("kind.npy.json", "{\"pitch_m\": \"8 um\", \"wavelengths_m\": 5}");
  for (const char* file : {"half.npy", "number.npy", "open.npy", "kind.npy"}) expect_our_words(work, file);
  ASSERT_EQ(work.run({"field", "scene.toml", "-o", "field.h5"}).exit_code, 0);
  const std::string hdf5 = work.read("field.h5");
  work.write("half.h5", hdf5.substr(0, hdf5.size() / 2));
  work.write("head.h5", hdf5.substr(0, 200));
  for (const char* file : {"half.h5", "head.h5"}) expect_our_words(work, file);
}

// A report that is damaged is as none: the pictures are compared as they are.
TEST_F(LibraryTexts, AreNotShownForReports) {
  ASSERT_EQ(work.run({"run", "scene.toml", "-o", "out"}).exit_code, 0);
  const std::string report = work.read("out/report.json");
  const size_t at = report.find("\"render_half_tangent\": ") + 23;
  for (const std::string& damaged :
       {report.substr(0, report.size() / 2), report.substr(0, at) + "1e400" + report.substr(report.find(',', at)),
        report.substr(0, at) + "\"a\"" + report.substr(report.find(',', at)),
        report.substr(0, at) + "-1" + report.substr(report.find(',', at)), std::string("[1, 2"), std::string("[1]")}) {
    work.write("out/report.json", damaged);
    const Outcome outcome = work.run({"compare", "out/render.png", "out/view.png"});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_EQ(outcome.out.find("by report.json"), std::string::npos) << outcome.out;
    EXPECT_FALSE(std::regex_search(outcome.err, library_text)) << outcome.err;
  }
}

}  // namespace
}  // namespace holotrace::test
