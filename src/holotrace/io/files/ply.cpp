#include "holotrace/io/files/ply.h"

#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <optional>
#include <sstream>
#include <string_view>

#include "holotrace/base/error.h"
#include "holotrace/io/files/text.h"

namespace holotrace {
namespace {

enum class PlyKind { int8, uint8, int16, uint16, int32, uint32, float32, float64 };
enum class Format { ascii, little_endian, big_endian };

struct Property {
  std::string name;
  PlyKind kind = PlyKind::float32;
  std::optional<PlyKind> list_count;  // type of a list's length
};

struct Element {
  std::string name;
  uint64_t count = 0;
  std::vector<Property> properties;
};

size_t size_of(PlyKind kind) {
  constexpr std::array<size_t, 8> sizes{1, 1, 2, 2, 4, 4, 4, 8};
  return sizes[size_t(kind)];
}

// The largest value of an integer type; for floating-point types 1, the largest value of a colour.
double largest_of(PlyKind kind) {
  constexpr std::array<double, 8> values{127, 255, 32767, 65535, 2147483647, 4294967295, 1, 1};
  return values[size_t(kind)];
}

std::optional<PlyKind> kind_from(std::string_view name) {
  struct Name {
    std::string_view old_name, name;
  };
  constexpr std::array<Name, 8> names{{{"char", "int8"},
                                       {"uchar", "uint8"},
                                       {"short", "int16"},
                                       {"ushort", "uint16"},
                                       {"int", "int32"},
                                       {"uint", "uint32"},
                                       {"float", "float32"},
                                       {"double", "float64"}}};
  for (size_t i = 0; i < names.size(); ++i)
    if (name == names[i].old_name || name == names[i].name) return PlyKind(i);
  return std::nullopt;
}

struct Header {
  Format format = Format::ascii;
  std::vector<std::string> comments;
  std::vector<Element> elements;
  size_t data_begin = 0;
  size_t lines = 0;
};

Property read_property(std::istringstream& words, const std::string& path, size_t line) {
  const auto next_kind = [&] {
    std::string word;
    words >> word;
    const auto kind = kind_from(word);
    if (!kind) fail("{}:{}: expected a PLY type such as float or uchar, got \"{}\"", path, line, word);
    return *kind;
  };
  Property property;
  const auto begin = words.tellg();
  std::string word;
  words >> word;
  if (word == "list") {
    property.list_count = next_kind();
  } else {
    words.seekg(begin);
  }
  property.kind = next_kind();
  if (!(words >> property.name)) fail("{}:{}: expected the name of a PLY property, got none", path, line);
  return property;
}

Header read_header(const std::string& bytes, const std::string& path) {
  Header header;
  bool has_format = false;
  const size_t begin = begin_of_text(bytes, path);
  // Numbers in binary may begin with the byte of "\n", so the first line tells whether all end with "\r" alone.
  const size_t first_end = bytes.find_first_of("\r\n", begin);
  const bool are_returns = first_end != std::string::npos && bytes[first_end] == '\r' && bytes[first_end + 1] != '\n';
  for (size_t at = begin; at < bytes.size();) {
    const size_t end = bytes.find(are_returns ? '\r' : '\n', at);
    if (end == std::string::npos) break;
    const std::string text(trimmed(std::string_view(bytes).substr(at, end - at)));
    at = end + 1;
    const size_t line = ++header.lines;
    if (line == 1) {
      require(text == "ply", "{}:1: expected a PLY file, got other bytes; its first line must be \"ply\"", path);
      continue;
    }
    std::istringstream words(text);
    std::string word;
    words >> word;
    if (word.starts_with("#")) continue;
    if (word == "comment" || word == "obj_info") {
      header.comments.push_back(text.size() > word.size() ? text.substr(word.size() + 1) : "");
    } else if (word == "format") {
      words >> word;
      has_format = true;
      if (word == "ascii")
        header.format = Format::ascii;
      else if (word == "binary_little_endian")
        header.format = Format::little_endian;
      else if (word == "binary_big_endian")
        header.format = Format::big_endian;
      else
        fail("{}:{}: expected the format ascii, binary_little_endian or binary_big_endian, got \"{}\"", path, line,
             word);
    } else if (word == "element") {
      Element element;
      if (!(words >> element.name >> element.count))
        fail("{}:{}: expected \"element NAME COUNT\", got \"{}\"", path, line, text);
      header.elements.push_back(element);
    } else if (word == "property") {
      require(!header.elements.empty(), "{}:{}: expected an element before the first property", path, line);
      header.elements.back().properties.push_back(read_property(words, path, line));
    } else if (word == "end_header") {
      require(has_format, "{}: expected a line \"format …\" in the PLY header, which is missing", path);
      header.data_begin = at;
      return header;
    } else if (!word.empty()) {
      fail("{}:{}: expected a line of a PLY header, got \"{}\"", path, line, text);
    }
  }
  if (header.lines == 0 || bytes.compare(begin, 3, "ply") != 0)
    fail("{}:1: expected a PLY file, got other bytes; its first line must be \"ply\"", path);
  fail("{}: expected \"end_header\" in the PLY header, but the file ends before it; write it again", path);
}

// Reads the numbers after the header one by one, in any format.
class Numbers {
 public:
  Numbers(const std::string& bytes, const Header& header, const std::string& path)
      : at_(bytes.data() + header.data_begin),
        end_(bytes.data() + bytes.size()),
        format_(header.format),
        line_(header.lines + 1),
        path_(path) {}

