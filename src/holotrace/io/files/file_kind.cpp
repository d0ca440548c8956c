#include "holotrace/io/files/file_kind.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <string_view>

#include "holotrace/io/files/file.h"

namespace holotrace {
namespace {

using namespace std::string_view_literals;

std::string first_bytes(const std::string& path) {
  std::string bytes(4096, '\0');
  std::ifstream file(path, std::ios::binary);
  file.read(bytes.data(), std::streamsize(bytes.size()));
  bytes.resize(size_t(file.gcount()));
  return bytes;
}

bool is_text(std::string_view bytes) {
  return std::none_of(bytes.begin(), bytes.end(),
                      [](char c) { return (c >= 0 && c < ' ' && c != '\t' && c != '\r' && c != '\n') || c == 127; });
}

struct Kind {
  std::string_view begin;
  const char* name;
};

constexpr const char* picture_use = ", a picture, which `holotrace encode` and `holotrace compare` take";
constexpr const char* field_use = ", which `holotrace encode`, `holotrace propagate` and `holotrace compare` take";
constexpr const char* model_use = ", a model, which `holotrace run` and `holotrace render` take";

constexpr std::array<Kind, 7> pictures{{{"\x89PNG"sv, "a PNG"},
                                        {"\xff\xd8\xff"sv, "a JPEG"},
                                        {"\x76\x2f\x31\x01"sv, "an EXR"},
                                        {"#?RADIANCE"sv, "an HDR"},
                                        {"II*\0"sv, "a TIFF"},
                                        {"MM\0*"sv, "a TIFF"},
                                        {"GIF8"sv, "a GIF"}}};
constexpr std::array<Kind, 2> fields{
    {{"\x93NUMPY"sv, "a field in NPY"}, {"\x89HDF"sv, "a field or focal stack in HDF5"}}};
constexpr std::array<Kind, 5> others{{{"PK\x03\x04"sv, "a ZIP archive; unpack it"},
                                      {"\x1f\x8b"sv, "a gzip archive; unpack it"},
                                      {"%PDF"sv, "a PDF"},
                                      {"\x7f"
                                       "ELF"sv,
                                       "a program"},
                                      {"<html"sv, "a web page; was the file downloaded?"}}};

}  // namespace

bool is_text_file(const std::string& path) { return is_text(first_bytes(path)); }

std::string known_kind_of_file(const std::string& path) {
  const std::string bytes = first_bytes(path);
  const std::string_view text = bytes;
  const auto has = [&](std::string_view word) { return text.find(word) != std::string_view::npos; };
  for (const Kind& kind : pictures)
    if (text.starts_with(kind.begin)) return std::string(kind.name) + picture_use;
  for (const Kind& kind : fields)
    if (text.starts_with(kind.begin)) return std::string(kind.name) + field_use;
  for (const Kind& kind : others)
    if (text.starts_with(kind.begin)) return kind.name;
  if (text.starts_with("ply"))
    return has(" amplitude\n") && has(" phase\n") ? "sources of waves, which `holotrace field` takes"
                                                  : std::string("a PLY file") + model_use;
  if (text.starts_with("glTF") || has("\"asset\"")) return std::string("a glTF file") + model_use;
  if (has("<COLLADA")) return std::string("a COLLADA file") + model_use;
  if (bytes.empty()) return "an empty file";
  if (text.front() == '{') return "a JSON file";
  if (extension_of(path) == ".toml") return "a scene or panel file, which `holotrace run` and --slm take";
  return "";
}

std::string kind_of_file(const std::string& path) {
  const std::string known = known_kind_of_file(path), extension = extension_of(path);
  if (!known.empty()) return known;
  return extension.empty() ? "another kind of file" : "a file " + extension;
}

}  // namespace holotrace
