#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <string_view>

#include "holotrace/base/error.h"
#include "holotrace/base/message_text.h"
#include "holotrace/io/files/text.h"
#include "holotrace/io/mesh/mesh_formats.h"
#include "holotrace/io/mesh/obj_materials.h"
#include "holotrace/io/mesh/stored_colours.h"

namespace holotrace {
namespace {

constexpr std::array kinds{"vertex", "texture coordinate", "normal"};
constexpr int64_t none = -1;

// Keys of the format that are not read.
constexpr std::array free_forms{"vp",   "cstype", "deg",  "bmat", "step", "curv", "curv2", "surf", "parm",
                                "trim", "hole",   "scrv", "sp",   "end",  "con",  "bzp",   "bsp"};
constexpr std::array not_of_shapes{"s",         "bevel", "c_interp", "d_interp", "lod",    "mg",   "shadow_obj",
                                   "trace_obj", "ctech", "stech",    "usemap",   "maplib", "call", "csh"};

// Numbers of a position, a texture coordinate and a normal, from 0; −1: none.
using Corner = std::array<int64_t, 3>;

// The faces of one name and material.
struct Part {
  std::string name;
  size_t material = 0;  // number of its name
  std::vector<Corner> corners;
  std::vector<uint32_t> sizes;  // corners per face
};

class ObjReader {
 public:
  ObjReader(const std::string& path, Outside outside) : reader_(path, outside), path_(path) {
    materials_.materials.emplace_back();  // of faces without one
  }

  LoadedModel read() {
    const std::string text = read_lines(path_, UINT64_MAX);
    std::string joined;  // a line that goes on after a backslash
    for (std::string_view rest = text, line; next_line(rest, line);) {
      ++line_;
      if (!line.empty() && line.back() == '\\') {
        joined.append(line.substr(0, line.size() - 1)).push_back(' ');
        continue;
      }
      if (joined.empty()) {
        read_line(line);
      } else {
        read_line(joined.append(line));
        joined.clear();
      }
    }
    for (size_t kind = 0; kind < 3; ++kind)
      if (farthest_[kind].index > count(kind)) refuse(farthest_[kind].line, kind, farthest_[kind].index);
    first_.assign(positions_.size(), {});
    if (!colours_.values.empty()) colours_.values.resize(positions_.size(), no_colour);
    colours_.full = full_colour(colours_.values);
    for (size_t i = 0; i < parts_.size(); ++i) add(parts_[i], uint32_t(i + 1));
    if (parts_.empty()) reader_.leave_out(positions_.size());
    return reader_.finish(std::move(materials_.materials));
  }

 private:
  struct Farthest {
    int64_t index = 0;
    size_t line = 0;
  };

  int64_t count(size_t kind) const {
    return int64_t(std::array{positions_.size(), coordinates_.size(), normals_.size()}[kind]);
  }

  [[noreturn]] void refuse(size_t line, size_t kind, int64_t index) const {
    fail("{}:{}: expected {} indices from 1 to {} or as far back, got {}; export the mesh again", path_, line,
         kinds[kind], count(kind), index);
  }

  void read_line(std::string_view line) {
    std::string_view name = line;
    const std::string_view key = next_word(name), rest = without_comment(name);
    if (key.empty() || key[0] == '#') return;
    if (key == "v") {
      read_position(rest);
    } else if (key == "vt") {
      const size_t n = read_numbers(rest, 1);
      coordinates_.push_back({numbers_[0], n > 1 ? numbers_[1] : 0});
    } else if (key == "vn") {
      read_numbers(rest, 3);
      normals_.push_back({numbers_[0], numbers_[1], numbers_[2]});
    } else if (key == "f" || key == "fo") {
      read_face(rest);
    } else if (key == "l" || key == "p") {
      reader_.leave_out(1);
    } else if (key == "o" || key == "g") {
      name_ = name_without_comment(name);
      part_ = nullptr;
    } else if (key == "usemtl") {
      const auto [found, is_new] = material_numbers_.emplace(name_without_comment(name), material_names_.size());
      if (is_new) material_names_.push_back(found->first);
      material_ = found->second;
      part_ = nullptr;
    } else if (key == "mtllib") {
      read_obj_materials(reader_, std::string(name_without_comment(name)), materials_);
    } else if (std::find(free_forms.begin(), free_forms.end(), key) != free_forms.end()) {
      reader_.warn("free forms",
                   fmt::format("line {}: curved surfaces (\"{}\") are ignored; export it with polygons", line_, key));
    } else if (std::find(not_of_shapes.begin(), not_of_shapes.end(), key) == not_of_shapes.end()) {
      reader_.warn("unknown key",
                   fmt::format("line {}: the unknown key \"{}\" is ignored", line_, printable(key.substr(0, 40))));
    }
  }

