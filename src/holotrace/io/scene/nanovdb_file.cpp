#include "holotrace/io/scene/nanovdb_file.h"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <limits>
#include <memory>
#include <set>
#include <string_view>
#include <utility>
#include <vector>

#include "holotrace/base/error.h"
#include "holotrace/base/machine.h"
#include "holotrace/io/files/file.h"

namespace holotrace {
namespace {

using Voxel = std::array<int64_t, 3>;  // x, y, z

/// Bytes of which each is read only if it is there.
struct CheckedBytes {
  std::string_view bytes;
  const std::string& path;

  void require_bytes(uint64_t at, uint64_t count) const {
    require(
        at <= bytes.size() && count <= bytes.size() - at,
        "{}: expected {} bytes at byte {} of a NanoVDB grid, got a file that is truncated or damaged; write it again",
        path, count, at);
  }
  template <class T>
  T read(uint64_t at) const {
    require_bytes(at, sizeof(T));
    T value;
    std::memcpy(&value, bytes.data() + at, sizeof value);
    return value;
  }
  bool bit(uint64_t at, uint64_t index) const { return read<uint8_t>(at + index / 8) >> index % 8 & 1; }
};

constexpr uint64_t magic = 0x304244566f6e614e;  // "NanoVDB0"

/// A grid of numbers in a file.
struct StoredGrid {
  std::string name;
  std::string bytes;
  Voxel first, last;  // of the active voxels
};

/// The layout of a kind of nodes with 32-bit numbers [bytes].
struct NodeLayout {
  uint64_t value_mask, child_mask, table, size;
  int bits, of_child;  // log₂ of the children along an axis, and of the voxels of one
};
constexpr NodeLayout upper_node{32, 4128, 8256, 270400, 5, 7}, lower_node{32, 544, 1088, 33856, 4, 3};
constexpr uint64_t leaf_table = 96, leaf_size = 2144;

/// Fills dense cells from the tree of a grid.
class GridReader {
 public:
  GridReader(const StoredGrid& grid, const std::string& path, Voxel first, Voxel last, Image& cells)
      : in_{grid.bytes, path}, first_(first), last_(last), cells_(cells) {}

  void read() {
    constexpr uint64_t tree = 672, root_size = 64, tile_size = 32;
    const uint64_t root = sum(tree, in_.read<uint64_t>(tree + 24));
    const auto background = in_.read<float>(sum(root, 28));
    std::fill(cells_.values.begin(), cells_.values.end(), background);
    const auto tiles = in_.read<uint32_t>(sum(root, 24));
    in_.require_bytes(sum(root, root_size), uint64_t(tiles) * tile_size);
    std::set<uint64_t> known;
    for (uint64_t t = 0; t < tiles; ++t) {
      const uint64_t tile = root + root_size + t * tile_size, key = in_.read<uint64_t>(tile);
      require(known.insert(key).second, "{}: expected each tile of a NanoVDB grid once; the file is damaged", in_.path);
      const auto place = [&](int shift) {  // 21 bits of a signed number of 20
        const auto steps = int64_t(key >> shift & 0x1fffff);
        return int64_t(int32_t(uint32_t(steps) << 12));
      };
      const Voxel origin{place(42), place(21), place(0)};
      const auto child = in_.read<int64_t>(tile + 8);
      if (child == 0)
        fill(origin, 12, in_.read<float>(tile + 20));
      else
        read_node(sum(root, uint64_t(child)), origin, upper_node);
    }
  }

 private:
  /// A place in the bytes, of which sums do not wrap around.
  uint64_t sum(uint64_t at, uint64_t offset) const {
    in_.require_bytes(at, 0);
    require(offset <= in_.bytes.size(),
            "{}: expected a node of a NanoVDB grid in its {} bytes, got the offset {}; the file is damaged", in_.path,
            in_.bytes.size(), offset);
    return at + offset;
  }