  double next(PlyKind kind) { return format_ == Format::ascii ? next_word() : next_bytes(kind); }
  size_t bytes_left() const { return size_t(end_ - at_); }

 private:
  [[noreturn]] void fail_truncated() const {
    fail("{}: expected more numbers than the file holds; it is truncated or its header is wrong", path_);
  }

  double next_word() {
    for (; at_ < end_ && (*at_ == ' ' || *at_ == '\t' || *at_ == '\n' || *at_ == '\r'); ++at_) line_ += *at_ == '\n';
    if (at_ == end_) fail_truncated();
    if (*at_ == '+') ++at_;
    double value = 0;
    const auto [next, error] = std::from_chars(at_, end_, value);
    const bool ends = next == end_ || *next == ' ' || *next == '\t' || *next == '\n' || *next == '\r';
    // Numbers outside the range of a double are passed on; the checks of the values report them.
    if ((error != std::errc() && error != std::errc::result_out_of_range) || !ends) {
      const char* stop = at_;
      while (stop < end_ && stop < at_ + 40 && *stop > ' ') ++stop;
      fail("{}:{}: expected a number, got \"{}\"", path_, line_, std::string_view(at_, size_t(stop - at_)));
    }
    at_ = next;
    return value;
  }

  template <class T>
  static double as(const unsigned char* bytes) {
    T value;
    std::memcpy(&value, bytes, sizeof value);
    return double(value);
  }

  double next_bytes(PlyKind kind) {
    const size_t size = size_of(kind);
    if (bytes_left() < size) fail_truncated();
    std::array<unsigned char, 8> bytes{};
    const bool swap = (format_ == Format::big_endian) == (std::endian::native == std::endian::little);
    for (size_t i = 0; i < size; ++i) bytes[swap ? size - 1 - i : i] = static_cast<unsigned char>(at_[i]);
    at_ += size;
    switch (kind) {
      case PlyKind::int8:
        return as<int8_t>(bytes.data());
      case PlyKind::uint8:
        return as<uint8_t>(bytes.data());
      case PlyKind::int16:
        return as<int16_t>(bytes.data());
      case PlyKind::uint16:
        return as<uint16_t>(bytes.data());
      case PlyKind::int32:
        return as<int32_t>(bytes.data());
      case PlyKind::uint32:
        return as<uint32_t>(bytes.data());
      case PlyKind::float32:
        return as<float>(bytes.data());
      case PlyKind::float64:
        return as<double>(bytes.data());
    }
    return 0;
  }

