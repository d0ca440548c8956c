// The table of a panel's calibration (slm_file.h).

#include <fmt/ranges.h>

#include <charconv>
#include <cmath>
#include <string>
#include <string_view>
#include <vector>

#include "holotrace/base/error.h"
#include "holotrace/base/message_text.h"
#include "holotrace/base/units.h"
#include "holotrace/io/files/file.h"
#include "holotrace/io/files/text.h"
#include "holotrace/io/scene/slm_file.h"

namespace holotrace {
namespace {

std::vector<std::string> cells_of(std::string_view line) {
  std::vector<std::string> cells;
  line = trimmed(without_comment(line));
  while (!line.empty()) {
    const size_t end = std::min(line.find(','), line.size());
    cells.emplace_back(trimmed(line.substr(0, end)));
    line.remove_prefix(std::min(end + 1, line.size()));
  }
  return cells;
}

struct Columns {
  size_t level = 0, phase = 0, amplitude = 0, count = 0;
  double radians = 1;  // radians per unit of the phase column
  bool has_amplitude = false;
};

// What the table holds for each level: a phase that never falls, and an amplitude; or a delay.
enum class TableOf { phases, delays };

Columns read_headings(const std::vector<std::string>& names, TableOf kind, const std::string& place) {
  const std::string what = kind == TableOf::delays ? "delay" : "phase";
  Columns columns;
  columns.count = names.size();
  bool has_level = false, has_phase = false;
  for (size_t i = 0; i < names.size(); ++i) {
    const std::string& name = names[i];
    if (name == "level" || name == "grey" || name == "gray") {
      columns.level = i;
      has_level = true;
    } else if (name == what || name == what + "_rad" || name == what + "_pi" || name == what + "_deg") {
      columns.phase = i;
      columns.radians = name == what + "_pi" ? pi : name == what + "_deg" ? pi / 180 : 1;
      has_phase = true;
    } else if (name == "amplitude" && kind == TableOf::phases) {
      columns.amplitude = i;
      columns.has_amplitude = true;
    } else {
      std::vector<std::string> known{"level", "grey", what + "_rad", what + "_pi", what + "_deg"};
      if (kind == TableOf::phases) known.emplace_back("amplitude");
      throw Error(place + unknown_name_message("column", name, known));
    }
  }
  require(has_level && has_phase, "{0}expected the headings level and {1}_rad (or {1}_pi, {1}_deg), got \"{2}\"", place,
          what, fmt::format("{}", fmt::join(names, ",")));
  return columns;
}

double number_in(const std::string& cell, const std::string& place) {
  double value = 0;
  const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
  require(error == std::errc() && end == cell.data() + cell.size() && std::isfinite(value),
          "{}expected a number, got \"{}\"", place, cell);
  return value;
}

struct Row {
  double level = 0;
  CalibrationPoint point;
};

std::vector<CalibrationPoint> load_table(const std::string& path, TableOf kind, int levels) {
  check_file_exists(path, "a calibration");
  const std::string text = read_lines(path);
  std::string_view rest = text, line;
  std::vector<Row> rows;
  Columns columns;
  int number = 0;
  std::string place;
  while (next_line(rest, line)) {
    ++number;
    const std::vector<std::string> cells = cells_of(line);
    if (cells.empty()) continue;
    place = fmt::format("{}:{}: ", path, number);
    if (columns.count == 0) {
      columns = read_headings(cells, kind, place);
      continue;
    }
    require(cells.size() == columns.count, "{}expected {} values, as there are headings, got {}", place, columns.count,
            cells.size());
    Row row;
    row.level = number_in(cells[columns.level], place);
    row.point.phase = number_in(cells[columns.phase], place) * columns.radians;
    if (columns.has_amplitude) row.point.amplitude = number_in(cells[columns.amplitude], place);
    require(!rows.empty() || row.level == 0, "{}expected a calibration that begins at level 0, got level {}", place,
            row.level);
    require(rows.empty() || row.level > rows.back().level, "{}expected levels in rising order, got {} after {}", place,
            row.level, rows.empty() ? 0 : rows.back().level);
    require(rows.empty() || kind == TableOf::delays || row.point.phase >= rows.back().point.phase,
            "{}expected a calibration whose phase never falls, got {:.6g} rad after {:.6g} rad; write a phase "
            "that wraps as values above 2π",
            place, row.point.phase, rows.empty() ? 0 : rows.back().point.phase);
    require(row.point.amplitude >= 0 && row.point.amplitude <= 1, "{}expected an amplitude in [0, 1], got {}", place,
            row.point.amplitude);
    rows.push_back(row);
  }
  require(rows.size() >= 2 && rows.back().level >= levels - 1,
          "{}expected a calibration up to level {}, the last of the panel's {}, got {}",
          place.empty() ? path + ": " : place, levels - 1, levels,
          rows.empty() ? std::string("none") : fmt::format("levels up to {}", rows.back().level));

  std::vector<CalibrationPoint> points;
  size_t above = 1;
  for (int level = 0; level < levels; ++level) {
    while (rows[above].level < level) ++above;
    const Row &a = rows[above - 1], &b = rows[above];
    const double t = (level - a.level) / (b.level - a.level);
    points.push_back({a.point.phase + t * (b.point.phase - a.point.phase),
                      a.point.amplitude + t * (b.point.amplitude - a.point.amplitude)});
  }
  return points;
}

}  // namespace

std::vector<CalibrationPoint> load_calibration(const std::string& path, int levels) {
  return load_table(path, TableOf::phases, levels);
}

std::vector<double> load_delays(const std::string& path, int levels) {
  std::vector<double> delays;
  for (const CalibrationPoint& point : load_table(path, TableOf::delays, levels)) delays.push_back(point.phase);
  return delays;
}

}  // namespace holotrace