  /// Whether a cube of voxels touches the cells.
  bool is_wanted(const Voxel& origin, int bits) const {
    for (size_t a = 0; a < 3; ++a)
      if (origin[a] > last_[a] || origin[a] + (int64_t(1) << bits) - 1 < first_[a]) return false;
    return true;
  }

  void read_node(uint64_t node, const Voxel& origin, const NodeLayout& layout) {
    if (!is_wanted(origin, layout.bits + layout.of_child)) return;
    in_.require_bytes(node, layout.size);
    const int64_t side = int64_t(1) << layout.bits;
    for (int64_t n = 0; n < side * side * side; ++n) {
      const auto index = uint64_t(n);
      const Voxel child{origin[0] + ((n >> 2 * layout.bits) << layout.of_child),
                        origin[1] + ((n >> layout.bits & (side - 1)) << layout.of_child),
                        origin[2] + ((n & (side - 1)) << layout.of_child)};
      if (!is_wanted(child, layout.of_child)) continue;
      const uint64_t entry = node + layout.table + 8 * index;
      if (!in_.bit(node + layout.child_mask, index)) {
        fill(child, layout.of_child, in_.read<float>(entry));
        continue;
      }
      const uint64_t next = sum(node, in_.read<uint64_t>(entry));
      if (layout.of_child == lower_node.of_child)
        read_leaf(next, child);
      else
        read_node(next, child, lower_node);
    }
  }

  void read_leaf(uint64_t leaf, const Voxel& origin) {
    in_.require_bytes(leaf, leaf_size);
    for_each_cell(origin, 3, [&](const Voxel& v, float& cell) {
      const auto n = uint64_t((v[0] & 7) << 6 | (v[1] & 7) << 3 | (v[2] & 7));
      cell = in_.read<float>(leaf + leaf_table + 4 * n);
    });
  }

  void fill(const Voxel& origin, int bits, float value) {
    for_each_cell(origin, bits, [&](const Voxel&, float& cell) { cell = value; });
  }

  /// Calls visit(voxel, cell) for the cells in a cube of voxels.
  template <class Visit>
  void for_each_cell(const Voxel& origin, int bits, const Visit& visit) {
    Voxel from, to;
    for (size_t a = 0; a < 3; ++a) {
      from[a] = std::max(origin[a], first_[a]);
      to[a] = std::min(origin[a] + (int64_t(1) << bits) - 1, last_[a]);
    }
    const int64_t rows = last_[1] - first_[1] + 1;
    for (int64_t z = from[2]; z <= to[2]; ++z)
      for (int64_t y = from[1]; y <= to[1]; ++y)
        for (int64_t x = from[0]; x <= to[0]; ++x)
          visit({x, y, z}, cells_(int((z - first_[2]) * rows + y - first_[1]), int(x - first_[0])));
  }

