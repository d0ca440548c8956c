// Large panels: made band by band, in bounded memory, and resumed after a kill.

#include <fcntl.h>
#include <sys/mount.h>
#include <sys/resource.h>
#include <unistd.h>

#include <fstream>

#include "end_to_end/bands.h"
#include "holotrace/base/sanitizers.h"
#include "holotrace/io/field/field_file.h"
#include "holotrace/view/compare.h"

namespace holotrace::test {
namespace {

namespace fs = std::filesystem;

TEST(Bands, EqualTheFieldMadeInOnePiece) {
  const Workplace work;
  save_sources(work.path("waves.ply"), waves_of_bands(30));
  ASSERT_EQ(work.run(field_in_bands("f.h5")).exit_code, 0);
  const std::vector<std::string> whole{"field", "waves.ply", "--columns", "96", "--rows",
                                       "2048",  "--method",  "exact",     "-o", "whole.h5"};
  ASSERT_EQ(work.run(whole).exit_code, 0);
  const FieldMetrics metrics = compare(load_field_double(work.path("whole.h5")), load_field_double(work.path("f.h5")));
  EXPECT_LT(metrics.relative_error, 6e-8) << "both are rounded to float once";
  EXPECT_EQ(work.names(), (std::set<std::string>{"waves.ply", "f.h5", "whole.h5"}));
  EXPECT_NE(work.run({"info", "f.h5"}).out.find("96x2048"), std::string::npos);
}

TEST(Bands, KilledAtAnyMomentAreResumedToTheSameBytes) {
  const Workplace work;
  save_sources(work.path("waves.ply"), waves_of_bands(100));
  ASSERT_EQ(work.run(field_in_bands("whole.h5")).exit_code, 0);
  // Kills as soon as there is any file; the journal; 1, 4, 8 and 14 finished bands.
  int kills = 0;
  for (const int moment : {-2, -1, 1, 4, 8, 14}) {
    const pid_t child = work.start(field_in_bands("f.h5"));
    const bool is_met = wait_until(child, [&] {
      if (moment == -2) return work.names().size() > 2;
      return journal_of(work, "f.h5") >= std::max(0, moment);
    });
    if (!is_met) continue;
    kill(child, SIGKILL);
    waitpid(child, nullptr, 0);
    ++kills;
    EXPECT_FALSE(work.has("f.h5")) << "what has its name is whole";
  }
  EXPECT_GE(kills, 4) << "the run was over before it could be killed";
  const int there = journal_of(work, "f.h5");
  EXPECT_GE(there, 8);
  std::vector<std::string> again = field_in_bands("f.h5");
  std::erase(again, "--quiet");
  const Outcome outcome = work.run(again);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(outcome.err, fmt::format("holotrace: resuming f.h5: {} of 16 bands done\n", there));
  EXPECT_TRUE(work.read("f.h5") == work.read("whole.h5"));
  EXPECT_FALSE(work.has("f.h5.partial"));
  EXPECT_FALSE(work.has("f.h5.partial.json"));
}

TEST(Bands, OfAnotherJobAreRefusedAndKept) {
  const Workplace work;
  save_sources(work.path("waves.ply"), waves_of_bands(100));
  leave_unfinished(work);
  const std::string journal = work.read("f.h5.partial.json");
  save_sources(work.path("waves.ply"), waves_of_bands(101));
  const Outcome outcome = work.run(field_in_bands("f.h5"));
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_EQ(outcome.err,
            "holotrace: expected f.h5.partial to be an unfinished run of this job (96x2048 pixels of 8 µm, 101 waves "
            "at 532 nm, method exact, tolerance 0.001, 16 bands), got one of another (96x2048 pixels of 8 µm, 100 "
            "waves at 532 nm, method exact, tolerance 0.001, 16 bands); finish that one by its own command, or delete "
            "f.h5.partial\n");
  EXPECT_EQ(work.read("f.h5.partial.json"), journal);
}

// Only the tolerance differs: bands of different tolerances do not fit together.
TEST(Bands, OfAnotherToleranceAreRefused) {
  const Workplace work;
  save_sources(work.path("waves.ply"), waves_of_bands(100));
  leave_unfinished(work);
  std::vector<std::string> other = field_in_bands("f.h5");
  other.insert(other.end(), {"--tolerance", "0.002"});
  const Outcome outcome = work.run(other);
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_NE(outcome.err.find("tolerance 0.002, 16 bands), got one of another"), std::string::npos) << outcome.err;
}

// A small disk of its own, for a test that fills it.
class SmallDisk {
 public:
  SmallDisk(const std::string& folder, const char* size) : folder_(folder) {
    fs::create_directory(folder);
    is_mounted_ = mount("tmpfs", folder.c_str(), "tmpfs", 0, size) == 0;
  }
  ~SmallDisk() {
    if (is_mounted_) umount2(folder_.c_str(), MNT_DETACH);
  }
  bool is_mounted() const { return is_mounted_; }

