#include <gif_lib.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <memory>
#include <unordered_map>
#include <vector>

#include "holotrace/base/error.h"
#include "holotrace/io/files/new_file.h"
#include "holotrace/io/picture/formats/formats.h"

namespace holotrace {
namespace {

/// A picture by at most 256 colours.
struct IndexedPicture {
  std::vector<std::array<uint8_t, 3>> palette;  ///< 1 to 256 colours R, G, B
  std::vector<uint8_t> indices;                 ///< [row][column]
};

using Colour = std::array<uint8_t, 3>;
constexpr size_t most_colours = 256;

// Colours in cells of 8 × 8 × 8 codes.
constexpr int cell_bits = 5, cells_per_side = 1 << cell_bits;
size_t cell_of(int r, int g, int b) {
  const int shift = 8 - cell_bits;
  return size_t((r >> shift) * cells_per_side + (g >> shift)) * cells_per_side + size_t(b >> shift);
}

struct Cell {
  size_t place = 0;  // of the cell in the cube
  double count = 0;
  std::array<double, 3> mean{};
};

bool is_exact(const std::vector<uint8_t>& colours, IndexedPicture& picture) {
  std::unordered_map<uint32_t, uint8_t> known;
  for (size_t i = 0; i < picture.indices.size(); ++i) {
    const Colour colour{colours[3 * i], colours[3 * i + 1], colours[3 * i + 2]};
    const uint32_t key = uint32_t(colour[0]) << 16 | uint32_t(colour[1]) << 8 | colour[2];
    const auto [found, is_new] = known.try_emplace(key, uint8_t(picture.palette.size()));
    if (is_new && picture.palette.size() == most_colours) return false;
    if (is_new) picture.palette.push_back(colour);
    picture.indices[i] = found->second;
  }
  return true;
}

std::vector<Cell> used_cells(const std::vector<uint8_t>& colours) {
  std::vector<Cell> all(size_t(1) << (3 * cell_bits));
  for (size_t i = 0; i + 3 <= colours.size(); i += 3) {
    Cell& cell = all[cell_of(colours[i], colours[i + 1], colours[i + 2])];
    ++cell.count;
    for (size_t c = 0; c < 3; ++c) cell.mean[c] += colours[i + c];
  }
  std::vector<Cell> used;
  for (size_t place = 0; place < all.size(); ++place)
    if (all[place].count > 0) {
      for (double& mean : all[place].mean) mean /= all[place].count;
      all[place].place = place;
      used.push_back(all[place]);
    }
  return used;
}

// A box of cells, and the colour in which it is largest: by its squared deviations.
struct Box {
  size_t begin = 0, end = 0, widest = 0;
  double spread = 0, count = 0;
  std::array<double, 3> mean{};
};

Box box_of(const std::vector<Cell>& cells, size_t begin, size_t end) {
  Box box{begin, end, 0, 0, 0, {}};
  std::array<double, 3> squares{};
  for (size_t i = begin; i < end; ++i) {
    box.count += cells[i].count;
    for (size_t c = 0; c < 3; ++c) {
      box.mean[c] += cells[i].count * cells[i].mean[c];
      squares[c] += cells[i].count * cells[i].mean[c] * cells[i].mean[c];
    }
  }
  for (size_t c = 0; c < 3; ++c) {
    box.mean[c] /= box.count;
    const double spread = squares[c] - box.count * box.mean[c] * box.mean[c];
    if (end - begin > 1 && spread > box.spread) {
      box.spread = spread;
      box.widest = c;
    }
  }
  return box;
}

// Cuts the box of the largest spread at the mean of its widest colour until there are enough boxes.
std::vector<Box> cut(std::vector<Cell>& cells) {
  std::vector<Box> boxes{box_of(cells, 0, cells.size())};
  while (boxes.size() < most_colours) {
    const auto largest =
        std::max_element(boxes.begin(), boxes.end(), [](const Box& a, const Box& b) { return a.spread < b.spread; });
    const Box box = *largest;
    const auto middle =
        std::partition(cells.begin() + std::ptrdiff_t(box.begin), cells.begin() + std::ptrdiff_t(box.end),
                       [&](const Cell& cell) { return cell.mean[box.widest] <= box.mean[box.widest]; });
    const auto at = size_t(middle - cells.begin());
    if (box.spread <= 0 || at == box.begin || at == box.end) break;
    *largest = box_of(cells, box.begin, at);
    boxes.push_back(box_of(cells, at, box.end));
  }
  return boxes;
}

// The nearest colour of the palette, found once for each cell.
class Nearest {
 public:
  explicit Nearest(const std::vector<Colour>& palette) : palette_(palette), found_(size_t(1) << (3 * cell_bits), -1) {}

