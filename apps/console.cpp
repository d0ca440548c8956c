#include "console.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>
#include <vector>

#include "holotrace/base/message_text.h"
#include "holotrace/base/time_left.h"
#include "holotrace/io/describe_file.h"
#include "holotrace/io/files/output.h"
#include "holotrace/io/files/progress_file.h"
#include "holotrace/io/run_folder.h"

namespace holotrace {

// A bar that is drawn again and again on a terminal; elsewhere a line every 30 s, for logs of long jobs.
struct Console::Bar {
  using Clock = std::chrono::steady_clock;
  bool is_terminal;
  std::string stage, status{};
  std::mutex mutex{};
  Clock::time_point start = Clock::now(), drawn = start;
  double fraction = 0;
  TimeLeft time_left{};

  void draw() {
    const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
    const std::optional<double> left = time_left.estimate(seconds, fraction);
    const std::string figures = fmt::format("{:3.0f} %  {}{}{}", 100 * fraction, format_duration(seconds),
                                            left ? ", " + format_duration(*left) + " left" : std::string(),
                                            status.empty() ? status : ", " + status);
    constexpr int width = 30;
    const int full = int(fraction * width);
    if (is_terminal)
      say("\r\033[K{:<16} [{}{}] {}", stage, std::string(size_t(full), '#'), std::string(size_t(width - full), '.'),
          figures);
    else
      say("{:<16} {}\n", stage, figures);
    std::fflush(stderr);
    drawn = Clock::now();
  }

  void end() {
    if (!is_terminal) return;
    fraction = 1;
    draw();
    say("\n");
  }

  void tell(const std::string& text) {
    const std::lock_guard lock(mutex);
    status = text;
  }