 private:
  std::string folder_;
  bool is_mounted_;
};

TEST(Bands, ADiskThatIsTooSmallIsReportedBeforeTheWork) {
  const Workplace work;
  save_sources(work.path("waves.ply"), waves_of_bands(10));
  const SmallDisk disk(work.path("disk"), "size=1m");  // the field needs 1.5 MiB
  if (!disk.is_mounted()) GTEST_SKIP() << "a small disk can be mounted by root only";
  const Outcome outcome = work.run(field_in_bands("disk/f.h5"));
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_EQ(outcome.err.find("holotrace: cannot write disk/f.h5: the disk is full: expected 1.5 MiB of room in "), 0u)
      << outcome.err;
  EXPECT_TRUE(fs::is_empty(work.path("disk")));
}

TEST(Bands, FinishedBandsOutliveAFullDisk) {
  const Workplace work;
  save_sources(work.path("waves.ply"), waves_of_bands(100));
  const SmallDisk disk(work.path("disk"), "size=2m");
  if (!disk.is_mounted()) GTEST_SKIP() << "a small disk can be mounted by root only";
  ASSERT_EQ(work.run(field_in_bands("whole.h5")).exit_code, 0);
  leave_unfinished(work, field_in_bands("disk/f.h5"));
  // Simulates a file system without reservation that fills up: some bands lose their place, another file gets it.
  const int file = open(work.path("disk/f.h5.partial").c_str(), O_RDWR);
  ASSERT_EQ(fallocate(file, FALLOC_FL_PUNCH_HOLE | FALLOC_FL_KEEP_SIZE, 1 << 20, 400 << 10), 0);
  close(file);
  const int there = journal_of(work, "disk/f.h5");
  ASSERT_LE(there, 10) << "the bands in the hole must be unfinished";
  std::ofstream(work.path("disk/other")) << std::string(700000, 'x');
  const Outcome full = work.run(field_in_bands("disk/f.h5"));
  EXPECT_EQ(full.exit_code, 1);
  EXPECT_EQ(full.err, fmt::format("holotrace: cannot write disk/f.h5.partial: the disk is full (No space left on "
                                  "device); make room there and give the same command again: {} of 16 bands are kept\n",
                                  there));
  fs::remove(work.path("disk/other"));
  const Outcome again = work.run(field_in_bands("disk/f.h5"));
  EXPECT_EQ(again.exit_code, 0) << again.err;
  EXPECT_TRUE(work.read("disk/f.h5") == work.read("whole.h5"));
}

TEST(Bands, KeepToTheirMemory) {
#if HOLOTRACE_ADDRESS_SANITIZER || HOLOTRACE_THREAD_SANITIZER
  GTEST_SKIP() << "a sanitizer's own memory is many times the program's";
#endif
  const Workplace work;
  save_sources(work.path("waves.ply"), waves_of_bands(20));
  // 512 MiB of samples with a limit of 100 MB: 50 for the program, and bands of 128 rows, 8 MiB.
  const pid_t child = work.start({"field", "waves.ply", "--columns", "8192", "--rows", "8192", "--pitch", "4 um",
                                  "--method", "tiled", "--memory", "100 MB", "--quiet", "-o", "f.h5"});
  int status = 0;
  rusage used{};
  ASSERT_EQ(wait4(child, &status, 0, &used), child);
  ASSERT_EQ(status, 0);
  EXPECT_LT(double(used.ru_maxrss) * 1024, 100e6);
  EXPECT_GT(fs::file_size(work.path("f.h5")), 8192u * 8192 * 8);
}

TEST(Bands, OfAColourSceneAreInOneFile) {
  const Workplace work;
  work.write("points.ply", point_file({{{0, 0, -0.03}}, {{0.0004, 0.0002, -0.031}}}));
  work.write("scene.toml", scene_head() + points_object());
  const std::vector<std::string> common{"field", "scene.toml", "--wavelength", "638 nm, 532 nm", "--method",
                                        "exact", "-o"};
  auto banded = common, whole = common;
  banded.insert(banded.end(), {"f.h5", "--memory", "300 MB"});
  whole.push_back("whole.h5");
  ASSERT_EQ(work.run(banded).exit_code, 0);
  ASSERT_EQ(work.run(whole).exit_code, 0);
  const auto fields = load_fields_double(work.path("f.h5")), expected = load_fields_double(work.path("whole.h5"));
  ASSERT_EQ(fields.size(), 2u);
  EXPECT_NEAR(fields[0].label.cone_wavelength, 532e-9, 1e-18) << "red keeps to the cone of green";
  for (size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(fields[i].wavelength, expected[i].wavelength);
    EXPECT_EQ(fields[i].label.cone_wavelength, expected[i].label.cone_wavelength);
    EXPECT_LT(compare(expected[i], fields[i]).relative_error, 6e-8) << "both are rounded to float once";
  }
}

TEST(Bands, SayWhatTheyCannotDo) {
  const Workplace work;
  save_sources(work.path("waves.ply"), waves_of_bands(1));
  const auto error_with = [&](const std::vector<std::string>& more) {
    std::vector<std::string> arguments{"field", "waves.ply", "--quiet"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Outcome outcome = work.run(arguments);
    EXPECT_EQ(outcome.exit_code, 1);
    return outcome.err;
  };
  EXPECT_EQ(error_with({"--memory", "1 GB", "-o", "f.npy"}),
            "holotrace: expected an output file .h5, got f.npy; change its extension\n");
  EXPECT_EQ(error_with({"--memory", "1", "-o", "f.h5"}),
            "holotrace: --memory: expected a size with its unit, such as \"2 GB\", got \"1\" without a unit\n");
  EXPECT_EQ(error_with({"--memory", "1 GB", "--double", "-o", "f.h5"}),
            "holotrace: expected waves and single precision for a field made in bands, got --double; make it whole, "
            "without --memory and without mpirun\n");
  EXPECT_NE(error_with({"--memory", "1 GB", "--method", "layers", "-o", "f.h5"})
                .find("expected the method auto, exact, tiled or planes for a field made in bands"),
            std::string::npos);
  EXPECT_NE(error_with({"--memory", "10 MB", "-o", "f.h5"}).find("expected --memory of "), std::string::npos);
  const std::string whole = error_with({"--columns", "2000000", "--rows", "2000000", "-o", "f.h5"});
  EXPECT_NE(whole.find("compute it in bands: --memory \"2 GB\" -o NAME.h5"), std::string::npos) << whole;
}

}  // namespace
}  // namespace holotrace::test
