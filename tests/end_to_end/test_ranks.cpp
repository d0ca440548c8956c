// Many processes: the ranks of mpirun share the bands of a field.

#include <sys/stat.h>

#include "banded_field.h"
#include "end_to_end/bands.h"
#include "end_to_end/mpirun.h"
#include "holotrace/base/archive.h"
#include "support/build_paths.h"

namespace holotrace::test {
namespace {

namespace fs = std::filesystem;

// A rank that sums in a wider cone than the others would make different bands.
TEST(BandMessages, CarryAllThatASumDependsOn) {
  Sources set{.wavelength = 638e-9, .label = {.cone_wavelength = 450e-9}};
  set.waves = {{{1e-3, 2e-3, -0.1}, 0.5F, 1.0F}};
  set.second_foci = {{{1e-3, 2e-3, -0.2}, {1, 0, 0}}};
  set.tiles = {1, 2, {0.25F, 0.75F}};
  Sources heard;
  from_message(to_message(set), heard);
  EXPECT_EQ(heard.wavelength, set.wavelength);
  EXPECT_EQ(heard.label, set.label);
  EXPECT_EQ(heard.waves, set.waves);
  EXPECT_EQ(heard.second_foci, set.second_foci);
  EXPECT_EQ(heard.tiles, set.tiles);
}

class Ranks : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!HOLOTRACE_HAS_MPI) GTEST_SKIP() << "this build is without MPI";
    if (!has_mpirun()) GTEST_SKIP() << "there is no mpirun to start ranks with";
    save_sources(work.path("waves.ply"), waves_of_bands(100));
  }
  Workplace work;
};

TEST_F(Ranks, OneTwoAndThreeMakeTheSameBytesAsNoLauncher) {
  ASSERT_EQ(work.run(field_in_bands("alone.h5")).exit_code, 0);
  for (const int ranks : {1, 2, 3}) {
    const Outcome outcome = work.run_under(mpirun(ranks), field_in_bands("f.h5"));
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_TRUE(work.read("f.h5") == work.read("alone.h5")) << ranks << " ranks";
    fs::remove(work.path("f.h5"));
  }
}

TEST_F(Ranks, OneThatDiesEndsTheJobAndItsBandsAreResumed) {
  save_sources(work.path("waves.ply"), waves_of_bands(1500));  // slower than a look at /proc
  ASSERT_EQ(work.run(field_in_bands("whole.h5")).exit_code, 0);
  for (const int victim : {1, 0}) {
    const int before = std::max(0, journal_of(work, "f.h5"));
    const pid_t job = work.start_under(mpirun(2), field_in_bands("f.h5"));
    ASSERT_TRUE(wait_until(job, [&] { return journal_of(work, "f.h5") >= before + 2; })) << "over too soon";
    const pid_t process = process_of_rank(job, victim);
    ASSERT_GT(process, 0);
    kill(process, SIGKILL);
    int status = 0;
    waitpid(job, &status, 0);
    EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) != 0);
    EXPECT_FALSE(work.has("f.h5"));
    EXPECT_GE(journal_of(work, "f.h5"), before + 2);
  }
  // A different number of ranks may finish the work.
  const Outcome again = work.run_under(mpirun(3), field_in_bands("f.h5"));
  EXPECT_EQ(again.exit_code, 0) << again.err;
  EXPECT_TRUE(work.read("f.h5") == work.read("whole.h5"));
}

size_t count(const std::string& text, const std::string& part) {
  size_t found = 0;
  for (size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++found;
  return found;
}

TEST_F(Ranks, SayWhatIsWrongOnce) {
  std::vector<std::string> missing = field_in_bands("f.h5");
  missing[1] = "nowhere.ply";
  const Outcome before = work.run_under(mpirun(3), missing);
  EXPECT_NE(before.exit_code, 0);
  EXPECT_EQ(count(before.err, "holotrace: expected a PLY file at nowhere.ply"), 1u) << before.err;

  // During the work, on any rank: no tile reaches a tolerance of 1e-6.
  std::vector<std::string> hard = field_in_bands("f.h5");
  hard[7] = "tiled";
  hard.insert(hard.end(), {"--tolerance", "1e-6"});
  const Outcome within = work.run_under(mpirun(3), hard);
  EXPECT_NE(within.exit_code, 0);
  EXPECT_EQ(count(within.err, "holotrace: expected a tolerance that"), 1u) << within.err;

  const Outcome usage = work.run_under(mpirun(2), {"feild"});
  EXPECT_NE(usage.exit_code, 0);
  EXPECT_EQ(count(usage.err, "did you mean"), 1u) << usage.err;
}

TEST_F(Ranks, ShareNoOtherCommandWhichRunsOnce) {
  ASSERT_EQ(work.run_under(mpirun(2), field_in_bands("f.h5")).exit_code, 0);
  const Outcome info = work.run_under(mpirun(2), {"info", "f.h5"});
  EXPECT_EQ(info.exit_code, 0) << info.err;
  EXPECT_EQ(count(info.out, "96x2048"), 1u) << info.out;
}

}  // namespace
}  // namespace holotrace::test