  void update(double value) {
    const std::lock_guard lock(mutex);
    fraction = std::max(fraction, std::min(value, 1.0));
    if (Clock::now() - drawn > std::chrono::milliseconds(is_terminal ? 100 : 30'000)) draw();
  }
};

struct Console::KeptProgress {
  explicit KeptProgress(const std::string& folder) : file(folder) {}
  std::mutex mutex;
  ProgressFile file;
};

struct Console::KeptReport {
  std::string path;
  Report report{};
  std::chrono::steady_clock::time_point start{};
  bool is_running = false;  // the last stage

  // The observer of a new stage that also records what it tells.
  Observer begin(const std::string& stage, Observer observer) {
    report.stages.push_back({stage, 0, {}, {}, {}});
    start = std::chrono::steady_clock::now();
    is_running = true;
    observer.on_fact = [this](const std::string& key, const Fact& value) {
      report.stages.back().facts.emplace_back(key, value);
    };
    observer.on_warning = [this, say_it = observer.on_warning](const std::string& sentence) {
      report.stages.back().warnings.push_back(sentence);
      say_it(sentence);
    };
    observer.on_curve = [this](const std::string& key, const std::vector<double>& values) {
      report.stages.back().curves.emplace_back(key, values);
    };
    return observer;
  }

  void end() {
    if (!is_running) return;
    is_running = false;
    report.stages.back().seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    save_report(path, report);
  }
};

void Console::keep_report(const std::string& path) {
  if (path.empty()) return;
  check_output(path, {".json"});
  report_ = std::make_shared<KeptReport>(KeptReport{path});
}

void Console::keep_progress_in(const std::string& folder) { kept_ = std::make_shared<KeptProgress>(folder); }

Console::Console(bool is_quiet) : is_quiet_(is_quiet), is_terminal_(!is_quiet && isatty(STDERR_FILENO)) {}

Observer Console::watch(const std::string& stage) {
  finish();
  Observer observer;
  observer.on_warning = [stage, is_terminal = is_terminal_](const std::string& sentence) {
    say("{}warning: {}: {}\n", is_terminal ? "\r\033[K" : "", stage, printable(sentence));
  };
  if (!is_quiet_) bar_ = std::make_shared<Bar>(is_terminal_, stage);
  if (is_terminal_) bar_->draw();
  if (kept_) {
    const std::lock_guard lock(kept_->mutex);
    kept_->file.begin_stage(stage);
  }
  if (report_) observer = report_->begin(stage, std::move(observer));
  if (!bar_ && !kept_) return observer;
  observer.on_progress = [bar = bar_, kept = kept_](double fraction) {
    if (bar) bar->update(fraction);
    if (!kept) return;
    const std::lock_guard lock(kept->mutex);
    kept->file.update(fraction);
  };
  observer.on_status = [bar = bar_, kept = kept_](const std::string& text) {
    if (bar) bar->tell(text);
    if (!kept) return;
    const std::lock_guard lock(kept->mutex);
    kept->file.tell(text);
  };
  return observer;
}

void Console::clear() {
  if (is_terminal_ && bar_) say("\r\033[K");
}

void Console::finish() {
  if (report_) report_->end();
  if (bar_) bar_->end();
  bar_.reset();
}

namespace {

struct Figure {
  const char* fact;
  const char* text;  // with a place for the number
};

// What a person asks for first. The report has all facts.
constexpr std::array figures{Figure{"waves", "{:.0f} waves"},
                             Figure{"efficiency", "{:.2f} of the panel's light leaves it"}};

constexpr double good_psnr = 25;  // of a view against its render [dB]; below, speckle and fringes are plain to see

std::optional<double> number_of(const StageReport& stage, const char* name) {
  for (const auto& [fact, value] : stage.facts) {
    if (fact != name) continue;
    if (const auto* number = std::get_if<double>(&value)) return *number;
    if (const auto* count = std::get_if<int64_t>(&value)) return double(*count);
  }
  return std::nullopt;
}

const std::vector<double>* curve_of(const StageReport& stage, const char* name) {
  for (const auto& [curve, values] : stage.curves)
    if (curve == name) return &values;
  return nullptr;
}

// Where the light of holograms for eyes goes.
void print_light_of_eyes(const StageReport& stage) {
  const auto *in_box = curve_of(stage, "light_in_eyebox"), *in_pupil = curve_of(stage, "light_in_pupil"),
             *beside = curve_of(stage, "light_beside_eyebox");
  if (!in_box || !in_pupil || !beside) return;
  for (size_t i = 0; i < in_box->size(); ++i)
    fmt::print(
        "    {}{:.1f} % of the panel's light reaches the eyebox, {:.1f} % a pupil in its middle, {:.1f} % a pupil just outside\n",
        in_box->size() > 1 ? fmt::format("eye {}: ", i + 1) : "", 100 * (*in_box)[i], 100 * (*in_pupil)[i],
        100 * (*beside)[i]);
}

}  // namespace

void print_chosen(const std::vector<Chosen>& chosen) {
  std::vector<std::string> texts;
  for (const Chosen& one : chosen) texts.push_back(one.parameter + " " + one.value);
  if (!texts.empty()) fmt::print("chosen: {}\n", fmt::join(texts, ", "));
  std::fflush(stdout);
}

void print_summary(const Report& report, const std::string& folder, const FileRecord& files, bool is_draft) {
  double total = 0;
  for (const StageReport& stage : report.stages) {
    std::vector<std::string> texts;
    for (const Figure& figure : figures)
      if (const auto number = number_of(stage, figure.fact))
        texts.push_back(fmt::format(fmt::runtime(figure.text), *number));
    fmt::print("{:<28} {:>9.2f} s  {}\n", stage.stage, stage.seconds, fmt::join(texts, ", "));
    print_light_of_eyes(stage);
    total += stage.seconds;
  }
  fmt::print("{:<28} {:>9.2f} s\n", "all stages", total);
  for (const ViewWords& view : views_in_words(report_json(report)))
    fmt::print("{}: {}\n{}", view.name, view.nearness, view.light.empty() ? "" : "    " + view.light + "\n");
  double least = good_psnr;
  for (const StageReport& stage : report.stages) least = std::min(least, number_of(stage, "psnr_db").value_or(least));
  if (is_draft && least < good_psnr) fmt::print("for a better picture: --quality good, or more --frames\n");
  std::vector<std::string> names{"report.json"};
  for (const auto& [name, bytes] : files) names.push_back(name);
  std::sort(names.begin(), names.end());
  fmt::print("written to {}: {}\n", folder, fmt::join(names, ", "));
  fmt::print("to see it in the browser: holotrace view {}\n", folder);
}

}  // namespace holotrace
