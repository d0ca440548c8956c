#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <string_view>

#include "holotrace/base/error.h"
#include "holotrace/io/files/file.h"
#include "holotrace/io/mesh/mesh_formats.h"
#include "holotrace/io/mesh/obj_materials.h"

namespace holotrace {
namespace {

constexpr std::array kinds{"vertex", "texture coordinate", "normal"};
constexpr int64_t none = -1;

// Numbers of a position, a texture coordinate and a normal, from 0; −1: none.
using Corner = std::array<int64_t, 3>;

// The faces of one name and material.
struct Part {
  std::string name;
  size_t material = 0;
  std::vector<Corner> corners;
  std::vector<uint32_t> sizes;  // corners per face
};

class ObjReader {
 public:
  ObjReader(const std::string& path, Outside outside) : reader_(path, outside), path_(path) {
    materials_.materials.emplace_back();  // of faces without one
  }

  LoadedModel read() {
    const std::string text = read_text(path_);
    std::string joined;  // a line that goes on after a backslash
    for (size_t at = 0, end = 0; at < text.size(); at = end + 1) {
      end = std::min(text.find('\n', at), text.size());
      ++line_;
      std::string_view line = std::string_view(text).substr(at, end - at);
      if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
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
    for (size_t i = 0; i < parts_.size(); ++i) add(parts_[i], uint32_t(i + 1));
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
    line.remove_prefix(std::min(line.find_first_not_of(" \t"), line.size()));
    const std::string_view key = line.substr(0, line.find_first_of(" \t"));
    const std::string_view rest = line.substr(key.size());
    if (key == "v") {
      read_position(rest);
    } else if (key == "vt") {
      const size_t n = read_numbers(rest, 1);
      coordinates_.push_back({numbers_[0], n > 1 ? numbers_[1] : 0});
    } else if (key == "vn") {
      read_numbers(rest, 3);
      normals_.push_back({numbers_[0], numbers_[1], numbers_[2]});
    } else if (key == "f") {
      read_face(rest);
    } else if (key == "l" || key == "p") {
      reader_.leave_out(1);
    } else if (key == "o" || key == "g") {
      name_ = trimmed(rest);
      part_ = nullptr;
    } else if (key == "usemtl") {
      const auto found = materials_.numbers.find(trimmed(rest));
      material_ = found == materials_.numbers.end() ? 0 : found->second;
      part_ = nullptr;
    } else if (key == "mtllib") {
      read_obj_materials(reader_, trimmed(rest), materials_);
    }
  }

  static std::string trimmed(std::string_view text) {
    text.remove_prefix(std::min(text.find_first_not_of(" \t"), text.size()));
    return std::string(text.substr(0, text.find_last_not_of(" \t") + 1));
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
    if (n >= 6) colours_.push_back({numbers_[n - 3], numbers_[n - 2], numbers_[n - 1]});
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
    const auto has_all = [&](size_t kind) {
      return std::all_of(part.corners.begin(), part.corners.end(), [&](const Corner& c) { return c[kind] != none; });
    };
    const bool has_coordinates =
        std::any_of(part.corners.begin(), part.corners.end(), [](const Corner& c) { return c[1] != none; });
    const bool has_normals = has_all(2), has_colours = !colours_.empty() && colours_.size() == positions_.size();
    reader_.reserve(part.corners.size(), part.corners.size());
    Mesh mesh;
    mesh.name = part.name;
    mesh.material = int(part.material);
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
      if (has_colours) mesh.colours.push_back(linear(colours_[size_t(corner[0])]));
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
    reader_.add(std::move(mesh), materials_.materials[part.material], Frame{});
  }

  static Vec3 linear(Vec3 code) {
    const auto channel = [](double value) { return srgb_decode(value > 0 ? std::min(value, 1.0) : 0.0); };
    return {channel(code.x), channel(code.y), channel(code.z)};
  }

  struct First {
    uint32_t part = 0, vertex = UINT32_MAX;
  };

  ModelReader reader_;
  std::string path_;
  size_t line_ = 0;
  std::array<double, 7> numbers_{};
  std::vector<Vec3> positions_, colours_, normals_;
  std::vector<Vec2> coordinates_;
  std::array<Farthest, 3> farthest_{};
  ObjMaterials materials_;
  std::string name_;
  size_t material_ = 0;
  std::vector<Part> parts_;
  std::map<std::pair<std::string, size_t>, size_t> part_numbers_;
  Part* part_ = nullptr;
  std::vector<First> first_;
};

}  // namespace

LoadedModel load_obj_mesh(const std::string& path, Outside outside) { return ObjReader(path, outside).read(); }

}  // namespace holotrace