  // Reads up to 7 numbers. @return how many there are
  size_t read_numbers(std::string_view rest, size_t least) {
    size_t n = 0;
    for (const char *at = rest.data(), *end = at + rest.size(); n < numbers_.size();) {
      while (at < end && (*at == ' ' || *at == '\t')) ++at;
      if (at < end && *at == '+') ++at;
      const auto [next, error] = std::from_chars(at, end, numbers_[n]);
      if (error == std::errc::invalid_argument) break;
      if (error == std::errc::result_out_of_range) numbers_[n] = std::numeric_limits<double>::infinity();
      at = next;
      ++n;
    }
    require(n >= least, "{}:{}: expected {} numbers, got \"{}\"", path_, line_, least, trimmed(rest.substr(0, 80)));
    return n;
  }

  // A position, in homogeneous coordinates with four numbers, or with a colour, which has three.
  void read_position(std::string_view rest) {
    const size_t n = read_numbers(rest, 3);
    Vec3 p{numbers_[0], numbers_[1], numbers_[2]};
    if (n == 4) p = p / numbers_[3];
    require(is_finite(p), "{}:{}: expected finite coordinates, got ({}, {}, {})", path_, line_, p.x, p.y, p.z);
    positions_.push_back(p);
    if (n < 6) return;
    colours_.values.resize(positions_.size(), no_colour);
    colours_.values.back() = {numbers_[n - 3], numbers_[n - 2], numbers_[n - 1]};
  }

  // Corners are 1, 1/2, 1//3 or 1/2/3.
  void read_face(std::string_view rest) {
    if (!part_) part_ = &part();
    const size_t before = part_->corners.size();
    size_t kind = 3;  // of the number that comes next; 3: none, between corners
    for (const char *at = rest.data(), *end = at + rest.size(); at < end;) {
      int64_t index = 0;
      const auto [next, error] = std::from_chars(at, end, index);
      if (error == std::errc::invalid_argument) {
        kind = *at == '/' && kind < 3 ? kind + 1 : 3;
        ++at;
        continue;
      }
      if (kind >= 3) {
        kind = 0;
        part_->corners.push_back({none, none, none});
      }
      if (error != std::errc() || index == 0 || index < -count(kind)) refuse(line_, kind, index);
      if (index > farthest_[kind].index) farthest_[kind] = {index, line_};
      part_->corners.back()[kind] = index > 0 ? index - 1 : count(kind) + index;
      at = next;
    }
    for (size_t i = before; i < part_->corners.size(); ++i)
      require(part_->corners[i][0] != none, "{}:{}: expected a vertex index in each corner, got none in corner {}",
              path_, line_, i - before + 1);
    if (const size_t size = part_->corners.size() - before; size >= 3) {
      part_->sizes.push_back(uint32_t(size));
    } else {
      part_->corners.resize(before);
      reader_.leave_out(1);
    }
  }

  // The faces of this name and material.
  Part& part() {
    const auto [found, is_new] = part_numbers_.emplace(std::pair(name_, material_), parts_.size());
    if (is_new) parts_.push_back({name_, material_, {}, {}});
    return parts_[found->second];
  }