  CheckedBytes in_;
  Voxel first_, last_;
  Image& cells_;
};

/// The bytes of a grid, decompressed.
std::string unpacked(std::string_view packed, uint64_t size, uint16_t codec, const std::string& path) {
  if (codec == 0) return std::string(packed);
  require(codec == 1,
          "{}: expected a NanoVDB file without compression or with ZIP, got one with {}; convert it: nanovdb_convert "
          "--zip OLD.nvdb NEW.nvdb",
          path, codec == 2 ? "Blosc" : "an unknown one");
  const CheckedBytes in{packed, path};
  const auto count = in.read<uint64_t>(0);
  in.require_bytes(8, count);
  // Deflate packs at most 1032 bytes into one.
  require(size / 1032 <= count, "{}: expected {} bytes of a NanoVDB grid, got fewer; the file is damaged", path, size);
  std::string bytes(size, '\0');
  uLongf found = size;
  const int status = uncompress(reinterpret_cast<Bytef*>(bytes.data()), &found,
                                reinterpret_cast<const Bytef*>(packed.data() + 8), uLong(count));
  require(status == Z_OK && found == size,
          "{}: expected {} bytes of a NanoVDB grid by ZIP, got damaged ones; write it again", path, size);
  return bytes;
}

/// The grids of 32-bit numbers of a file.
std::vector<StoredGrid> stored_grids(const std::string& path) {
  const std::string file = read_text(path);
  const CheckedBytes in{file, path};
  std::vector<StoredGrid> grids;
  require(!file.empty(), "{}: expected grids in a file of NanoVDB, got none", path);
  for (uint64_t at = 0; at < file.size();) {  // segments
    require(in.read<uint64_t>(at) == magic, "{}: expected a file of NanoVDB, got another kind of file", path);
    const uint32_t version = in.read<uint32_t>(at + 8) >> 21;
    require(version == 32, "{}: expected version 32 of NanoVDB's format, got {}; write it with OpenVDB 9, 10 or 11",
            path, version);
    const auto count = in.read<uint16_t>(at + 12);
    at += 16;
    struct Entry {
      uint64_t size, in_file;
      uint32_t type;
      uint16_t codec;
      StoredGrid grid;
    };
    std::vector<Entry> entries;
    for (int n = 0; n < count; ++n) {
      constexpr uint64_t entry_size = 176;
      Entry entry{in.read<uint64_t>(at),
                  in.read<uint64_t>(at + 8),
                  in.read<uint32_t>(at + 32),
                  in.read<uint16_t>(at + 168),
                  {}};
      for (size_t a = 0; a < 3; ++a) {
        entry.grid.first[a] = in.read<int32_t>(at + 88 + 4 * a);
        entry.grid.last[a] = in.read<int32_t>(at + 100 + 4 * a);
      }
      const auto characters = in.read<uint32_t>(at + 136);
      in.require_bytes(at + entry_size, characters);
      entry.grid.name = std::string(file.data() + at + entry_size, characters).c_str();  // ends at its null character
      at += entry_size + characters;
      entries.push_back(std::move(entry));
    }
    for (Entry& entry : entries) {
      in.require_bytes(at, entry.in_file);
      constexpr uint32_t of_floats = 1;
      if (entry.type == of_floats) {
        require_memory(double(file.size()) + double(entry.size), path);
        entry.grid.bytes = unpacked(std::string_view(file).substr(at, entry.in_file), entry.size, entry.codec, path);
        grids.push_back(std::move(entry.grid));
      }
      at += entry.in_file;
    }
  }
  return grids;
}

}  // namespace

Cells load_nanovdb(const std::string& path, const std::string& name) {
  const std::vector<StoredGrid> grids = stored_grids(path);
  const auto named =
      std::find_if(grids.begin(), grids.end(), [&](const StoredGrid& grid) { return grid.name == name; });
  std::string names;
  for (const StoredGrid& grid : grids) names += (names.empty() ? "\"" : ", \"") + grid.name + "\"";
  require(named != grids.end() || grids.size() == 1,
          "{}: expected a grid \"{}\" of 32-bit floating-point numbers, got {}; rename it, or write one alone", path,
          name, names.empty() ? "none" : names);
  const StoredGrid& grid = named != grids.end() ? *named : grids.front();
  Voxel first = grid.first, last = grid.last;
  for (const StoredGrid& other : grids)
    for (size_t a = 0; a < 3; ++a) {
      first[a] = std::min(first[a], other.first[a]);
      last[a] = std::max(last[a], other.last[a]);
    }
  std::array<int64_t, 3> size;
  constexpr int64_t most = 1 << 15;
  for (size_t a = 0; a < 3; ++a) size[a] = last[a] - first[a] + 1;
  require(std::all_of(size.begin(), size.end(), [](int64_t n) { return n > 0 && n <= most; }) &&
              size[1] * size[2] <= std::numeric_limits<int>::max(),
          "{}: expected a box of active voxels, each side from 1 to {}, got {} x {} x {}", path, most, size[0], size[1],
          size[2]);
  require_memory(double(size[0]) * double(size[1]) * double(size[2]) * sizeof(float), path);
  Image cells(int(size[1] * size[2]), int(size[0]), 1);
  GridReader(grid, path, first, last, cells).read();
  return {std::make_shared<Image>(std::move(cells)), int(size[2])};
}

}  // namespace holotrace
