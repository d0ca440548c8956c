// Files of the user are safe: full disks, inputs, other files in the folder, runs at the same time, stopped programs.

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <unistd.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "end_to_end/scenes.h"
#include "holotrace/base/sanitizers.h"
#include "holotrace/io/field/field_file.h"
#include "holotrace/io/field/hologram_file.h"
#include "holotrace/io/files/folders.h"
#include "holotrace/io/picture/image_file.h"
#include "holotrace/io/run_folder.h"
#include "support/png.h"
#include "support/program.h"

namespace holotrace::test {
namespace {

std::string point_scene(const std::string& more = "") {
  return scene_head() + points_object() + "[render]\nrows = 32\npaths = 1\n" + more;
}

void write_scene(const Workplace& work, const std::string& more = "") {
  work.write("points.ply", point_file({{{0, 0, -0.03}}}));
  work.write("scene.toml", point_scene(more));
}

void expect_error(const Workplace& work, const std::vector<std::string>& arguments, const std::string& words) {
  const Outcome outcome = work.run(arguments);
  EXPECT_EQ(outcome.exit_code, 1) << outcome.err;
  EXPECT_NE(outcome.err.find(words), std::string::npos) << outcome.err;
}

// A hologram with views at three distances.
void make_hologram(const Workplace& work) {
  write_scene(work);
  expect_quiet_success(work, {"field", "scene.toml", "-o", "f.npy"});
  expect_quiet_success(work, {"encode", "f.npy", "-o", "h.png"});
}

// prlimit --fsize: a write beyond that many bytes fails, as on a full disk.
TEST(SafeFiles, AFullDiskLeavesTheEarlierRunAndSaysSo) {
#if HOLOTRACE_THREAD_SANITIZER
  GTEST_SKIP() << "the thread sanitizer does not start without a file of its own";
#endif
  const Workplace work;
  write_scene(work);
  expect_quiet_success(work, {"run", "scene.toml", "-o", "out"});
  const std::set<std::string> names = work.names();
  const std::string report = work.read("out/report.json"), view = work.read("out/view.png");
  // Bytes of sources.ply, hologram.png, view.png and field.npy are some hundreds to 400 thousand.
  for (const char* bytes : {"0", "300", "5000", "60000", "393000"}) {
    const Outcome outcome =
        work.run_under({"prlimit", std::string("--fsize=") + bytes}, {"run", "scene.toml", "-o", "out"});
    EXPECT_EQ(outcome.exit_code, 1) << bytes;
    EXPECT_NE(outcome.err.find("File too large"), std::string::npos) << outcome.err;
    EXPECT_EQ(outcome.err.find(".holotrace-"), std::string::npos) << outcome.err;
    EXPECT_EQ(work.names(), names) << bytes;
    EXPECT_TRUE(work.read("out/report.json") == report) << bytes;
    EXPECT_TRUE(work.read("out/view.png") == view) << bytes;
  }
}

TEST(SafeFiles, AFullDiskBehindStandardOutputOrErrorIsNoticed) {
  const Workplace work;
  write_scene(work);
  const auto shell = [&](const std::string& to, const std::vector<std::string>& arguments) {
    return work.run_under({"sh", "-c", "exec \"$0\" \"$@\" " + to}, arguments);
  };
  const Outcome table = shell(">/dev/full", {"limits", "--json"});
  EXPECT_EQ(table.exit_code, 1);
  EXPECT_EQ(
      table.err,
      "holotrace: expected to write the standard output, got \"No space left on device\"; make room where it goes\n");
  // Lost warnings stop no work.
  work.write("old.toml", "field_of_view = \"1 deg\"\n" + point_scene());
  EXPECT_EQ(shell("2>/dev/full", {"run", "scene.toml", "-o", "out", "--distances", "30 mm"}).exit_code, 0);
  EXPECT_EQ(shell("2>/dev/full", {"run", "missing.toml", "-o", "out"}).exit_code, 1);
}

TEST(SafeFiles, ARunKeepsTheFilesOfOthersAndRemovesItsOwn) {
  const Workplace work;
  write_scene(work);
  for (const char* name : {"out/stereo_left.png", "out/view_2.png", "out/convergence.png", "out/notes.txt"})
    work.write(name, "mine");
  const Outcome several = work.run({"run", "scene.toml", "-o", "out", "--distance", "20 mm, 30 mm, 40 mm"});
  EXPECT_EQ(several.exit_code, 0);
  EXPECT_EQ(several.err,
            "warning: out/view_2.png was not written by an earlier call of this command; it is kept as "
            "out/view_2.png~\n");
  EXPECT_EQ(work.read("out/view_2.png~"), "mine");
  EXPECT_TRUE(work.has("out/view_3.png"));
  expect_quiet_success(work, {"run", "scene.toml", "-o", "out", "--distance", "20 mm"});
  EXPECT_FALSE(work.has("out/view_2.png") || work.has("out/view_3.png"));
  for (const char* name : {"out/stereo_left.png", "out/convergence.png", "out/notes.txt"})
    EXPECT_EQ(work.read(name), "mine") << name;
  // The report lists what is there.
  for (const auto& [name, bytes] : report_record(work.path("out/report.json")))
    EXPECT_EQ(std::filesystem::file_size(work.path("out/" + name)), bytes) << name;
  EXPECT_EQ(report_record(work.path("out/report.json")).size(),
            7U);  // render, its radiance, sources, field, its .json, hologram, view
}

// A run that is killed while its files get their names leaves a report that names the files of both runs.
TEST(SafeFiles, ARunAfterOneThatWasKilledWhileItsFilesGotTheirNamesIsWhole) {
  const Workplace work;
  write_scene(work);
  expect_quiet_success(work, {"run", "scene.toml", "-o", "out", "--distance", "20 mm, 30 mm, 40 mm"});
  save_incomplete_report(work.path("out/report.json"), report_record(work.path("out/report.json")));
  EXPECT_FALSE(nlohmann::json::parse(work.read("out/report.json")).at("complete"));
  std::filesystem::remove(work.path("out/field.npy"));
  expect_quiet_success(work, {"run", "scene.toml", "-o", "out", "--distance", "20 mm, 30 mm"});
  EXPECT_TRUE(nlohmann::json::parse(work.read("out/report.json")).at("complete"));
  EXPECT_TRUE(work.has("out/field.npy") && work.has("out/view_2.png"));
  EXPECT_FALSE(work.has("out/view_3.png"));
  for (const std::string& name : work.names()) EXPECT_FALSE(name.ends_with("~")) << name;
}

TEST(SafeFiles, ShowKeepsPicturesOfTheSameName) {
  const Workplace work;
  make_hologram(work);
  for (const char* name : {"photo_2.png", "photo_3.png", "photo_sweep.gif"}) work.write(name, "mine");
  expect_quiet_success(work, {"show", "h.png", "-o", "photo.png", "--distance", "30 mm"});
  for (const char* name : {"photo_2.png", "photo_3.png", "photo_sweep.gif"}) EXPECT_EQ(work.read(name), "mine");
  EXPECT_EQ(image_record(work.path("photo.png")), FileRecord());
}

// NAME_2 of a user is set aside once; NAME_2 of an earlier call is replaced, or removed where there is none any more.
TEST(SafeFiles, TraceKeepsFilesOfTheSameName) {
  const Workplace work;
  work.write("scene.toml", mesh_scene());
  work.write("s_2.ply", "mine");
  const std::vector<std::string> two{"trace", "scene.toml", "-o", "s.ply", "--wavelength", "532 nm, 633 nm"};
  const Outcome first = work.run(two);
  EXPECT_EQ(first.exit_code, 0);
  EXPECT_NE(first.err.find("kept as"), std::string::npos) << first.err;
  EXPECT_EQ(work.read("s_2.ply~"), "mine");
  const Outcome second = work.run(two);
  EXPECT_EQ(second.err, "");
  EXPECT_EQ(work.run({"trace", "scene.toml", "-o", "s.ply"}).exit_code, 0);
  EXPECT_EQ(work.names(), (std::set<std::string>{"scene.toml", "s.ply", "s_2.ply~"}));
}

TEST(SafeFiles, FieldKeepsFilesOfTheSameName) {
  const Workplace work;
  std::string scene = mesh_scene();
  scene.insert(scene.find("[trace]\n") + 8, "separate_lights = true\n");
  work.write("scene.toml", scene + "[[light]]\ntype = \"point\"\nposition = \"-1 2 -20 mm\"\nintensity = 1e-3\n");
  work.write("f_2.npy", "mine");
  work.write("g_2.h5", "mine, too");
  const Outcome first = work.run({"field", "scene.toml", "-o", "f.npy"});
  EXPECT_EQ(first.exit_code, 0);
  EXPECT_NE(first.err.find("kept as"), std::string::npos) << first.err;
  EXPECT_EQ(work.read("f_2.npy~"), "mine");
  const std::string field = work.read("f_2.npy");
  EXPECT_EQ(work.run({"field", "scene.toml", "-o", "f.npy"}).err, "");
  EXPECT_TRUE(work.read("f_2.npy") == field);
  EXPECT_FALSE(work.has("f_2.npy~2~"));
  EXPECT_EQ(work.run({"info", "f.npy"}).exit_code, 0);  // the record in its sidecar does no harm
  EXPECT_EQ(work.run({"field", "scene.toml", "-o", "g.h5"}).exit_code, 0);
  EXPECT_EQ(work.read("g_2.h5~"), "mine, too");
  EXPECT_EQ(work.run({"field", "scene.toml", "-o", "g.h5"}).err, "");
}

TEST(SafeFiles, MetadataOfOneFileIsNotThatOfAnother) {
  const Workplace work;
  make_hologram(work);
  expect_quiet_success(work, {"encode", "f.npy", "-o", "f.png"});
  expect_quiet_success(work, {"encode", "f.npy", "-o", "g.png", "--report", "g.json"});
  expect_quiet_success(work, {"field", "scene.toml", "-o", "g.npy"});
  EXPECT_NO_THROW(load_field(work.path("f.npy")));
  EXPECT_EQ(load_hologram(work.path("f.png")).wavelength, test_wavelength);
  EXPECT_EQ(load_hologram(work.path("g.png")).wavelength, test_wavelength);
  EXPECT_NO_THROW(load_field(work.path("g.npy")));
  EXPECT_TRUE(is_report(work.path("g.json")));
}

TEST(SafeFiles, NoCommandWritesOverItsInput) {
  const Workplace work;
  make_hologram(work);
  const std::string words = "other than the input";
  expect_quiet_success(work, {"show", "h.png", "-o", "a.png", "--distance", "30 mm"});
  std::filesystem::copy(work.path("a.png"), work.path("b.png"));
  std::filesystem::create_symlink("a.png", work.path("link.png"));
  const std::string before = work.read("a.png");
  expect_error(work, {"compare", "a.png", "b.png", "--difference", "a.png"}, words);
  expect_error(work, {"compare", "a.png", "b.png", "--difference", "link.png"}, words);
  EXPECT_TRUE(work.read("a.png") == before);
  expect_error(work, {"propagate", "f.npy", "--distance", "1 mm", "-o", "./f.npy"}, words);
  expect_error(work, {"encode", "a.png", "-o", "a.png", "--wavelength", "532 nm", "--target-distances", "30 mm"},
               words);
  expect_error(work, {"encode", "f.npy", "-o", "x.png", "--method", "gerchberg-saxton", "--plot", "x.png"},
               "a file for each output");
  // A file that the scene names: the picture of its environment.
  save_image(work.path("env.exr"), Image(4, 8, 3), 1, 8);
  work.write("env.toml", point_scene() + "[environment]\nmap = \"env.exr\"\n");
  const std::string environment = work.read("env.exr");
  expect_error(work, {"render", "env.toml", "-o", "env.exr"}, words);
  EXPECT_TRUE(work.read("env.exr") == environment);
  std::filesystem::create_directory(work.path("out"));
  std::filesystem::rename(work.path("env.exr"), work.path("out/view.png"));
  work.write("out/env.toml", point_scene() + "[environment]\nmap = \"view.png\"\n");
  work.write("out/points.ply", work.read("points.ply"));
  expect_error(work, {"run", "out/env.toml", "-o", "out"}, words);
}

// Frames of an earlier, longer series are no part of the new one.
TEST(SafeFiles, AShorterSeriesOfHologramsLeavesNoneOfALongerOne) {
  const Workplace work;
  write_scene(work);
  expect_quiet_success(work, {"field", "scene.toml", "-o", "three.h5", "--wavelength", "638 nm, 520 nm, 450 nm"});
  expect_quiet_success(work, {"field", "scene.toml", "-o", "two.h5", "--wavelength", "638 nm, 520 nm"});
  expect_quiet_success(work, {"encode", "three.h5", "-o", "h.png"});
  EXPECT_EQ(series_part(work.path("h_2.png")).number, 2U);
  EXPECT_EQ(series_part(work.path("h_2.png")).count, 3U);
  const std::string third = work.read("h_3.png");
  work.write("other_3.png", third);
  expect_quiet_success(work, {"encode", "two.h5", "-o", "h.png"});
  EXPECT_FALSE(work.has("h_3.png"));
  EXPECT_TRUE(work.has("other_3.png"));
  work.write("h_3.png", third);  // as if it had been left
  expect_error(work, {"show", "h.png", "h_2.png", "h_3.png", "-o", "v.png", "--distance", "30 mm"},
               "h.png is number 1 of a series of 2, and h_3.png is number 3 of a series of 3");
  expect_quiet_success(work, {"show", "h.png", "h_2.png", "other_3.png", "-o", "v.png", "--distance", "30 mm"});
}

TEST(SafeFiles, AFolderIsForOneRunAtATime) {
  const Workplace work;
  write_scene(work);
  std::filesystem::create_directory(work.path("out"));
  {
    const FolderLock other(work.path("out"));
    expect_error(work, {"run", "scene.toml", "-o", "out"}, "another run writes into it");
    EXPECT_FALSE(work.has("out/report.json"));
  }
  expect_quiet_success(work, {"run", "scene.toml", "-o", "out"});
}

// A program that is stopped while it holds the lock of the cache.
TEST(SafeFiles, AStoppedProgramThatHoldsTheCacheStopsNoOther) {
  const Workplace work;
  make_hologram(work);
  const int lock = open((work.cache_path("summation_rates.json") + ".lock").c_str(), O_RDWR);
  ASSERT_GE(lock, 0);
  ASSERT_EQ(flock(lock, LOCK_EX), 0);
  std::filesystem::remove(work.cache_path("summation_rates.json"));
  const Outcome outcome = work.run({"field", "scene.toml", "-o", "g.npy"});
  close(lock);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  const size_t at = outcome.err.find("locked by another program");
  EXPECT_NE(at, std::string::npos) << outcome.err;
  EXPECT_EQ(outcome.err.find("locked by another program", at + 1), std::string::npos) << "once is enough";
}

TEST(SafeFiles, FoldersInTheCachesPlaceAreNoError) {
  const Workplace work;
  make_hologram(work);
  for (const char* name : {"summation_rates.json", "summation_rates.json.lock"}) {
    std::filesystem::remove_all(work.cache_path(name));
    std::filesystem::create_directory(work.cache_path(name));
    expect_quiet_success(work, {"field", "scene.toml", "-o", "g.npy"});
  }
}

}  // namespace
}  // namespace holotrace::test