  // Makes a mesh of a part. Corners that agree in all indices become one vertex: each position has a list of the
  // vertices that were made from it.
  void add(const Part& part, uint32_t number) {
    size_t material = material_of(part);
    const auto has_all = [&](size_t kind) {
      return std::all_of(part.corners.begin(), part.corners.end(), [&](const Corner& c) { return c[kind] != none; });
    };
    const bool has_coordinates =
        std::any_of(part.corners.begin(), part.corners.end(), [](const Corner& c) { return c[1] != none; });
    const bool has_normals = has_all(2);
    const bool has_colours = !colours_.values.empty() &&
                             std::any_of(part.corners.begin(), part.corners.end(),
                                         [&](const Corner& c) { return is_finite(colours_.values[size_t(c[0])]); });
    reader_.reserve(part.corners.size(), part.corners.size());
    // Colours multiply that of the material. Without a material they are all there is.
    const Vec3 plain = material == 0 ? DiffuseMaterial{}.reflectance : Vec3{1, 1, 1};
    if (has_colours && material == 0) material = white();
    Mesh mesh;
    mesh.name = part.name;
    mesh.material = int(material);
    std::vector<Corner> made;
    std::vector<uint32_t> next;  // vertex made before from the same position; UINT32_MAX: none
    const auto vertex_of = [&](Corner corner) {
      if (!has_normals) corner[2] = none;
      First& first = first_[size_t(corner[0])];
      if (first.part != number) first = {number, UINT32_MAX};
      int steps = 0;  // a file may have any number of corners at a position: vertices are then made twice
      for (uint32_t v = first.vertex; v != UINT32_MAX && steps < 64; v = next[v], ++steps)
        if (made[v] == corner) return v;
      const auto vertex = uint32_t(made.size());
      made.push_back(corner);
      next.push_back(first.vertex);
      first.vertex = vertex;
      mesh.positions.push_back(positions_[size_t(corner[0])]);
      if (has_coordinates)
        mesh.texture_coordinates.push_back(corner[1] == none ? Vec2{0, 0} : coordinates_[size_t(corner[1])]);
      if (has_normals) mesh.normals.push_back(normals_[size_t(corner[2])]);
      if (has_colours) mesh.colours.push_back(linear_colour(colours_, size_t(corner[0]), plain));
      return vertex;
    };
    std::vector<uint32_t> face;
    std::vector<Vec3> outline;
    std::vector<std::array<uint32_t, 3>> triangles;
    size_t at = 0;
    for (const uint32_t size : part.sizes) {
      face.clear(), outline.clear(), triangles.clear();
      for (uint32_t i = 0; i < size; ++i, ++at) {
        face.push_back(vertex_of(part.corners[at]));
        outline.push_back(positions_[size_t(part.corners[at][0])]);
      }
      triangulate(outline, triangles);
      for (const auto& [a, b, c] : triangles) mesh.triangles.push_back({face[a], face[b], face[c]});
    }
    reader_.add(std::move(mesh), materials_.materials[material], Frame{});
  }

  // The material of faces that have colours only.
  size_t white() {
    if (white_ == 0) {
      white_ = materials_.materials.size();
      materials_.materials.emplace_back().material = DiffuseMaterial{{1, 1, 1}};
    }
    return white_;
  }

  // A part may be before the file of its material. Names of materials may end with a comment.
  size_t material_of(const Part& part) {
    const std::string& name = material_names_[part.material];
    const auto found = materials_.numbers.find(name);
    if (found != materials_.numbers.end()) return found->second;
    const auto without = materials_.numbers.find(trimmed(without_comment(name)));
    if (without != materials_.numbers.end()) return without->second;
    if (!name.empty() && !materials_.is_incomplete)
      reader_.warn("unknown material",
                   fmt::format("the material \"{}\" is in none of its files of materials (mtllib); it is shown grey",
                               printable(name)));
    return 0;
  }

  struct First {
    uint32_t part = 0, vertex = UINT32_MAX;
  };

  ModelReader reader_;
  std::string path_;
  size_t line_ = 0;
  std::array<double, 7> numbers_{};
  std::vector<Vec3> positions_, normals_;
  StoredColours colours_;
  std::vector<Vec2> coordinates_;
  std::array<Farthest, 3> farthest_{};
  ObjMaterials materials_;
  std::string name_;
  std::vector<std::string> material_names_{""};  // of usemtl; "": none
  std::map<std::string, size_t, std::less<>> material_numbers_;
  size_t material_ = 0, white_ = 0;
  std::vector<Part> parts_;
  std::map<std::pair<std::string, size_t>, size_t> part_numbers_;
  Part* part_ = nullptr;
  std::vector<First> first_;
};

}  // namespace

LoadedModel load_obj_mesh(const std::string& path, Outside outside) { return ObjReader(path, outside).read(); }

}  // namespace holotrace
