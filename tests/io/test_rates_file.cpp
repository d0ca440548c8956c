#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "holotrace/io/files/file.h"
#include "holotrace/io/user_cache.h"
#include "support/temporary.h"

namespace holotrace {
namespace {

namespace fs = std::filesystem;

// A separate cache folder for the test, and a calibration that counts its calls.
class RatesFile : public ::testing::Test {
 protected:
  void SetUp() override {
    if (const char* now = std::getenv("XDG_CACHE_HOME")) before_ = now;
    cache_ = test::temporary("cache");
    setenv("XDG_CACHE_HOME", cache_.c_str(), 1);
  }
  void TearDown() override {
    if (before_.empty())
      unsetenv("XDG_CACHE_HOME");
    else
      setenv("XDG_CACHE_HOME", before_.c_str(), 1);
  }

  SummationRates keep(const std::string& key) {
    return keep_summation_rates(
        key,
        [this] {
          ++calibrations_;
          SummationRates rates;
          rates.spreads = 1000 + calibrations_;
          return rates;
        },
        [this](const std::string& sentence) { warnings_.push_back(sentence); });
  }
  std::string path() const { return cache_ + "/holotrace/summation_rates.json"; }

  std::string before_, cache_;
  int calibrations_ = 0;
  std::vector<std::string> warnings_;
};

TEST_F(RatesFile, ADeviceIsMeasuredOnce) {
  const auto keep_device = [&] {
    return keep_device_rates(
        "this card",
        [&] {
          return DeviceRates{double(++calibrations_), 7, 8};
        },
        [](const auto&) {});
  };
  EXPECT_EQ(keep_device().multiply_adds, 1);
  EXPECT_EQ(keep_device().multiply_adds, 1);
  EXPECT_EQ(keep_device().bytes, 7);
  EXPECT_EQ(keep_device().moved_bytes, 8);
  EXPECT_TRUE(fs::exists(cache_ + "/holotrace/device_rates.json"));
}

TEST_F(RatesFile, AMachineIsMeasuredOnce) {
  EXPECT_EQ(keep("this machine").spreads, 1001);
  EXPECT_EQ(keep("this machine").spreads, 1001);
  EXPECT_EQ(calibrations_, 1);
  EXPECT_TRUE(fs::exists(path()));
}

TEST_F(RatesFile, MachinesThatShareAFolderKeepTheirOwn) {
  EXPECT_EQ(keep("this machine").spreads, 1001);
  EXPECT_EQ(keep("another version").spreads, 1002);
  EXPECT_EQ(keep("this machine").spreads, 1001);
  EXPECT_EQ(keep("another version").spreads, 1002);
}

TEST_F(RatesFile, DamagedFilesAreReplaced) {
  keep("this machine");
  const std::string whole = read_text(path());
  const std::string half = whole.substr(0, whole.size() / 2);
  std::string negative = whole;
  negative.replace(negative.find("1001"), 4, "-100");
  std::string text = whole;
  text.replace(text.find("1001"), 4, "\"1\" ");
  int expected = 1;
  for (const std::string& damaged :
       {std::string(), half, std::string("[1, 2]"), std::string("null"), std::string("\0\xff{", 3),
        std::string("{\"this machine\": 7}"), std::string("{\"this machine\": {}}"), negative, text}) {
    write_text(path(), damaged);
    EXPECT_EQ(keep("this machine").spreads, 1000 + ++expected) << damaged;
    EXPECT_EQ(keep("this machine").spreads, 1000 + expected) << "kept again after: " << damaged;
  }
  EXPECT_EQ(calibrations_, expected);
}

TEST_F(RatesFile, WhereNothingCanBeKeptTheDefaultsHold) {
  // A file where the folder should be: not even root can make the folder or write to it.
  fs::create_directories(cache_);
  std::ofstream(cache_ + "/holotrace") << "in the way";
  EXPECT_EQ(keep("this machine").spreads, SummationRates().spreads);
  EXPECT_EQ(calibrations_, 0) << "rates that differ from run to run are worse than none";
}

// A stopped program keeps the lock for ever. What is known is read without it; else the default rates hold.
TEST_F(RatesFile, ALockThatIsNotGivenBackStopsNobody) {
  keep("this machine");
  const int other = open((path() + ".lock").c_str(), O_RDWR);
  ASSERT_EQ(flock(other, LOCK_EX), 0);
  EXPECT_EQ(keep("this machine").spreads, 1001);
  EXPECT_TRUE(warnings_.empty());
  EXPECT_EQ(keep("another machine").spreads, SummationRates().spreads);
  ASSERT_EQ(warnings_.size(), 1U);
  EXPECT_NE(warnings_[0].find("locked by another program"), std::string::npos);
  EXPECT_EQ(calibrations_, 1);
  close(other);
}

TEST_F(RatesFile, AFolderInTheLocksPlaceIsNoError) {
  fs::create_directories(path() + ".lock");
  EXPECT_EQ(keep("this machine").spreads, 1001);
}

TEST_F(RatesFile, AFolderInTheFilesPlaceIsNoError) {
  fs::create_directories(path());
  EXPECT_EQ(keep("this machine").spreads, SummationRates().spreads);
}

}  // namespace
}  // namespace holotrace
