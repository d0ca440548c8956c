#include "holotrace/io/scene/cells_file.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <limits>
#include <memory>
#include <utility>

#include "holotrace/base/error.h"
#include "holotrace/base/machine.h"
#include "holotrace/io/files/file.h"
#include "holotrace/io/files/file_kind.h"
#include "holotrace/io/files/npy.h"
#include "holotrace/io/scene/nanovdb_file.h"

namespace holotrace {
namespace {

// A grid of float32 or float64, of the shape (planes, rows, columns).
Cells load_npy_cells(const std::string& path) {
  const std::string bytes = read_text(path);
  const NpyHeader header = read_npy_header(bytes, path);
  const bool is_single = header.dtype == "<f4";
  require(is_single || header.dtype == "<f8",
          "{}: expected float32 or float64 ('<f4' or '<f8'), got '{}'; convert it with numpy.astype", path,
          header.dtype);
  require(!header.fortran_order, "{}: expected an array in C order; write it with numpy.ascontiguousarray", path);
  constexpr int64_t most = 1 << 15;
  require(header.shape.size() == 3 &&
              std::all_of(header.shape.begin(), header.shape.end(), [](int64_t n) { return n > 0 && n <= most; }) &&
              header.shape[0] * header.shape[1] <= std::numeric_limits<int>::max(),
          "{}: expected the shape (planes, rows, columns), each from 1 to {}, got {}", path, most,
          format_shape(header.shape));
  const auto [planes, rows, columns] = std::array{header.shape[0], header.shape[1], header.shape[2]};
  const size_t count = size_t(planes * rows) * size_t(columns), sample = is_single ? 4 : 8;
  require(bytes.size() - header.data_begin == count * sample,
          "{}: expected {} bytes of samples for shape {}, got {}; the file is truncated or damaged, write it again",
          path, count * sample, format_shape(header.shape), bytes.size() - header.data_begin);
  require_memory(double(bytes.size()) + double(count) * sizeof(float), path);
  Image grid(int(planes * rows), int(columns), 1);
  for (size_t i = 0; i < count; ++i) {
    const char* from = bytes.data() + header.data_begin + i * sample;
    double value = 0;
    if (is_single) {
      float single;
      std::memcpy(&single, from, sizeof single);
      value = double(single);
    } else {
      std::memcpy(&value, from, sizeof value);
    }
    grid.values[i] = float(value);
  }
  return {std::make_shared<Image>(std::move(grid)), int(planes)};
}

}  // namespace

Cells load_cells(const std::string& path, const std::string& name) {
  check_file_exists(path, "a grid of cells");
  const std::string extension = extension_of(path);
  if (extension == ".nvdb") return load_nanovdb(path, name);
  require(
      extension != ".vdb",
      "{}: expected a grid of cells .npy or .nvdb, got an OpenVDB file; convert it: nanovdb_convert OLD.vdb NEW.nvdb",
      path);
  require(extension == ".npy", "{}: expected a grid of cells .npy or .nvdb, got {}", path, kind_of_file(path));
  return load_npy_cells(path);
}

}  // namespace holotrace
