#include "holotrace/io/picture/chart_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>
#include <string_view>
#include <utility>

#include "holotrace/base/error.h"
#include "holotrace/io/files/child_process.h"
#include "holotrace/io/files/file.h"

namespace holotrace {
namespace {

// M. Okabe and K. Ito, "Color Universal Design" (2008), without yellow, which is hard to see on white.
constexpr std::array palette{"#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000"};
constexpr std::array markers{7, 5, 9, 13, 11, 6, 4};  // gnuplot's shapes: a disc, a square, triangles, a diamond, …

// A text quoted for gnuplot, so that no character has a special meaning.
std::string quoted(const std::string& text) {
  std::string result = "'";
  for (const char c : text) {
    if (c == '\'') result += '\'';
    result += static_cast<unsigned char>(c) < ' ' ? ' ' : c;
  }
  return result + "'";
}

// The scale of an axis. gnuplot finds its range automatically, except if all points share one coordinate.
std::string axis_script(const char* axis, const Chart& chart, std::vector<double> Series::*coordinate, bool is_log) {
  double low = INFINITY, high = -INFINITY;
  for (const Series& s : chart.series)
    for (const double v : s.*coordinate) low = std::min(low, v), high = std::max(high, v);
  std::string script;
  if (is_log) {
    const bool has_powers = low < 1e-3 || high > 1e4;  // otherwise plain numbers are easier to read
    script += fmt::format("set logscale {0}\nset format {0} '{1}'\n", axis, has_powers ? "10^{%L}" : "%g");
  }
  if (low < high) return script;
  if (is_log) return script + fmt::format("set {}range [{}:{}]\n", axis, low / 10, high * 10);
  const double margin = low == 0 ? 1 : std::abs(low) / 2;
  return script + fmt::format("set {}range [{}:{}]\n", axis, low - margin, high + margin);
}

std::string axes_script(const Chart& chart) {
  std::string script;
  if (!chart.title.empty()) script += fmt::format("set title {} noenhanced font ',20'\n", quoted(chart.title));
  script += fmt::format("set xlabel {} noenhanced\n", quoted(chart.x_label));
  script += fmt::format("set ylabel {} noenhanced\n", quoted(chart.y_label));
  if (chart.is_equal_aspect) script += "set size ratio -1\n";
  script += axis_script("x", chart, &Series::x, chart.is_log_x);
  script += axis_script("y", chart, &Series::y, chart.is_log_y);
  for (const ChartLabel& label : chart.labels)
    script +=
        fmt::format("set label {} at {},{} noenhanced offset 0.6,0.6 front\n", quoted(label.text), label.x, label.y);
  return script;
}

std::string style_of(const Series& s, size_t n) {
  const size_t place = s.colour < 0 ? n : size_t(s.colour);
  const char* kind = s.has_line && s.has_markers ? "linespoints" : s.has_line ? "lines" : "points";
  std::string style = fmt::format("with {} lc rgb '{}'", kind, palette[place % palette.size()]);
  // Series that reuse a colour of the palette differ by their dashes.
  if (s.has_line) style += fmt::format(" lw 2.5 dt {}", s.is_dashed ? 2 : 1 + n / palette.size() * 3);
  if (s.has_markers) style += fmt::format(" pt {} ps 1.3", markers[place % markers.size()]);
  return style;
}

std::string gnuplot_script(const Chart& chart, const std::string& extension) {
  std::string script = extension == ".png"
                           ? "set terminal pngcairo size 1200,800 font 'DejaVu Sans,17' background '#ffffff'\n"
                           : "set terminal svg size 1200,800 font 'DejaVu Sans,17' background '#ffffff'\n";
  script +=
      "set encoding utf8\n"
      "set border 3 lc rgb '#444444'\n"
      "set tics nomirror out\n"
      "set grid xtics ytics back lt 1 lc rgb '#d8d8d8' lw 1\n"
      "set key tmargin center horizontal Left reverse\n"
      "set rmargin 4\n";
  script += axes_script(chart);
  std::string plots;
  for (size_t n = 0; n < chart.series.size(); ++n) {
    const Series& s = chart.series[n];
    if (s.x.empty()) continue;
    script += fmt::format("$series{} << END_OF_SERIES\n", n);
    for (size_t i = 0; i < s.x.size(); ++i) script += fmt::format("{} {}\n", s.x[i], s.y[i]);
    script += "END_OF_SERIES\n";
    if (s.is_filled)
      plots += fmt::format(
          "{}$series{} using 1:2 with filledcurves closed fs transparent solid 0.15 noborder lc rgb "
          "'{}' notitle",
          plots.empty() ? "" : ", ", n, palette[(s.colour < 0 ? n : size_t(s.colour)) % palette.size()]);
    plots += fmt::format("{}$series{} using 1:2 {} {}", plots.empty() ? "" : ", ", n, style_of(s, n),
                         s.name.empty() ? "notitle" : "title " + quoted(s.name) + " noenhanced");
  }
  return script + "plot " + plots + "\n";
}

// gnuplot is not installed.
struct NoGnuplot : Error {
  using Error::Error;
};

// The last line that is not blank: gnuplot repeats the faulty line before the message.
std::string last_words(const std::string& messages) {
  std::istringstream lines(messages);
  std::string words = "no error message";
  for (std::string line; std::getline(lines, line);)
    if (line.find_first_not_of(" \t^") != std::string::npos) words = line;
  return words;
}

}  // namespace

void save_chart(const std::string& path, const Chart& chart) {
  const std::string extension = extension_of(path);
  require(extension == ".png" || extension == ".svg",
          "expected a chart file .png or .svg, got {}; change its extension", path);
  check_chart(chart);
  const std::string script = gnuplot_script(chart, extension);
  std::string_view next = script;
  // Without user settings. It does not write the file itself: it would not report that the disk is full.
  const ProgramRun run =
      run_program({"gnuplot", "--default-settings"}, [&] { return std::exchange(next, std::string_view()); });
  if (!run.start_error.empty())
    throw NoGnuplot(fmt::format(
        "expected the program gnuplot to draw {} with, got \"{}\"; install it (Debian: gnuplot-nox), or leave the "
        "picture out",
        path, run.start_error));
  require(run.has_succeeded && !run.output.empty(),
          "expected gnuplot to draw {}, got \"{}\"; update gnuplot, or leave the picture out", path,
          last_words(run.messages));
  write_text(path, run.output);
}

void try_save_chart(const OutputSet& set, const std::string& name, const Chart& chart, const Observer& observer) {
  try {
    save_chart(set.path(name), chart);
  } catch (const NoGnuplot&) {
  } catch (const Error& error) {
    observer.warn(set.final_text(error.what()));
  }
}

}  // namespace holotrace
