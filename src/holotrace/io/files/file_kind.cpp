#include "holotrace/io/files/file_kind.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <filesystem>
#include <fstream>
#include <string_view>

#include "holotrace/io/files/file.h"
#include "holotrace/io/files/text.h"

namespace holotrace {
namespace {

using namespace std::string_view_literals;

// None of what is no file on a disk: to read from a pipe would wait for its writer.
std::string first_bytes(const std::string& path) {
  if (!is_file(path)) return "";
  std::string bytes(4096, '\0');
  std::ifstream file(path, std::ios::binary);
  file.read(bytes.data(), std::streamsize(bytes.size()));
  bytes.resize(size_t(file.gcount()));
  return bytes;
}

bool is_text(std::string_view bytes) {
  return std::none_of(bytes.begin(), bytes.end(),
                      [](unsigned char c) { return (c < ' ' && c != '\t' && c != '\r' && c != '\n') || c == 127; });
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
constexpr std::array<Kind, 3> fields{{{"\x93NUMPY"sv, "a field in NPY"},
                                      {"\x89HDF"sv, "a field, focal stack or light field in HDF5"},
                                      {"MATLAB 7.3"sv, "a MATLAB file in HDF5"}}};
// Formats of models that are read, and the extensions by which their readers are known.
struct ModelFormat {
  std::string_view begin;
  const char* extension;
  const char* name;
};
constexpr std::array model_formats{
    ModelFormat{"glTF"sv, ".glb", "a glTF file"},  ModelFormat{"ply\n"sv, ".ply", "a PLY file"},
    ModelFormat{"ply\r"sv, ".ply", "a PLY file"},  ModelFormat{"Kaydara FBX"sv, ".fbx", "an FBX file"},
    ModelFormat{"; FBX"sv, ".fbx", "an FBX file"}, ModelFormat{"OFF\n"sv, ".off", "an OFF file"},
    ModelFormat{"OFF\r"sv, ".off", "an OFF file"}};

constexpr std::array others{
    Kind{"PK\x03\x04"sv, "a ZIP archive; unpack it"},
    Kind{"\x1f\x8b"sv, "a gzip archive; unpack it"},
    Kind{"BZh"sv, "a bzip2 archive; unpack it"},
    Kind{"\xfd"
         "7zXZ"sv,
         "an xz archive; unpack it"},
    Kind{"7z\xbc\xaf"sv, "a 7z archive; unpack it"},
    Kind{"Rar!"sv, "a RAR archive; unpack it"},
    Kind{"\x28\xb5\x2f\xfd"sv,
         "a Zstandard archive; unpack it (Blender files are packed so, too; export them as .glb)"},
    Kind{"BLENDER"sv, "a Blender file; export it from Blender as glTF (.glb)"},
    Kind{"PXR-USDC"sv, "a USD scene; export it as glTF (.glb), as Blender does"},
    Kind{"#usda"sv, "a USD scene; export it as glTF (.glb), as Blender does"},
    Kind{"Ogawa"sv, "an Alembic scene; export it as glTF (.glb), as Blender does"},
    Kind{"#VRML"sv, "a VRML scene; export it as glTF (.glb) or PLY"},
    Kind{"ISO-10303-21"sv, "a STEP file; export it as STL or OBJ"},
    Kind{"3D Geometry File Format"sv, "a Rhino file; export it as OBJ or STL"},
    Kind{"AC10"sv, "a DWG drawing; export it as STL or OBJ"},
    Kind{"//Maya"sv, "a Maya scene; export it as FBX or OBJ"},
    Kind{"LASF"sv, "a LAS cloud of points; save it as PLY, as CloudCompare does"},
    Kind{"ASTM-E57"sv, "an E57 cloud of points; save it as PLY, as CloudCompare does"},
    Kind{"# .PCD"sv, "a PCD cloud of points; save it as PLY, as CloudCompare does"},
    Kind{"DRACO"sv, "a mesh packed by Draco; export it as glTF or PLY without compression"},
    Kind{"MATLAB 5.0"sv, "a MATLAB file of an older version; save it there with -v7.3"},
    Kind{"%PDF"sv, "a PDF"},
    Kind{"\x7f"
         "ELF"sv,
         "a program"},
    Kind{"<html"sv, "a web page; was the file downloaded?"},
    Kind{"<!DOCTYPE html"sv, "a web page; was the file downloaded?"},
    Kind{"<!doctype html"sv, "a web page; was the file downloaded?"}};

// The same of texts that have a word near their beginning.
constexpr std::array others_with{
    Kind{"<scene version"sv, "a Mitsuba scene; name its meshes (.obj, .ply) in a scene .toml"},
    Kind{"<X3D"sv, "an X3D scene; export it as glTF (.glb) or PLY"},
    Kind{"<svg"sv, "an SVG drawing; export it as PNG"},
    Kind{"WorldBegin"sv, "a pbrt scene; name its meshes (.ply) in a scene .toml"},
    Kind{"LookAt "sv, "a pbrt scene; name its meshes (.ply) in a scene .toml"},
    Kind{"Camera \"perspective\""sv, "a pbrt scene; name its meshes (.ply) in a scene .toml"}};

// The first bytes without a byte-order mark and blanks.
std::string_view without_mark(std::string_view bytes) {
  if (bytes.starts_with("\xef\xbb\xbf")) bytes.remove_prefix(3);
  bytes.remove_prefix(std::min(bytes.find_first_not_of(" \t\r\n"), bytes.size()));
  return bytes;
}

// Whether the first lines but comments are three or more numbers each.
bool are_points(std::string_view text) {
  std::string_view line;
  for (int lines = 0; lines < 3;) {
    if (!next_line(text, line)) return lines > 0;
    if (text.empty() && lines > 0) return true;  // which may be cut
    line = trimmed(without_comment(line));
    if (line.empty() || line.starts_with("//")) continue;
    std::string content(line);
    for (char& c : content)
      if (c == ',' || c == ';') c = ' ';
    std::string_view rest = content;
    int numbers = 0;
    for (std::string_view word = next_word(rest); !word.empty(); word = next_word(rest), ++numbers) {
      if (word.starts_with('+')) word.remove_prefix(1);
      double value = 0;
      const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
      if (error != std::errc() || end != word.data() + word.size()) return false;
    }
    if (numbers < 3) return false;
    ++lines;
  }
  return true;
}

std::string model_extension_by(std::string_view bytes) {
  const std::string_view text = without_mark(bytes);
  const auto has = [&](std::string_view word) { return text.find(word) != std::string_view::npos; };
  for (const ModelFormat& format : model_formats)
    if (text.starts_with(format.begin)) return format.extension;
  if (text.starts_with('{') && has("\"asset\"")) return ".gltf";
  if (text.starts_with('<') && has("<COLLADA")) return ".dae";
  return text.starts_with("solid") && has("facet") ? ".stl" : "";
}

}  // namespace

bool is_text_file(const std::string& path) { return is_text(first_bytes(path)); }

std::string model_extension_of(const std::string& path) { return model_extension_by(first_bytes(path)); }

bool is_lfs_pointer(const std::string& path) { return first_bytes(path).starts_with("version https://git-lfs"); }

std::string kind_by_bytes(const std::string& path) {
  const std::string bytes = first_bytes(path);
  if (bytes.empty()) return "an empty file";
  for (const Kind& kind : pictures)
    if (bytes.starts_with(kind.begin)) return std::string(kind.name) + picture_use;
  for (const Kind& kind : fields)
    if (bytes.starts_with(kind.begin)) return std::string(kind.name) + field_use;
  if (bytes.starts_with("\xff\xfe") || bytes.starts_with("\xfe\xff")) return "a text in UTF-16; save it as UTF-8";
  const std::string_view text = without_mark(bytes);
  const auto has = [&](std::string_view word) { return text.find(word) != std::string_view::npos; };
  for (const Kind& kind : others)
    if (text.starts_with(kind.begin)) return kind.name;
  if (const std::string model = model_extension_by(bytes); !model.empty()) {
    if (model == ".ply" && has(" amplitude\n") && has(" phase\n"))
      return "sources of waves, which `holotrace field` takes";
    for (const ModelFormat& format : model_formats)
      if (model == format.extension) return std::string(format.name) + model_use;
    return (model == ".gltf"  ? "a glTF file"
            : model == ".dae" ? "a COLLADA file"
                              : "an STL file") +
           std::string(model_use);
  }
  for (const Kind& kind : others_with)
    if (has(kind.begin)) return kind.name;
  if (text.starts_with('{')) return "a JSON file";
  if (are_points(text)) return "points as text; save them as PLY, as MeshLab and CloudCompare do";
  return "";
}

std::string known_kind_of_file(const std::string& path) {
  const std::string known = kind_by_bytes(path);
  if (known.empty() && extension_of(path) == ".toml")
    return "a scene or panel file, which `holotrace run` and --slm take";
  return known;
}

std::string kind_of_file(const std::string& path) {
  const std::string known = known_kind_of_file(path), extension = extension_of(path);
  if (!known.empty()) return known;
  return extension.empty() ? "another kind of file" : "a file " + extension;
}

}  // namespace holotrace
