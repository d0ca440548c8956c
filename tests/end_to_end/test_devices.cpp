// Devices by the command line. scripts/setup installs PoCL, an OpenCL device that is a processor.

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "holotrace/io/field/field_file.h"
#include "holotrace/io/picture/image_file.h"
#include "support/build_paths.h"
#include "support/fields.h"
#include "support/program.h"

namespace holotrace::test {
namespace {

using Json = nlohmann::json;

constexpr const char* scene =
    "wavelength = \"532 nm\"\n[slm]\npreset = \"ideal\"\ncolumns = 200\nrows = 150\npitch = \"8 um\"\n"
    "[[object]]\ntype = \"wireframe_cube\"\nsize = \"0.5 mm\"\npoints_per_edge = 20\nposition = \"0 0 -50 mm\"\n";

// As on a machine whose loader of OpenCL finds no driver.
const std::vector<std::string> without_drivers{"env", "OCL_ICD_VENDORS=/nonexistent"};

class DevicesOfTheProgram : public ::testing::Test {
 protected:
  DevicesOfTheProgram() {
    work_.write("scene.toml", scene);
    const Outcome traced = work_.run({"trace", "scene.toml", "-o", "s.ply"});
    EXPECT_EQ(traced.exit_code, 0) << traced.err;
  }
  bool has_device() const {
    return Json::parse(work_.run({"info", "--devices", "--json"}).out).at("devices").size() > 1;
  }
  std::vector<std::string> field(const std::string& device, const std::string& name) const {
    return {"field", "s.ply", "--slm", "scene.toml", "--device", device, "-o", name};
  }
  Workplace work_;
};

TEST_F(DevicesOfTheProgram, AreListed) {
  const Outcome listed = work_.run({"info", "--devices"});
  EXPECT_EQ(listed.exit_code, 0) << listed.err;
  EXPECT_EQ(listed.out.rfind("cpu ", 0), 0U) << listed.out;
  const Json devices = Json::parse(work_.run({"info", "--devices", "--json"}).out).at("devices");
  EXPECT_EQ(devices.at(0).at("device"), "cpu");
  for (size_t i = 1; i < devices.size(); ++i) {
    EXPECT_EQ(devices.at(i).at("device"), i == 1 ? "opencl" : "opencl:" + std::to_string(i - 1));
    EXPECT_NE(listed.out.find(devices.at(i).at("name").get<std::string>()), std::string::npos) << listed.out;
  }
}

TEST_F(DevicesOfTheProgram, MakeTheSameFieldWithinTheToleranceWholeAndInBands) {
  if (!has_device()) GTEST_SKIP() << "no OpenCL device here";
  std::vector<Field> fields;
  for (const char* device : {"cpu", "opencl", "opencl:0"}) {
    const std::string name = std::string(device).substr(0, 6) + std::to_string(fields.size()) + ".npy";
    const Outcome made = work_.run(field(device, name));
    ASSERT_EQ(made.exit_code, 0) << made.err;
    fields.push_back(load_fields(work_.path(name)).front());
  }
  EXPECT_EQ(fields[1].samples.values, fields[2].samples.values);
  // Each is within 1e-3 of the exact field.
  EXPECT_LT(holotrace::test::relative_error(fields[1], fields[0]), 2e-3);
  EXPECT_NE(fields[1].samples.values, fields[0].samples.values) << "summed by the processor?";

  std::vector<std::string> in_bands = field("opencl", "bands.h5");
  in_bands.insert(in_bands.end(), {"--memory", "1 GB"});
  const Outcome made = work_.run(in_bands);
  ASSERT_EQ(made.exit_code, 0) << made.err;
  EXPECT_LT(holotrace::test::relative_error(load_fields(work_.path("bands.h5")).front(), fields[0]), 2e-3);
}

// Both round 32-bit floats in transforms of 400 samples: 3e-7 apart.
TEST_F(DevicesOfTheProgram, PropagateFields) {
  if (!has_device()) GTEST_SKIP() << "no OpenCL device here";
  ASSERT_EQ(work_.run(field("cpu", "f.npy")).exit_code, 0);
  for (const char* pitch : {"8 um", "5 um"}) {
    const auto propagated = [&](const char* device, const char* name) {
      const Outcome made =
          work_.run({"propagate", "f.npy", "--distance", "-50 mm", "--pitch", pitch, "--device", device, "-o", name});
      EXPECT_EQ(made.exit_code, 0) << made.err;
      return load_fields(work_.path(name)).front();
    };
    const Field here = propagated("cpu", "a.npy"), there = propagated("opencl", "b.npy");
    EXPECT_LT(holotrace::test::relative_error(there, here), 1e-6) << pitch;
    EXPECT_NE(there.samples.values, here.samples.values) << "by the processor?";
  }
  const Outcome refused =
      work_.run({"propagate", "f.npy", "--distance", "-50 mm", "--double", "--device", "opencl", "-o", "c.npy"});
  EXPECT_EQ(refused.exit_code, 1);
  EXPECT_NE(refused.err.find("use the device cpu, or leave out --double"), std::string::npos) << refused.err;
  EXPECT_EQ(work_.run({"propagate", "f.npy", "--distance", "-50 mm", "--double", "--device", "auto", "-o", "c.npy"})
                .exit_code,
            0);
}

// The panel and the propagations of `show` name the device in its report.
TEST_F(DevicesOfTheProgram, ShowHolograms) {
  if (!has_device()) GTEST_SKIP() << "no OpenCL device here";
  ASSERT_EQ(work_.run(field("cpu", "f.npy")).exit_code, 0);
  ASSERT_EQ(work_.run({"encode", "f.npy", "-o", "h.png"}).exit_code, 0);
  const Outcome made = work_.run(
      {"show", "h.png", "--distance", "50 mm", "--device", "opencl", "--report", "report.json", "-o", "view.png"});
  ASSERT_EQ(made.exit_code, 0) << made.err;
  const Json report = Json::parse(work_.read("report.json"));
  EXPECT_EQ(report.at("stages").at(0).at("stage"), "show");
  for (const Json& stage : report.at("stages")) EXPECT_TRUE(stage.contains("device")) << stage;
}

// The stages that show and propagate name the device in the report; the panel's levels do not depend on it.
TEST_F(DevicesOfTheProgram, PropagateTheLightOfHolograms) {
  if (!has_device()) GTEST_SKIP() << "no OpenCL device here";
  work_.write("on_device.toml", std::string(scene) + "[show]\ndevice = \"opencl\"\n[propagate]\ndevice = \"opencl\"\n");
  for (const char* name : {"scene", "on_device"}) {
    const Outcome made = work_.run({"run", std::string(name) + ".toml", "-o", name});
    ASSERT_EQ(made.exit_code, 0) << made.err;
  }
  EXPECT_EQ(work_.read("scene/hologram.png"), work_.read("on_device/hologram.png"));
  const std::string report = work_.read("on_device/report.json");
  EXPECT_NE(report.find("\"device\": \""), std::string::npos) << report;
  const Json stages = Json::parse(report).at("stages");
  for (const Json& stage : stages)
    if (stage.at("stage") == "show") {
      EXPECT_TRUE(stage.contains("device")) << stage;
    }
  EXPECT_EQ(work_.read("scene/report.json").find("\"device\": \""), std::string::npos);
  std::vector<Image> views;
  for (const char* device : {"cpu", "opencl"}) {
    const std::string name = std::string(device) + ".exr";
    const Outcome made = work_.run({"show", "scene/hologram.png", "--distance", "50 mm", "--pupil", "1 mm", "--eye",
                                    "0 0 200 mm", "--device", device, "-o", name});
    ASSERT_EQ(made.exit_code, 0) << made.err;
    views.push_back(load_image(work_.path(name)));
  }
  double error = 0, all = 0;
  for (size_t i = 0; i < views[0].values.size(); ++i) {
    error += std::pow(views[1].values[i] - views[0].values[i], 2);
    all += std::pow(views[0].values[i], 2);
  }
  EXPECT_LT(std::sqrt(error / all), 1e-5);
  EXPECT_GT(error, 0) << "by the processor?";
}

// Waves, holograms, panel and camera on the device, also behind the stop of a hologram: the field of the first frame is a
// result there, too.
TEST_F(DevicesOfTheProgram, RunScenesFromWavesToPictures) {
  if (!has_device()) GTEST_SKIP() << "no OpenCL device here";
  for (const std::string method : {"phase", "double-phase"}) {
    SCOPED_TRACE(method);
    const std::string encode = "[encode]\nmethod = \"" + method + "\"\n";
    work_.write("scene.toml", scene + encode);
    std::string text = scene + encode + "device = \"opencl\"\n";
    for (const char* stage : {"synthesize", "show", "propagate"})
      text += "[" + std::string(stage) + "]\ndevice = \"opencl\"\n";
    work_.write("on_device.toml", text);
    for (const char* name : {"scene", "on_device"}) {
      const Outcome made = work_.run({"run", std::string(name) + ".toml", "-o", name});
      ASSERT_EQ(made.exit_code, 0) << made.err;
    }
    const Json stages = Json::parse(work_.read("on_device/report.json")).at("stages");
    for (const Json& stage : stages)
      if (stage.at("stage") == "encode" || stage.at("stage") == "show") {
        EXPECT_TRUE(stage.contains("device")) << stage;
      }
    const Field here = load_fields(work_.path("scene/field.npy")).front();
    const Field there = load_fields(work_.path("on_device/field.npy")).front();
    double error = 0, all = 0;
    for (size_t i = 0; i < here.samples.size(); ++i) {
      error += std::norm(there.samples.values[i] - here.samples.values[i]);
      all += std::norm(here.samples.values[i]);
    }
    EXPECT_LT(std::sqrt(error / all), 2e-3) << "each within the tolerance of 1e-3";
    EXPECT_GT(error, 0) << "by the processor?";
  }
}

// PoCL offers as many devices as POCL_DEVICES lists; each is the whole processor. Cards of this machine have no part in it.
TEST_F(DevicesOfTheProgram, AreSharedByRanksWithTheSameBytes) {
  if (!has_device() || !HOLOTRACE_HAS_MPI) GTEST_SKIP() << "no OpenCL device or no MPI here";
  const std::vector<std::string> two_devices{"env", "OCL_ICD_VENDORS=pocl.icd",  // of ocl-icd, Debian's loader
                                             "POCL_DEVICES=pthread pthread"};
  const Outcome list = work_.run_under(two_devices, {"info", "--devices"});
  if (list.out.find("opencl:1") == std::string::npos)
    GTEST_SKIP() << "no PoCL here, or another loader than ocl-icd:\n" << list.out;
  const auto in_bands = [&](const char* device, const char* name) {
    std::vector<std::string> arguments = field(device, name);
    arguments.insert(arguments.end(), {"--memory", "1 GB"});
    return arguments;
  };
  std::vector<std::string> ranks = two_devices;
  ranks.insert(ranks.end(),
               {"ASAN_OPTIONS=detect_leaks=0", "mpirun", "--allow-run-as-root", "--oversubscribe", "-n", "2"});
  const Outcome alone = work_.run_under(two_devices, in_bands("opencl", "alone.h5"));
  ASSERT_EQ(alone.exit_code, 0) << alone.err;
  const Outcome second = work_.run_under(two_devices, in_bands("opencl:1", "second.h5"));
  ASSERT_EQ(second.exit_code, 0) << second.err;
  const Outcome shared = work_.run_under(ranks, in_bands("opencl", "shared.h5"));
  ASSERT_EQ(shared.exit_code, 0) << shared.err;
  const auto samples = [&](const char* name) { return load_fields(work_.path(name)).front().samples.values; };
  EXPECT_EQ(samples("shared.h5"), samples("alone.h5"));
  EXPECT_EQ(samples("second.h5"), samples("alone.h5"));
}

TEST_F(DevicesOfTheProgram, ShareAFieldIfTheyAreEqual) {
  if (!has_device()) GTEST_SKIP() << "no OpenCL device here";
  const std::vector<std::string> split{"env", "HOLOTRACE_SPLIT_DEVICES=2"};  // where a device can be
  for (const auto& [device, name] : {std::pair("opencl", "one.npy"), std::pair("opencl:all", "all.npy")}) {
    const Outcome made = work_.run_under(split, field(device, name));
    ASSERT_EQ(made.exit_code, 0) << made.err;
  }
  EXPECT_EQ(work_.read("one.npy"), work_.read("all.npy"));
  const Outcome bad = work_.run_under({"env", "HOLOTRACE_SPLIT_DEVICES=none"}, field("opencl", "f.npy"));
  EXPECT_EQ(bad.err, "holotrace: expected a number from 1 in HOLOTRACE_SPLIT_DEVICES, got \"none\"\n");
}

TEST_F(DevicesOfTheProgram, ComputeOtherStagesOneByOne) {
  ASSERT_EQ(work_.run(field("cpu", "f.npy")).exit_code, 0);
  ASSERT_EQ(work_.run({"encode", "f.npy", "-o", "h.png"}).exit_code, 0);
  for (const std::vector<std::string>& command :
       {std::vector<std::string>{"propagate", "f.npy", "--distance", "10 mm", "-o", "g.npy"},
        {"show", "h.png", "--distance", "50 mm", "-o", "v.png"},
        {"encode", "f.npy", "--method", "gerchberg-saxton", "--target-distances", "50 mm", "--iterations", "1", "-o",
         "h2.png"}}) {
    std::vector<std::string> all = command;
    all.insert(all.end(), {"--device", "opencl:all"});
    const Outcome refused = work_.run(all);
    EXPECT_EQ(refused.exit_code, 1) << command.front();
    EXPECT_NE(refused.err.find("expected one device"), std::string::npos) << refused.err;
  }
}

TEST_F(DevicesOfTheProgram, ThatAreMissingAreNamedInOneSentence) {
  const Outcome unknown = work_.run(field("gpu", "f.npy"));
  EXPECT_EQ(unknown.exit_code, 1);
  EXPECT_EQ(
      unknown.err,
      "holotrace: --device: expected a device: cpu, auto, opencl, opencl:N with the number of a device, from 0, or "
      "opencl:all; got \"gpu\"\n");
  const Outcome none = work_.run_under(without_drivers, field("opencl", "f.npy"));
  EXPECT_EQ(none.exit_code, 1);
  EXPECT_EQ(none.err,
            HOLOTRACE_HAS_OPENCL
                ? "holotrace: expected a device for OpenCL, got none: no driver is installed; install that of "
                  "your card, or PoCL (pocl-opencl-icd), or use the device cpu\n"
                : "holotrace: expected a build with OpenCL, got one without; build with "
                  "-DHOLOTRACE_OPENCL=ON, or use the device cpu\n");
  EXPECT_FALSE(work_.has("f.npy"));
}

TEST_F(DevicesOfTheProgram, AreNotNeededByAuto) {
  ASSERT_EQ(work_.run(field("cpu", "a.npy")).exit_code, 0);
  const Outcome made = work_.run_under(without_drivers, field("auto", "b.npy"));
  EXPECT_EQ(made.exit_code, 0) << made.err;
  EXPECT_EQ(work_.read("a.npy"), work_.read("b.npy"));
}

}  // namespace
}  // namespace holotrace::test
