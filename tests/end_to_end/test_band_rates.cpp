// Fields in bands by the rates of one machine: a resumed run, and every rank, uses those of the run that began.

#include <algorithm>
#include <fstream>

#include "end_to_end/bands.h"
#include "end_to_end/mpirun.h"
#include "support/build_paths.h"

namespace holotrace::test {
namespace {

namespace fs = std::filesystem;

std::vector<std::string> automatic_field(const std::string& device, const std::string& output) {
  std::vector<std::string> arguments = field_in_bands(output);
  std::replace(arguments.begin(), arguments.end(), std::string("exact"), std::string("auto"));
  std::replace(arguments.begin(), arguments.end(), std::string("400 MB"), std::string("500 MB"));  // memory for plans
  arguments.insert(arguments.end() - 2, {"--device", device});
  return arguments;
}

// Writes rates by which `planes` is by far faster than tiles, or the other way round.
void write_rates(const std::string& path, nlohmann::json machines, const std::set<std::string>& of_planes,
                 bool planes_are_fast) {
  for (auto& machine : machines)
    for (auto& [name, rate] : machine.items()) rate = of_planes.contains(name) == planes_are_fast ? 1e12 : 1.0;
  std::ofstream(path) << machines.dump();
}

// Rates of the processor, and of a device: there `planes` has fewer multiply-adds than tiles, but moves more bytes.
const std::set<std::string> of_planes{"plane_waves", "spreads", "fft_operations", "samples"}, moved{"moved_bytes"};

class BandRates : public ::testing::Test {
 protected:
  void SetUp() override {
    save_sources(work_.path("waves.ply"), waves_of_bands(8000));  // enough that a test can act during the run
  }
  bool has_device() const {
    const Outcome listed = work_.run({"info", "--devices", "--json"});
    return nlohmann::json::parse(listed.out).at("devices").size() > 1;
  }
  // Measures and saves the rates of this machine; returns the file.
  nlohmann::json measured(const std::string& device, const std::string& rates) const {
    expect_success(work_, automatic_field(device, "measured.h5"));
    return nlohmann::json::parse(bytes_of(work_.cache_path(rates)));
  }
  // The bits of tiles and planes differ within the tolerance.
  void expect_first_rates(const std::string& device, const std::string& file, const std::set<std::string>& fast) {
    const nlohmann::json machines = measured(device, file);
    const std::string path = work_.cache_path(file);
    write_rates(path, machines, fast, true);
    expect_success(work_, automatic_field(device, "planes.h5"));
    write_rates(path, machines, fast, false);
    expect_success(work_, automatic_field(device, "whole.h5"));
    ASSERT_FALSE(work_.read("whole.h5") == work_.read("planes.h5"))
        << "the rates do not matter: the test shows nothing";
    leave_unfinished(work_, automatic_field(device, "f.h5"));
    write_rates(path, machines, fast, true);
    expect_success(work_, automatic_field(device, "f.h5"));
    EXPECT_TRUE(work_.read("f.h5") == work_.read("whole.h5"));
  }
  Workplace work_;
};

TEST_F(BandRates, AreThoseOfTheFirstRunWhenResumed) { expect_first_rates("cpu", "summation_rates.json", of_planes); }

TEST_F(BandRates, OfADeviceAreThoseOfTheFirstRunWhenResumed) {
  if (!has_device()) GTEST_SKIP() << "no OpenCL device here";
  expect_first_rates("opencl", "device_rates.json", moved);
}

// As on two machines, rank 1 has another cache.
TEST_F(BandRates, OfADeviceAreThoseOfTheFirstRankOnAll) {
  if (!has_device()) GTEST_SKIP() << "no OpenCL device here";
  if (!HOLOTRACE_HAS_MPI || !has_mpirun()) GTEST_SKIP() << "no MPI here";
  const nlohmann::json machines = measured("opencl", "device_rates.json");
  const fs::path cache = fs::path(work_.cache_path("device_rates.json")).parent_path(), other = cache / "rank_1";
  write_rates(cache / "device_rates.json", machines, moved, true);
  expect_success(work_, automatic_field("opencl", "alone.h5"));
  fs::create_directories(other / "holotrace");
  fs::copy(cache / "summation_rates.json", other / "holotrace" / "summation_rates.json");
  write_rates(other / "holotrace" / "device_rates.json", machines, moved, false);
  std::vector<std::string> ranks = mpirun(2);
  ranks.insert(ranks.end(),
               {"sh", "-c",
                "if [ $OMPI_COMM_WORLD_RANK = 1 ]; then XDG_CACHE_HOME=" + other.string() + "; fi; exec \"$@\"", "sh"});
  const Outcome shared = work_.run_under(ranks, automatic_field("opencl", "shared.h5"));
  ASSERT_EQ(shared.exit_code, 0) << shared.err;
  EXPECT_TRUE(work_.read("shared.h5") == work_.read("alone.h5"));
}

}  // namespace
}  // namespace holotrace::test
