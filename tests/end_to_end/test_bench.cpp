// holotrace bench: its table, and its JSON for other programs. No timing is asserted.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "bench/bench_history.h"
#include "bench/commit.h"
#include "support/program.h"
#include "support/temporary.h"

namespace holotrace {

const char* const source_commit = "tested";

namespace {

using test::Workplace;

TEST(Bench, JsonHasTheCeilingsAndEachStageAsAPartOfItsOwn) {
  const test::Outcome outcome = Workplace().run({"bench", "--quick", "--only", "exact,tiled", "--json"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const auto json = nlohmann::json::parse(outcome.out);
  EXPECT_GE(json["threads"].get<int>(), 1);
  EXPECT_FALSE(json["processor"].get<std::string>().empty());
  const auto& ceilings = json["ceilings"];
  ASSERT_FALSE(ceilings["multiply_adds_per_s"].empty());
  for (const auto& peak : ceilings["multiply_adds_per_s"]) EXPECT_GT(peak.get<double>(), 0);
  for (const char* name : {"memory_bytes_per_s", "fft_in_cache_operations_per_s", "fft_3840x2160_operations_per_s"})
    EXPECT_GT(ceilings[name].get<double>(), 0) << name;
  for (const char* name : {"bf16_vector_multiply_adds_per_s", "bf16_tile_multiply_adds_per_s"})
    EXPECT_GE(ceilings[name].get<double>(), 0) << name;

  size_t tiled = 0;
  for (const auto& stage : json["stages"]) {
    SCOPED_TRACE(stage.dump());
    EXPECT_TRUE(stage["group"] == "exact" || stage["group"] == "tiled") << "only these were asked for";
    EXPECT_EQ(stage["unit"], "waves·pixels");
    const double rate = stage["rate_per_s"], seconds = stage["seconds"];
    EXPECT_GT(seconds, 0);
    if (stage["group"] == "exact") {
      EXPECT_FALSE(stage.contains("of_ceiling")) << "nothing is known that bounds it";
      continue;
    }
    ++tiled;
    // Each run is divided by the ceiling beside it; the medians of both may come from different runs.
    EXPECT_GT(stage["of_ceiling"].get<double>(), 0);
    EXPECT_GT(stage["ceiling_per_s"].get<double>(), 0);
    const std::string job = stage["job"];
    EXPECT_LE(stage["error"].get<double>(), std::stod(job.substr(job.rfind(' ')))) << "the tolerance, at the job's end";
    // A kernel handles at most all waves on all pixels, and the rate is that amount over the time.
    EXPECT_LE(rate * seconds, 1e3 * 1920 * 1080 * 1.0001);
    EXPECT_GT(rate * seconds, 0.3 * 1e3 * 1920 * 1080) << "at 0.2 m most waves light most of the panel";
  }
  EXPECT_GE(tiled, ceilings["multiply_adds_per_s"].size()) << "a line for each instruction set, and for bf16";
}

// The rows of a history after `change` of each.
template <class Change>
std::string changed(const std::string& history, const Change& change) {
  std::string text;
  std::istringstream lines(history);
  for (std::string line; std::getline(lines, line);) {
    auto row = nlohmann::ordered_json::parse(line);
    change(row);
    text += row.dump() + "\n";
  }
  return text;
}

// As if the machine had been so many times as fast.
std::string faster(const std::string& history, double factor) {
  return changed(history, [&](auto& row) {
    row["seconds"] = row["seconds"].template get<double>() / factor;
    if (row.contains("of_ceiling")) row["of_ceiling"] = row["of_ceiling"].template get<double>() * factor;
  });
}

TEST(Bench, HistoryTakesTheRowsOfEachRunAndTellsWhatGotSlower) {
  const Workplace place;
  const auto run = [&](int exit_code = 0) {
    const test::Outcome outcome = place.run({"bench", "--quick", "--only", "show", "--history", "history.jsonl"});
    EXPECT_EQ(outcome.exit_code, exit_code) << outcome.err;
    return outcome.out + outcome.err;
  };
  const auto has = [](const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
  };
  EXPECT_TRUE(has(run(), "history.jsonl has no earlier times of these stages on this machine"));
  const std::string rows = place.read("history.jsonl");
  const auto count = std::count(rows.begin(), rows.end(), '\n');
  changed(rows, [&](const auto& row) {
    for (const char* name : {"date", "commit", "version", "processor", "device", "group", "stage", "job"})
      EXPECT_FALSE(row[name].template get<std::string>().empty()) << name;
    EXPECT_EQ(row.contains("of_ceiling"), row["stage"] == "encode");
  });
  // Factors of a hundred stand out of the noise of short runs beside other programs.
  place.write("history.jsonl", faster(rows, 100));
  EXPECT_TRUE(has(run(), fmt::format("{0} of the {0} stages with earlier times in history.jsonl are slower", count)));
  const std::string both = place.read("history.jsonl");
  EXPECT_EQ(std::count(both.begin(), both.end(), '\n'), 2 * count) << "rows are added";
  place.write("history.jsonl", rows + "{\"stage\": 3}\n");
  EXPECT_TRUE(has(run(1), fmt::format("history.jsonl: line {} is not a row of holotrace bench --history", count + 1)));
}

// A run that is compared with files of earlier rows: a stage whose ceiling is known, and one whose ceiling is not.
TEST(Bench, HistoryComparesWithTheMedianOfTheLastFiveRows) {
  const std::string path = test::temporary("history.jsonl");
  BenchRow filled, timed;
  filled.group = timed.group = "show";
  filled.job = timed.job = "a";
  filled.stage = "encode", timed.stage = "show";
  filled.seconds = timed.seconds = 1e-2;
  filled.of_ceiling = 0.5;
  filled.ceiling = "memory";
  const std::vector<BenchRow> now{filled, timed};
  BenchHistory(path).append(now, 2);
  std::ifstream file(path);
  const std::string rows(std::istreambuf_iterator<char>(file), {});
  const auto slower_than = [&](const std::string& history) {
    std::ofstream(path) << history;
    const BenchComparison comparison = BenchHistory(path).compare(now, 2, 1.5);
    return std::pair(comparison.compared, int(comparison.slower.size()));
  };
  EXPECT_EQ(slower_than(faster(rows, 100)), std::pair(2, 2));
  EXPECT_EQ(slower_than(faster(rows, 0.01)), std::pair(2, 0));
  // Of three slow runs and three fast ones after them, the last five are two slow and three fast ones, whose median is fast.
  std::string slow_then_fast;
  for (const double factor : {0.01, 0.01, 0.01, 100.0, 100.0, 100.0}) slow_then_fast += faster(rows, factor);
  EXPECT_EQ(slower_than(slow_then_fast), std::pair(2, 2));
  // Where there is a ceiling, the part of it is compared, not the time: here only the time was shorter.
  EXPECT_EQ(slower_than(changed(rows,
                                [](auto& row) {
                                  row["seconds"] = row["seconds"].template get<double>() / 100;
                                  if (row.contains("of_ceiling"))
                                    row["of_ceiling"] = row["of_ceiling"].template get<double>() / 100;
                                })),
            std::pair(2, 1));
  for (const char* name : {"processor", "device", "job"})
    EXPECT_EQ(slower_than(changed(faster(rows, 100), [&](auto& row) { row[name] = "another"; })), std::pair(0, 0))
        << name;
  EXPECT_EQ(slower_than(changed(faster(rows, 100), [&](auto& row) { row["threads"] = 99; })), std::pair(0, 0));
}

// Noise falls as 1/√paths, so the time to a given noise is that of the picture × (its noise / the given one)².
TEST(Bench, TellsTheTimeOfARenderToAGivenNoise) {
  const test::Outcome outcome = Workplace().run({"bench", "--quick", "--only", "render", "--json"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const auto json = nlohmann::json::parse(outcome.out);
  ASSERT_EQ(json["stages"].size(), 2U);
  for (const auto& stage : json["stages"]) {
    SCOPED_TRACE(stage.dump());
    const double error = stage["error"], seconds = stage["seconds"], paths = stage["facts"]["paths"];
    // Pictures of 16 paths: a path's light varies by about its mean, and less where lights are sampled.
    EXPECT_GT(error, 0.01);
    EXPECT_LT(error, 1 / std::sqrt(paths));
    EXPECT_NEAR(stage["facts"]["seconds_to_noise_of_1_percent"].get<double>(), seconds * error * error * 1e4,
                1e-9 * seconds * error * error * 1e4);
    EXPECT_NEAR(stage["rate_per_s"].get<double>() * seconds, 64 * 64 * paths, 1e-6);
  }
}

TEST(Bench, TimesADeviceAgainstItsOwnPeaks) {
  const Workplace work;
  if (nlohmann::json::parse(work.run({"info", "--devices", "--json"}).out)["devices"].size() < 2)
    GTEST_SKIP() << "no OpenCL device here";
  const test::Outcome outcome = work.run({"bench", "--quick", "--device", "opencl", "--json"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const auto json = nlohmann::json::parse(outcome.out);
  for (const char* name : {"multiply_adds_per_s", "memory_bytes_per_s"})
    EXPECT_GT(json["device_ceilings"][name].get<double>(), 0) << name;
  ASSERT_EQ(json["stages"].size(), 6U) << "no stage of the processor";
  std::map<std::string, nlohmann::json> stages;
  for (const auto& stage : json["stages"]) {
    stages[stage["stage"]] = stage;
    EXPECT_GT(stage["of_ceiling"].get<double>(), 0) << stage["stage"];
  }
  const auto bytes = [&](const std::string& name, const char* way) {
    return stages.at(name + " on opencl")["facts"][way].get<double>();
  };
  const double pixels = 480 * 270;
  // The fields of complex floats are transferred, and nothing else; kernels read and write more than these.
  const auto& propagation = stages.at("propagate on opencl");
  EXPECT_EQ(bytes("propagate", "bytes_in"), 8 * pixels);
  EXPECT_EQ(bytes("propagate", "bytes_out"), 8 * pixels);
  EXPECT_GT(propagation["rate_per_s"].get<double>() * propagation["seconds"].get<double>(), 16 * pixels);
  // Levels in, and small tables of rows and columns; 4 bytes of each row for the power.
  EXPECT_GE(bytes("show", "bytes_in"), 4 * pixels);
  EXPECT_LE(bytes("show", "bytes_in"), 4 * pixels + 24 * (480 + 270) + 100);
  EXPECT_EQ(bytes("show", "bytes_out"), 4 * 270);
  EXPECT_LE(bytes("look", "bytes_in"), 100) << "weights of a pixel";
  EXPECT_EQ(bytes("look", "bytes_out"), 4 * pixels) << "the picture";
  EXPECT_EQ(bytes("gerchberg-saxton", "bytes_in"), 0);
  EXPECT_EQ(bytes("gerchberg-saxton", "bytes_out"), 4 * 270) << "an error of each row";
  EXPECT_EQ(bytes("sgd", "bytes_in"), 0);
  EXPECT_EQ(bytes("sgd", "bytes_out"), 3 * 4.0 * 270) << "two sums and an error of each row";
  const auto& stage = stages.at("tiled on opencl");
  EXPECT_LE(stage["error"].get<double>(), 1e-3);
  // Sources in, at most 48 bytes for each of 200, and 8 for each place of a column or a row of tiles; the field out.
  EXPECT_LE(stage["facts"]["bytes_in"].get<double>(), 48 * 200 + 8 * (120 + 270));
  EXPECT_EQ(stage["facts"]["bytes_out"].get<double>(), 8.0 * 1920 * 1080);
}

TEST(Bench, TableNamesTheCeilingsAlone) {
  const test::Outcome outcome = Workplace().run({"bench", "--only", "ceilings"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("multiply-adds/s"), std::string::npos) << outcome.out;
  EXPECT_NE(outcome.out.find("memory"), std::string::npos);
  EXPECT_EQ(outcome.out.find("of ceiling"), std::string::npos) << "no stage was asked for";
}

TEST(Bench, AnUnknownGroupIsWrongUsageAndSuggestsTheNearest) {
  const test::Outcome outcome = Workplace().run({"bench", "--only", "tield"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_NE(outcome.err.find("did you mean \"tiled\"?"), std::string::npos) << outcome.err;
}

}  // namespace
}  // namespace holotrace