  size_t operator()(int r, int g, int b) {
    int& found = found_[cell_of(r, g, b)];
    if (found < 0) {
      constexpr int shift = 8 - cell_bits, half = 1 << (shift - 1);
      const std::array<int, 3> centre{(r >> shift << shift) + half, (g >> shift << shift) + half,
                                      (b >> shift << shift) + half};
      const auto distance = [&](const Colour& colour) {
        int sum = 0;
        for (size_t c = 0; c < 3; ++c) sum += (colour[c] - centre[c]) * (colour[c] - centre[c]);
        return sum;
      };
      const auto best = std::min_element(palette_.begin(), palette_.end(),
                                         [&](const Colour& x, const Colour& y) { return distance(x) < distance(y); });
      found = int(best - palette_.begin());
    }
    return size_t(found);
  }

 private:
  const std::vector<Colour>& palette_;
  std::vector<int> found_;
};

void dither(const std::vector<uint8_t>& colours, int columns, IndexedPicture& picture) {
  Nearest nearest(picture.palette);
  const auto width = size_t(columns);
  // What this row and the next one have received from pixels already done, in sixteenths; one column more on each side.
  std::vector<std::array<int, 3>> here(width + 2), next(width + 2);
  for (size_t i = 0; i < picture.indices.size(); ++i) {
    const size_t column = i % width + 1;
    if (column == 1 && i > 0) {
      here.swap(next);
      std::fill(next.begin(), next.end(), std::array<int, 3>{});
    }
    std::array<int, 3> wanted{};
    for (size_t c = 0; c < 3; ++c) wanted[c] = std::clamp(colours[3 * i + c] + here[column][c] / 16, 0, 255);
    const size_t index = nearest(wanted[0], wanted[1], wanted[2]);
    picture.indices[i] = uint8_t(index);
    for (size_t c = 0; c < 3; ++c) {
      const int rest = wanted[c] - picture.palette[index][c];
      here[column + 1][c] += 7 * rest;
      next[column - 1][c] += 3 * rest;
      next[column][c] += 5 * rest;
      next[column + 1][c] += rest;
    }
  }
}

/// The picture by a palette of its own: exactly, if it has at most 256 colours. Otherwise the colours come from median
/// cuts of the picture's colours (P. Heckbert, SIGGRAPH 1982), and the rest of each pixel is passed on to its
/// neighbours (Floyd and Steinberg, 1976).
/// @param colours  [row][column][R, G, B]
IndexedPicture indexed_picture(const std::vector<uint8_t>& colours, int columns, int rows) {
  IndexedPicture picture;
  picture.indices.resize(size_t(columns) * size_t(rows));
  if (is_exact(colours, picture)) return picture;
  std::vector<Cell> cells = used_cells(colours);
  picture.palette.clear();
  for (const Box& box : cut(cells)) {
    Colour colour{};
    for (size_t c = 0; c < 3; ++c) colour[c] = uint8_t(std::lround(box.mean[c]));
    picture.palette.push_back(colour);
  }
  dither(colours, columns, picture);
  return picture;
}

using Gif = std::unique_ptr<GifFileType, int (*)(GifFileType*)>;
using ColourMap = std::unique_ptr<ColorMapObject, void (*)(ColorMapObject*)>;

int put(GifFileType* gif, const GifByteType* bytes, int size) {
  return static_cast<NewFile*>(gif->UserData)->put(bytes, size_t(size)) ? size : 0;
}

ColourMap map_of(const IndexedPicture& picture) {
  int size = 2;  // the format has powers of two
  while (size < int(picture.palette.size())) size *= 2;
  ColourMap map(GifMakeMapObject(size, nullptr), GifFreeMapObject);
  if (!map) throw std::bad_alloc();
  for (size_t i = 0; i < picture.palette.size(); ++i)
    map->Colors[i] = {picture.palette[i][0], picture.palette[i][1], picture.palette[i][2]};
  return map;
}

bool write_start(GifFileType* gif, int columns, int rows) {
  constexpr unsigned char loop[] = {1, 0, 0};  // without end
  EGifSetGifVersion(gif, true);
  return EGifPutScreenDesc(gif, columns, rows, 8, 0, nullptr) == GIF_OK &&
         EGifPutExtensionLeader(gif, APPLICATION_EXT_FUNC_CODE) == GIF_OK &&
         EGifPutExtensionBlock(gif, 11, "NETSCAPE2.0") == GIF_OK && EGifPutExtensionBlock(gif, 3, loop) == GIF_OK &&
         EGifPutExtensionTrailer(gif) == GIF_OK;
}

bool write_frame(GifFileType* gif, int columns, int rows, IndexedPicture& picture, int hundredths) {
  const GraphicsControlBlock control{DISPOSE_DO_NOT, false, hundredths, NO_TRANSPARENT_COLOR};
  GifByteType bytes[4];
  const size_t size = EGifGCBToExtension(&control, bytes);
  const ColourMap map = map_of(picture);
  if (EGifPutExtension(gif, GRAPHICS_EXT_FUNC_CODE, int(size), bytes) != GIF_OK ||
      EGifPutImageDesc(gif, 0, 0, columns, rows, false, map.get()) != GIF_OK)
    return false;
  for (int row = 0; row < rows; ++row)
    if (EGifPutLine(gif, picture.indices.data() + size_t(row) * size_t(columns), columns) != GIF_OK) return false;
  return true;
}

}  // namespace

void write_gif(const std::string& path, const Frames& frames) {
  constexpr int most = 65535;
  const int columns = frames.columns, rows = frames.rows;
  require(columns <= most && rows <= most,
          "{}: expected at most {} × {} pixels in a GIF, got {} × {}; use a larger pixel", path, most, most, columns,
          rows);
  std::vector<size_t> uses(frames.count, 0);
  for (const size_t picture : frames.order) ++uses[picture];
  std::map<size_t, IndexedPicture> indexed;  // those that are shown again
  NewFile file(path);
  int reason = 0;
  Gif gif(EGifOpen(&file, put, &reason), [](GifFileType* one) { return EGifCloseFile(one, nullptr); });
  bool is_written = gif && write_start(gif.get(), columns, rows);
  for (size_t i = 0; is_written && i < frames.order.size(); ++i) {
    const size_t picture = frames.order[i];
    if (!indexed.contains(picture)) indexed[picture] = indexed_picture(frames.picture(picture), columns, rows);
    is_written = write_frame(gif.get(), columns, rows, indexed[picture], frames.duration(i, 100, 2));
    if (--uses[picture] == 0) indexed.erase(picture);
  }
  is_written = gif && EGifCloseFile(gif.release(), nullptr) == GIF_OK && is_written;
  file.check();
  require(is_written, "expected to write {} as a GIF of {} × {} pixels, but it cannot hold them; use fewer pixels",
          path, columns, rows);
  file.finish();
}

}  // namespace holotrace