  const char* at_;
  const char* end_;
  Format format_;
  size_t line_;
  const std::string& path_;
};

// The smallest possible number of bytes of an element's row.
size_t least_row_size(const Element& element, Format format) {
  size_t size = 0;
  for (const Property& p : element.properties)
    size += format == Format::ascii ? 1 : size_of(p.list_count.value_or(p.kind));
  return size;
}

}  // namespace

const std::vector<double>* PlyColumns::find(const std::string& name) const {
  const auto found = places.find(name);
  return found == places.end() ? nullptr : &columns[found->second];
}

const std::vector<double>& PlyColumns::column(const std::string& name) const {
  const std::vector<double>* found = find(name);
  if (!found) fail("{}: expected the property \"{}\" of the element \"vertex\", which is missing", path, name);
  return *found;
}

double PlyColumns::largest_of(const std::string& name) const {
  const auto found = places.find(name);
  return found == places.end() ? 0 : largest[found->second];
}

PlyVertices read_ply(const std::string& path, bool with_faces) {
  check_file_exists(path, "a PLY file");
  const std::string bytes = read_text(path);
  const Header header = read_header(bytes, path);
  PlyVertices vertices;
  vertices.path = vertices.faces.path = path;
  vertices.comments = header.comments;

  bool has_vertices = false;
  Numbers numbers(bytes, header, path);
  for (const Element& element : header.elements) {
    const size_t row = least_row_size(element, header.format);
    if (row == 0) continue;
    require(element.count <= numbers.bytes_left() / row,
            "{}: expected {} of the element \"{}\", but the file is truncated or its header is wrong", path,
            element.count, element.name);
    const bool are_vertices = element.name == "vertex", are_faces = with_faces && element.name == "face",
               are_strips = with_faces && element.name == "tristrips";
    PlyColumns* columns = are_vertices ? &vertices : are_faces ? &vertices.faces : nullptr;
    require(!columns || (columns->count == 0 && columns->names.empty()),
            "{}: expected one element \"{}\" in the PLY file, got two; export it again", path, element.name);
    has_vertices = has_vertices || are_vertices;
    const bool is_number_of_colours = element.name == "color";  // in files of the OpenHolo library
    if (!columns && !are_strips && !is_number_of_colours) vertices.other_elements.push_back(element.name);
    if (columns) {
      columns->count = element.count;
      for (const Property& p : element.properties)
        if (!p.list_count) {
          columns->places.emplace(p.name, columns->names.size());
          columns->names.push_back(p.name);
          columns->largest.push_back(largest_of(p.kind));
          columns->columns.emplace_back().reserve(element.count);
        }
    }
    for (uint64_t i = 0; i < element.count; ++i) {
      size_t column = 0;
      for (const Property& p : element.properties) {
        const double value = numbers.next(p.list_count.value_or(p.kind));
        if (p.list_count) {
          require(value >= 0 && value <= double(numbers.bytes_left()) && value < 0x1p32 && value == std::floor(value),
                  "{}: expected the length of a list in the element \"{}\", got {}", path, element.name, value);
          const bool are_indices = p.name.starts_with("vertex_ind");
          PlyLists* lists = !are_faces             ? nullptr
                            : are_indices          ? &vertices.corners
                            : p.name == "texcoord" ? &vertices.coordinates
                                                   : nullptr;
          std::vector<double>* items = lists ? &lists->items : are_strips && are_indices ? &vertices.strips : nullptr;
          if (lists) lists->sizes.push_back(uint32_t(value));
          if (items == &vertices.strips && !items->empty()) items->push_back(-1);
          for (auto n = uint64_t(value); n > 0; --n) {
            const double item = numbers.next(p.kind);
            if (items) items->push_back(item);
          }
        } else if (columns) {
          columns->columns[column++].push_back(value);
        }
      }
    }
    if (has_vertices && !with_faces) return vertices;
  }
  if (has_vertices) return vertices;
  fail("{}: expected an element \"vertex\" in the PLY file, got none", path);
}

}  // namespace holotrace
