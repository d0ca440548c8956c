#include <gtest/gtest.h>
#include <zlib.h>

#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "holotrace/base/random.h"
#include "holotrace/io/files/file.h"
#include "holotrace/io/scene/cells_file.h"
#include "holotrace/io/scene/nanovdb_file.h"
#include "support/data_files.h"
#include "support/error_of.h"
#include "support/temporary.h"

// Files of NanoVDB. Those of tests/data_files were written by NanoVDB 32.4 itself (GridBuilder, ZIP): in a box of voxels, those with
// (x + y + z) % 3 = 0 have the value shift + (x + 100) + 2(y + 100) + 3(z + 100), others are background, 0.

namespace holotrace {
namespace {

struct VoxelBox {
  int low[3], high[3];
};

/// Expects the values of a grid on the cells of a box.
void expect_cells(const Cells& cells, const VoxelBox& of_cells, const VoxelBox& active, int shift) {
  const auto& [a, b] = of_cells;
  const int nx = b[0] - a[0] + 1, ny = b[1] - a[1] + 1, nz = b[2] - a[2] + 1;
  ASSERT_EQ(cells.planes, nz);
  ASSERT_EQ(cells.values->nx, nx);
  ASSERT_EQ(cells.values->ny, ny * nz);
  int wrong = 0;
  for (int z = a[2]; z <= b[2]; ++z)
    for (int y = a[1]; y <= b[1]; ++y)
      for (int x = a[0]; x <= b[0]; ++x) {
        const int place[3] = {x, y, z};
        bool is_active = (x + y + z) % 3 == 0;
        for (int i = 0; i < 3; ++i) is_active = is_active && place[i] >= active.low[i] && place[i] <= active.high[i];
        const int expected = is_active ? shift + x + 100 + 2 * (y + 100) + 3 * (z + 100) : 0;
        wrong += (*cells.values)((z - a[2]) * ny + y - a[1], x - a[0]) != float(expected);
      }
  EXPECT_EQ(wrong, 0);
}

TEST(NanoVdb, GridsOfOneFileHaveTheSameCells) {
  const std::string path = test::data_file("two_grids.nvdb");
  const VoxelBox both{{-5, -2, -9}, {12, 9, 4}};
  expect_cells(load_nanovdb(path, "density"), both, {{-5, -2, -9}, {6, 9, 4}}, 0);
  expect_cells(load_cells(path, "temperature"), both, {{-3, -2, -1}, {12, 3, 4}}, 1000);
  EXPECT_EQ(
      error_of([&] { load_nanovdb(path, "heat"); }),
      path +
          ": expected a grid \"heat\" of 32-bit floating-point numbers, got \"density\", \"temperature\"; rename it, or "
          "write one alone");
}

// Its voxels lie on both sides of 4096, where nodes of the root meet. The one grid of a file may have any name.
TEST(NanoVdb, NodesFarFromTheOriginAreRead) {
  const VoxelBox box{{4090, -4098, 100}, {4100, -4094, 104}};
  expect_cells(load_nanovdb(test::data_file("far_grid.nvdb"), "density"), box, box, 0);
}

/// The same file without compression: one grid.
std::string without_compression(const std::string& zipped) {
  constexpr size_t entry = 16, codec = 168;
  uint64_t size, characters = 0, packed;
  std::memcpy(&size, zipped.data() + entry, 8);
  std::memcpy(&characters, zipped.data() + entry + 136, 4);
  const size_t data = entry + 176 + characters;
  std::memcpy(&packed, zipped.data() + data, 8);
  std::string grid(size, '\0');
  uLongf count = size;
  EXPECT_EQ(uncompress(reinterpret_cast<Bytef*>(grid.data()), &count,
                       reinterpret_cast<const Bytef*>(zipped.data() + data + 8), uLong(packed)),
            Z_OK);
  std::string head = zipped.substr(0, data);
  std::memcpy(head.data() + entry + 8, &size, 8);
  head[entry + codec] = 0;
  return head + grid;
}

// Every damage is an error or changes values, and nothing else. Bytes that are not 0 are changed, which are those of the structure: sizes,
// boxes, masks, offsets.
TEST(NanoVdb, DamagedFilesAreErrors) {
  const std::string good = read_text(test::data_file("far_grid.nvdb")), plain = without_compression(good);
  const VoxelBox box{{4090, -4098, 100}, {4100, -4094, 104}};
  expect_cells(load_nanovdb(test::make_file("plain.nvdb", plain), "density"), box, box, 0);
  CounterRandom random(1, 0, 0);
  const auto load = [](const std::string& bytes) {
    const std::string path = test::make_file("damaged.nvdb", bytes);
    try {
      load_nanovdb(path, "density");
    } catch (const Error&) {
    }
  };
  std::vector<size_t> of_structure;
  for (size_t i = 0; i < plain.size(); ++i)
    if (plain[i] != 0) of_structure.push_back(i);
  for (int i = 0; i < 80; ++i) {
    std::string bytes = plain;
    const size_t reach = i % 2 ? of_structure.size() : 300;  // every other time in the headers and the root
    for (int n = 0; n < 1 + i % 3; ++n)
      bytes[of_structure[size_t(random.uniform() * double(reach))]] = char(256 * random.uniform());
    load(bytes);
    load(good.substr(0, size_t(random.uniform() * double(good.size()))));
  }
  const auto error_with = [&](const std::string& bytes) {
    const std::string path = test::make_file("damaged.nvdb", bytes);
    return replace_all(error_of([&] { load_nanovdb(path, "density"); }), path, "FILE");
  };
  std::string other = good;
  other[0] = 'X';
  EXPECT_EQ(error_with(other), "FILE: expected a file of NanoVDB, got another kind of file");
  other = good;
  other[16 + 168] = 2;  // the codec of its grid
  EXPECT_EQ(
      error_with(other),
      "FILE: expected a NanoVDB file without compression or with ZIP, got one with Blosc; convert it: nanovdb_convert --zip "
      "OLD.nvdb NEW.nvdb");
  other = good;
  other[100] = 1;  // the highest byte of the last active voxel's x
  EXPECT_NE(error_with(other), "");
  EXPECT_NE(error_with(good.substr(0, 1000)), "");
  EXPECT_EQ(error_with(""), "FILE: expected grids in a file of NanoVDB, got none");
}

TEST(NanoVdb, OpenVdbFilesAreToBeConverted) {
  const std::string path = test::make_file("smoke.vdb", " BDV");
  EXPECT_EQ(
      error_of([&] { load_cells(path, "density"); }),
      path +
          ": expected a grid of cells .npy or .nvdb, got an OpenVDB file; convert it: nanovdb_convert OLD.vdb NEW.nvdb");
}

}  // namespace
}  // namespace holotrace
