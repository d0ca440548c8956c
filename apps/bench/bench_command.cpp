// holotrace bench: the highest rates of this machine, and the fraction of them that each stage reaches, in one run.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "bench/bench.h"
#include "bench/bench_history.h"
#include "bench/commit.h"
#include "commands.h"
#include "console.h"
#include "flags.h"
#include "holotrace/base/error.h"
#include "holotrace/base/machine.h"
#include "holotrace/base/message_text.h"
#include "holotrace/estimate/machine/ceilings.h"
#include "holotrace/io/files/output.h"
#include "holotrace/io/picture/chart_file.h"

namespace holotrace {
namespace {

using Json = nlohmann::ordered_json;

struct BenchGroup {
  const char* name;
  std::vector<BenchStep> (*steps)(const BenchOptions&);
};

// Groups in the order of the table. To add a stage, add a line here and its steps in bench.h.
const BenchGroup groups[] = {
    {"trace", trace_steps},         {"render", render_steps},       {"accelerators", accelerators_steps},
    {"exact", exact_steps},         {"tiled", tiled_steps},         {"planes", planes_steps},
    {"layers", layers_steps},       {"triangles", triangles_steps}, {"auto", auto_steps},
    {"propagate", propagate_steps}, {"show", show_steps},           {"quality", quality_steps},
    {"device", device_steps}};

std::vector<std::string> group_names() {
  std::vector<std::string> names{"ceilings"};
  for (const BenchGroup& group : groups) names.push_back(group.name);
  return names;
}

std::string check_group(const std::string& name) {
  const std::vector<std::string> known = group_names();
  if (std::find(known.begin(), known.end(), name) != known.end()) return "";
  return unknown_name_message("group of stages", name, known);
}

// --- the ceilings ---

Json json_of(const Ceilings& c) {
  Json multiply_adds;
  for (const MultiplyAddPeak& peak : c.multiply_adds) multiply_adds[peak.instruction_set] = peak.per_second;
  return {{"multiply_adds_per_s", multiply_adds},
          {"bf16_vector_multiply_adds_per_s", c.bf16_vectors},
          {"bf16_tile_multiply_adds_per_s", c.bf16_tiles},
          {"memory_bytes_per_s", c.memory_bandwidth},
          {"fft_in_cache_operations_per_s", c.fft_in_cache},
          {"fft_3840x2160_operations_per_s", c.fft_of_panel}};
}

// A rate with an exponent that is a multiple of three: 45.3e9 instead of 4.53e10.
std::string format_rate(double rate) {
  int power = 0;
  while (rate >= 1000) {
    rate /= 1000;
    power += 3;
  }
  const int decimals = rate < 10 ? 2 : rate < 100 ? 1 : 0;
  return power > 0 ? fmt::format("{:.{}f}e{}", rate, decimals, power) : fmt::format("{:.{}f}", rate, decimals);
}

void print_ceiling(const std::string& name, double rate, const char* unit) {
  fmt::print("  {:<44} {:>8} {}/s\n", name, rate > 0 ? format_rate(rate) : "-", unit);
}

void print_ceilings(const DeviceInfo& info, const DevicePeak& peak) {
  fmt::print("Ceilings of {}\n", printable(info.name));
  print_ceiling("multiply-adds in registers", peak.multiply_adds, "multiply-adds");
  print_ceiling("memory, u = v", peak.memory, "bytes");
}

void print_ceilings(const Ceilings& c) {
  fmt::print("Ceilings of {}, {} thread{}\n", cpu_name(), c.threads, c.threads == 1 ? "" : "s");
  for (const MultiplyAddPeak& peak : c.multiply_adds)
    print_ceiling(peak.instruction_set, peak.per_second, "multiply-adds");
  print_ceiling("bf16, AVX-512 vectors", c.bf16_vectors, "multiply-adds");
  print_ceiling("bf16, AMX tiles", c.bf16_tiles, "multiply-adds");
  print_ceiling("memory, u = v + s·w", c.memory_bandwidth, "bytes");
  print_ceiling("FFT of 4096 samples in cache, float", c.fft_in_cache, "operations");
  print_ceiling("FFT of 3840x2160 samples, float", c.fft_of_panel, "operations");
}

// --- the stages ---

Json json_of(const BenchRow& row) {
  Json json{{"group", row.group}, {"stage", row.stage}, {"job", row.job}, {"unit", row.unit}};
  if (!row.result.empty()) json["result"] = row.result;
  if (!row.left_out.empty()) {
    json["left_out"] = row.left_out;
  } else {
    json["seconds"] = row.seconds;
    json["runs"] = row.runs;
    json["rate_per_s"] = row.rate;
  }
  if (row.ceiling_rate > 0) {
    json["ceiling"] = row.ceiling;
    json["ceiling_per_s"] = row.ceiling_rate;
    json["of_ceiling"] = row.of_ceiling;
  }
  if (row.error >= 0) json["error"] = row.error;
  if (!row.facts.empty()) json["facts"] = row.facts;
  return json;
}

std::string format_seconds(double seconds) {
  return seconds < 0.1 ? fmt::format("{:.2f} ms", 1e3 * seconds) : fmt::format("{:.3f} s", seconds);
}

void print_head() {
  fmt::print("\n{:<22} {:<52} {:>10} {:>8} {:<15} {:>10} {:>8}\n", "stage", "job", "time", "rate", "per second",
             "of ceiling", "error");
}

void print_row(const BenchRow& row) {
  if (!row.left_out.empty()) {
    fmt::print("{:<22} {:<52} left out: {}\n", row.stage, row.job, row.left_out);
    return;
  }
  fmt::print("{:<22} {:<52} {:>10} {:>8} {:<15} {:>10} {:>8}\n", row.stage,
             row.result.empty() ? row.job : row.job + ": " + row.result, format_seconds(row.seconds),
             format_rate(row.rate), row.unit,
             row.ceiling_rate > 0 ? fmt::format("{:.0f} %", 100 * row.of_ceiling) : "-",
             row.error >= 0 ? fmt::format("{:.1e}", row.error) : "-");
}

// Runs a step. If the stage refuses its job, the row contains the reason, and the other rows still run.
BenchRow run_step(const BenchStep& step) {
  try {
    return step.run();
  } catch (const Error& error) {
    return {.stage = step.name, .left_out = error.what()};
  }
}

constexpr double slower = 1.1;  // times the time before: less is noise

void print_slower(const BenchComparison& comparison, const std::string& file) {
  const auto& [compared, stages] = comparison;
  if (compared == 0) {
    fmt::print("\n{} has no earlier times of these stages on this machine\n", file);
    return;
  }
  fmt::print("\n{} of the {} stages with earlier times in {} are slower now by more than {:.0f} %\n", stages.size(),
             compared, file, 100 * (slower - 1));
  const auto text = [](const SlowerStage& s, double value) {
    return s.is_part ? fmt::format("{:.3g} % of ceiling", 100 * value) : format_seconds(value);
  };
  for (const SlowerStage& s : stages)
    fmt::print("{:<22} {:<52} {:>18} before, {:>18} now: {:.2f} times as slow\n", s.stage, s.job, text(s, s.before),
               text(s, s.now), s.ratio);
}

struct BenchOutputs {
  bool is_json = false;
  std::string plot, history;  // files, or empty
};

void run_bench(const BenchOptions& options, const std::vector<std::string>& only, const BenchOutputs& outputs,
               Console& console) {
  std::optional<BenchHistory> history;
  if (!outputs.history.empty()) history.emplace(outputs.history);
  const Ceilings ceilings = measure_ceilings(console.watch("ceilings"));
  Json json{{"version", HOLOTRACE_VERSION}, {"commit", source_commit},       {"processor", cpu_name()},
            {"threads", ceilings.threads},  {"ceilings", json_of(ceilings)}, {"stages", Json::array()}};
  const bool has_device = options.device.kind == DeviceKind::opencl;
  DevicePeak peak;
  if (has_device) {
    peak = measure_device_peak(open_device(options.device.number));
    json["device_ceilings"] = {{"multiply_adds_per_s", peak.multiply_adds}, {"memory_bytes_per_s", peak.memory}};
  }
  std::vector<BenchRow> rows;
  const auto show = [&](const auto& print) {
    if (outputs.is_json) return;
    console.clear();
    print();
    std::fflush(stdout);
  };
  show([&] {
    print_ceilings(ceilings);
    if (has_device) print_ceilings(open_device(options.device.number).info(), peak);
  });
  for (const BenchGroup& group : groups) {
    const bool is_named = std::find(only.begin(), only.end(), group.name) != only.end();
    const bool is_of_device = group.name == std::string("device");
    if (only.empty() ? is_of_device != has_device : !is_named) continue;
    const Observer observer = console.watch(group.name);
    const std::vector<BenchStep> steps = group.steps(options);
    for (size_t i = 0; i < steps.size(); ++i) {
      rows.push_back(run_step(steps[i]));
      rows.back().group = group.name;
      show([&] {
        if (rows.size() == 1) print_head();
        print_row(rows.back());
      });
      json["stages"].push_back(json_of(rows.back()));
      observer.progress(double(i + 1) / double(steps.size()));
    }
  }
  console.finish();
  if (!outputs.plot.empty()) save_chart(outputs.plot, accelerators_chart(rows));
  if (history) {
    const BenchComparison comparison = history->compare(rows, ceilings.threads, slower);
    json["compared_with_history"] = comparison.compared;
    json["slower"] = Json::array();
    for (const SlowerStage& s : comparison.slower)
      json["slower"].push_back({{"stage", s.stage},
                                {"job", s.job},
                                {"measure", s.is_part ? "part of the ceiling" : "seconds"},
                                {"before", s.before},
                                {"now", s.now},
                                {"ratio", s.ratio}});
    show([&] { print_slower(comparison, outputs.history); });
    history->append(rows, ceilings.threads);
  }
  if (outputs.is_json) fmt::print("{}\n", json.dump(2));
}

}  // namespace

void add_bench_command(CLI::App& app, const GlobalFlags& global) {
  CLI::App* command = app.add_subcommand(
      "bench",
      "peak rates of this machine and the fraction of them that each stage reaches (medians, ratios in one "
      "run)");
  struct Options {
    bool is_quick = false, is_full = false;
    std::vector<std::string> only;
    std::string device;
    BenchOutputs outputs;
  };
  auto o = std::make_shared<Options>();
  command->add_flag("--json", o->outputs.is_json, "as JSON");
  command->add_flag("--quick", o->is_quick,
                    "only the small jobs, with fewer runs of each: about a minute on two cores");
  command->add_flag("--full", o->is_full, "also the jobs that take longer than 15 s, which are otherwise left out")
      ->excludes("--quick");
  command->add_option("--only", o->only, fmt::format("only these groups of stages: {}", fmt::join(group_names(), ", ")))
      ->delimiter(',')
      ->type_name("NAME,NAME")
      ->check(check_group, "", "");
  command
      ->add_option("--plot", o->outputs.plot,
                   "chart of the time per ray against the number of triangles: .png or .svg; needs the group "
                   "accelerators")
      ->type_name("FILE");
  command
      ->add_option(
          "--history", o->outputs.history,
          "file of the times of earlier runs, to which those of this run are added (for each stage a line of JSON with "
          "its commit and processor); stages that are slower by more than 10 % than their last five times there "
          "(median) are listed")
      ->type_name("FILE");
  command
      ->add_option("--device", o->device,
                   "device whose stages are timed against its own peak rates: opencl or opencl:N; cpu: those of the "
                   "processor [cpu]")
      ->type_name("cpu|opencl|opencl:N");
  command->callback([o, &global] {
    if (!o->outputs.plot.empty()) {
      check_output(o->outputs.plot, {".png", ".svg"});
      require(o->only.empty() || std::find(o->only.begin(), o->only.end(), "accelerators") != o->only.end(),
              "--plot draws the group accelerators, which --only leaves out; add accelerators to --only");
    }
    if (!o->outputs.history.empty()) check_output(o->outputs.history);
    BenchOptions options;
    if (o->is_quick) options = {.is_quick = true, .seconds_per_row = 0.2, .longest_seconds = 1};
    if (o->is_full) options.longest_seconds = 1e9;
    if (!o->device.empty()) options.device = read_flag("--device", [&] { return parse_device(o->device); });
    require(options.device.kind == DeviceKind::cpu || options.device.kind == DeviceKind::opencl,
            "--device: expected cpu, opencl or opencl:N, got {}; name the device to measure",
            device_text(options.device));
    Console console(global.is_quiet);
    run_bench(options, o->only, o->outputs, console);
  });
}

}  // namespace holotrace
