#include "holotrace/io/picture/panel_image_file.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <optional>
#include <string_view>
#include <variant>

#include "holotrace/base/error.h"
#include "holotrace/base/machine.h"
#include "holotrace/base/units.h"
#include "holotrace/io/files/file.h"
#include "holotrace/io/files/new_file.h"
#include "holotrace/io/files/npy.h"
#include "holotrace/io/files/output.h"
#include "holotrace/io/files/text.h"
#include "holotrace/io/picture/formats/formats.h"
#include "holotrace/io/picture/picture_input.h"

namespace holotrace {
namespace {

void write_panel_npy(const std::string& path, const PanelImage& image, const void* samples) {
  std::vector<int64_t> shape{image.rows, image.columns};
  if (image.channels > 1) shape.push_back(image.channels);
  const std::string header = npy_header(image.bits == 8 ? "|u1" : "<u2", shape);
  NewFile file(path);
  file.put(header.data(), header.size());
  file.put(samples, image.values.size() * size_t(image.bits / 8));
  file.finish();
}

void write_panel_csv(const std::string& path, const PanelImage& image) {
  std::string text = "Y/X";
  for (int i = 0; i < image.columns; ++i) text += fmt::format(",{}", i);
  text += '\n';
  for (int j = 0; j < image.rows; ++j) {
    fmt::format_to(std::back_inserter(text), "{}", j);
    for (int i = 0; i < image.columns; ++i)
      fmt::format_to(std::back_inserter(text), ",{}", image.values[size_t(j) * size_t(image.columns) + size_t(i)]);
    text += '\n';
  }
  write_text(path, text);
}

// The number that a cell is; nothing for other words and for an empty cell.
std::optional<double> number_in_cell(std::string_view cell) {
  double value = 0;
  const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
  if (error != std::errc() || end != cell.data() + cell.size()) return std::nullopt;
  return value;
}

// The numbers of a line, one or more; nothing where it has other words. Cells end at commas or semicolons, of which one may
// end the line, else at blanks.
std::optional<std::vector<double>> numbers_in(std::string_view line) {
  const bool has_marks = line.find_first_of(",;") != line.npos;
  std::vector<double> numbers;
  while (!line.empty()) {
    const size_t end = std::min(line.find_first_of(has_marks ? ",;" : " \t"), line.size());
    const std::string_view cell = trimmed(line.substr(0, end));
    line.remove_prefix(std::min(end + 1, line.size()));
    if (cell.empty() && !has_marks) continue;
    const std::optional<double> number = number_in_cell(cell);
    if (!number) return std::nullopt;
    numbers.push_back(*number);
  }
  if (numbers.empty()) return std::nullopt;
  return numbers;
}

// Calls add(numbers, place, is_counted) for each line: its place is "FILE:3: ", and it is counted if a heading says that the first
// number is that of the row, as in Santec's files. Headings may be before the first line of numbers.
template <class Add>
void each_line_of_numbers(const std::string& path, const Add& add) {
  constexpr uint64_t most = uint64_t(1) << 30;  // 100 million levels
  const std::string text = read_lines(path, most);
  require_memory(5 * double(text.size()), path);  // the text, and 8 bytes for 2 characters or more
  std::string_view rest = text, line;
  bool has_numbers = false, is_counted = false;
  for (int number = 1; next_line(rest, line); ++number) {
    const std::string_view words = trimmed(without_comment(line));
    if (words.empty()) continue;
    const std::string place = fmt::format("{}:{}: ", path, number);
    const std::optional<std::vector<double>> numbers = numbers_in(words);
    require(numbers.has_value() || !has_numbers, "{}expected numbers, got \"{}\"", place, words.substr(0, 40));
    is_counted = is_counted || (!numbers && words.starts_with("Y/X"));
    has_numbers = has_numbers || numbers;
    if (numbers) add(*numbers, place, is_counted);
  }
}

PanelTable read_panel_csv(const std::string& path) {
  std::vector<double> values;
  size_t columns = 0, rows = 0;
  bool counts_rows = false;
  each_line_of_numbers(path, [&](const std::vector<double>& numbers, const std::string& place, bool is_counted) {
    if (rows == 0) columns = numbers.size();
    counts_rows = is_counted;
    require(numbers.size() == columns, "{}expected {} values, as in the first line, got {}", place, columns,
            numbers.size());
    require(!is_counted || columns > 1, "{}expected levels behind the number of the row, got none", place);
    require(!is_counted || numbers[0] == double(rows), "{}expected the row {}, got {}", place, rows, numbers[0]);
    values.insert(values.end(), numbers.begin() + (is_counted ? 1 : 0), numbers.end());
    ++rows;
  });
  require(rows > 0, "{}: expected a table of levels, got no numbers", path);
  PanelTable table{{int(rows), int(columns) - (counts_rows ? 1 : 0)}};
  std::copy(values.begin(), values.end(), table.values.values.begin());
  return table;
}

// The samples of a .npy as doubles, for one of the types that hold real numbers.
template <class Number>
void copy_numbers(const char* from, bool is_fortran, int channels, Array2D<double>& to) {
  const size_t columns = size_t(to.nx / channels);
  for (int j = 0; j < to.ny; ++j)
    for (int i = 0; i < to.nx; ++i) {
      const size_t column = size_t(i / channels), channel = size_t(i % channels);
      const size_t at =
          is_fortran ? (channel * columns + column) * size_t(to.ny) + size_t(j) : size_t(j) * size_t(to.nx) + size_t(i);
      Number number;
      std::memcpy(&number, from + at * sizeof number, sizeof number);
      to(j, i) = double(number);
    }
}

PanelTable read_panel_npy(const std::string& path) {
  const std::string bytes = read_text(path);
  const NpyHeader header = read_npy_header(bytes, path);
  struct Type {
    std::string_view name;
    size_t size;
    void (*copy)(const char*, bool, int, Array2D<double>&);
    bool is_float;
  };
  constexpr Type types[] = {{"|b1", 1, copy_numbers<uint8_t>, false},  {"|u1", 1, copy_numbers<uint8_t>, false},
                            {"<u2", 2, copy_numbers<uint16_t>, false}, {"<i2", 2, copy_numbers<int16_t>, false},
                            {"<u4", 4, copy_numbers<uint32_t>, false}, {"<i4", 4, copy_numbers<int32_t>, false},
                            {"<i8", 8, copy_numbers<int64_t>, false},  {"<u8", 8, copy_numbers<uint64_t>, false},
                            {"<f4", 4, copy_numbers<float>, true},     {"<f8", 8, copy_numbers<double>, true}};
  const auto type =
      std::find_if(std::begin(types), std::end(types), [&](const Type& t) { return t.name == header.dtype; });
  require(type != std::end(types),
          "{}: expected levels as whole numbers, or phases as floats, got the type '{}'; convert it with numpy.astype",
          path, header.dtype);
  const std::vector<int64_t>& shape = header.shape;
  const bool has_channels = shape.size() == 3 && shape[2] == 3;
  require(
      (shape.size() == 2 || has_channels) && shape[0] > 0 && shape[1] > 0 && shape[0] < 1 << 28 && shape[1] < 1 << 28,
      "{}: expected the shape (rows, columns) or (rows, columns, 3), got {}", path, format_shape(shape));
  const int channels = has_channels ? 3 : 1;
  const double numbers = double(shape[0]) * double(shape[1]) * channels, expected = numbers * double(type->size);
  require(double(bytes.size() - header.data_begin) == expected,
          "{}: expected {} bytes of numbers for shape {}, got {}; the file is truncated or damaged, write it again",
          path, expected, format_shape(shape), bytes.size() - header.data_begin);
  require_memory(numbers * sizeof(double), path);
  PanelTable table{{int(shape[0]), int(shape[1]) * channels}, channels, type->is_float, type->name == "|b1"};
  type->copy(bytes.data() + header.data_begin, header.fortran_order, channels, table.values);
  return table;
}

}  // namespace

const std::vector<std::string>& panel_image_endings() {
  static const std::vector<std::string> endings{".png", ".bmp", ".tif", ".tiff", ".npy", ".csv"};
  return endings;
}

PanelValue value_in(const std::string& path) {
  const std::string ending = extension_of(path);
  return ending == ".npy" || ending == ".csv" ? PanelValue::level : PanelValue::grey;
}

void check_panel_image(const std::string& path, const PanelImage& image) {
  const std::string ending = extension_of(path);
  const std::vector<std::string>& known = panel_image_endings();
  require(std::find(known.begin(), known.end(), ending) != known.end(),
          "expected a file .png, .bmp, .tif, .npy or .csv for a panel, got {}; change its extension", path);
  require(
      ending != ".bmp" || image.bits == 8,
      "expected values of 8 bits for the BMP {}, got 16 bits; write a .tif, .png, .npy or .csv, or use at most 256 levels and a "
      "level table up to 255",
      path);
  require(ending != ".csv" || image.channels == 1,
          "expected one channel for the table {}, got {}; write a .bmp, .png, .tif or .npy, or leave out pack", path,
          image.channels);
}

void save_panel_image(const std::string& path, const PanelImage& image,
                      const std::map<std::string, std::string>& texts) {
  check_panel_image(path, image);
  const std::string ending = extension_of(path);
  const std::vector<uint8_t> bytes(image.values.begin(), image.bits == 8 ? image.values.end() : image.values.begin());
  const void* samples = image.bits == 8 ? static_cast<const void*>(bytes.data()) : image.values.data();
  if (ending == ".png")
    return write_png(path, {image.columns, image.rows, image.channels, image.bits, false, texts}, samples);
  if (ending == ".tif" || ending == ".tiff")
    return write_tiff(path, image.columns, image.rows, image.channels, image.bits, samples);
  if (ending == ".npy") return write_panel_npy(path, image, samples);
  if (ending == ".csv") return write_panel_csv(path, image);
  write_bmp(path, image.columns, image.rows, image.channels, bytes.data());
}

void save_panel_images(const OutputSet& set, const std::string& name, const std::vector<PanelImage>& images,
                       const std::map<std::string, std::string>& done) {
  const FileRecord before = set.record();
  for (size_t n = images.size(); n-- > 0;) {  // the first one knows the others
    const std::string path = set.path(numbered_path(name, n));
    save_panel_image(path, images[n]);
    nlohmann::ordered_json json = {{"kind", panel_image_kind}};
    for (const auto& [what, text] : done) json[what] = text;
    if (n == 0) {
      FileRecord others = set.record_since(before);
      std::erase_if(others, [&](const auto& file) { return file.first == name; });
      if (!others.empty()) json["files"] = record_json(record_inside(path, others));
    }
    write_text(sidecar_path(path), json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
  }
}

bool has_kind(const nlohmann::json& json) {
  return json.is_object() && json.contains("kind") &&
         (json["kind"] == panel_image_kind || json["kind"] == hologram_kind);
}

nlohmann::ordered_json done_to_panel_image(const std::string& path) {
  const std::filesystem::path sidecar = sidecar_path(path);
  if (!is_file(sidecar)) return nullptr;
  nlohmann::ordered_json json = parse_json_if_sound(read_text(sidecar));
  if (!has_kind(json) || json["kind"] != panel_image_kind) return nullptr;
  json.erase("kind");
  json.erase("files");
  return json;
}

FileRecord record_beside(const std::string& path) {
  const std::filesystem::path sidecar = sidecar_path(path);
  if (!is_file(sidecar)) return {};
  std::ifstream file(sidecar, std::ios::binary);  // an output, so not by read_text, which notes inputs
  const std::string text(std::istreambuf_iterator<char>(file), {});
  const nlohmann::ordered_json json = parse_json_if_sound(text);
  if (!has_kind(json)) return {};  // it is not ours
  FileRecord record;
  if (json.contains("files")) record = record_outside(path, record_from(json["files"]));
  record.emplace(sidecar.filename().string(), text.size());
  return record;
}

PanelTable load_panel_table(const std::string& path) {
  check_file_exists(path, "a hologram");
  return extension_of(path) == ".csv" ? read_panel_csv(path) : read_panel_npy(path);
}

bool is_panel_table(const std::string& path) {
  if (!is_file(path) || value_in(path) != PanelValue::level) return false;
  if (extension_of(path) == ".csv") return true;
  ByteSource source(path);
  std::string begin(size_t(std::min<uint64_t>(source.size(), 4096)), '\0');
  source.read(begin.data(), begin.size());
  const size_t type = begin.find("'descr': '");
  return type != begin.npos && begin.substr(type + 10, 2) != "<c";
}

std::vector<uint16_t> load_level_table(const std::string& path) {
  check_file_exists(path, "a level table");
  std::vector<uint16_t> table;
  each_line_of_numbers(path, [&](const std::vector<double>& numbers, const std::string& place, bool) {
    require(numbers.size() <= 2, "{}expected a value, or a grey and its value, got {} numbers", place, numbers.size());
    require(numbers.size() == 1 || numbers[0] == double(table.size()),
            "{}expected the grey {}, got {}; give a line for each grey, such as 256 for 8 bits", place, table.size(),
            numbers[0]);
    const double value = numbers.back();
    require(value == std::floor(value) && value >= 0 && value <= 65535,
            "{}expected a whole number of 0 to 65535, got {}", place, value);
    require(table.size() < 65536, "{}expected at most 65536 values", place);
    table.push_back(uint16_t(value));
  });
  require(!table.empty(), "{}: expected a level table, got no numbers", path);
  return table;
}

Array2D<float> load_correction(const std::string& path, int levels) {
  check_file_exists(path, "a correction");
  const std::string ending = extension_of(path);
  if (value_in(path) == PanelValue::level) {
    const PanelTable table = load_panel_table(path);
    require(ending == ".csv" || table.are_floats,
            "{}: expected phases in radians as floats, got whole numbers; convert it with numpy.astype", path);
    require(table.channels == 1, "{}: expected one phase for each pixel, got three channels", path);
    Array2D<float> cycles(table.values.ny, table.values.nx);
    for (size_t i = 0; i < cycles.size(); ++i) {
      require(std::isfinite(table.values.values[i]), "{}: expected finite numbers, got {}", path,
              table.values.values[i]);
      cycles.values[i] = float(table.values.values[i] / (table.are_floats ? 2 * pi : double(levels)));
    }
    return cycles;
  }
  require(ending != ".jpg" && ending != ".jpeg",
          "{}: expected a correction without loss, got a JPEG; use the maker's own file", path);
  const std::optional<Picture> picture = read_picture(path);
  require(picture && picture->type != SampleType::floats,
          "{}: expected a correction as a grey picture of 8 or 16 bits, as phases in a .npy, or as levels in a .csv",
          path);
  const float full = picture->type == SampleType::bits_8 ? 256 : 65536;
  const size_t channels = picture->channels.size();
  Array2D<float> cycles(picture->rows, picture->columns);
  std::visit(
      [&](const auto& samples) {
        for (size_t i = 0; i < cycles.size(); ++i) {
          const auto* pixel = samples.data() + i * channels;
          require(channels < 3 || (pixel[0] == pixel[1] && pixel[1] == pixel[2]),
                  "{}: expected a grey correction, got a coloured pixel at row {}, column {}", path,
                  i / size_t(cycles.nx), i % size_t(cycles.nx));
          cycles.values[i] = float(pixel[0]) / full;
        }
      },
      picture->samples);
  return cycles;
}

PanelTables load_panel_tables(const std::string& lut, const std::string& correction, int levels) {
  PanelTables tables;
  if (!lut.empty()) tables.lut = load_level_table(lut);
  if (!correction.empty()) tables.correction = load_correction(correction, levels);
  return tables;
}

}  // namespace holotrace
