#include <dlfcn.h>
#include <tiffio.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <memory>

#include "holotrace/base/error.h"
#include "holotrace/io/files/new_file.h"
#include "holotrace/io/picture/formats/formats.h"

namespace holotrace {
namespace {

// A function of libtiff, which is loaded when a TIFF is read: Debian's needs libjbig, which is under the GPL.
class LibtiffFunction {
 public:
  explicit LibtiffFunction(const char* name) : address_(dlsym(library(), name)) {
    require(address_ != nullptr, "expected libtiff 4.5 or later, but {} has no function {}; update libtiff6", file_,
            name);
  }
  template <class Function>
  operator Function*() const {
    return reinterpret_cast<Function*>(address_);
  }

 private:
  static constexpr const char* file_ = "libtiff.so.6";

  static void* library() {
    static void* const found = dlopen(file_, RTLD_NOW | RTLD_LOCAL);
    require(found != nullptr,
            "expected libtiff 4.5 or later for a TIFF, got \"{}\"; install libtiff6, or use a PNG or BMP",
            found ? "" : dlerror());
    return found;
  }

  void* address_;
};

struct Libtiff {
  decltype(&TIFFOpenOptionsAlloc) make_options = LibtiffFunction("TIFFOpenOptionsAlloc");
  decltype(&TIFFOpenOptionsFree) free_options = LibtiffFunction("TIFFOpenOptionsFree");
  decltype(&TIFFOpenOptionsSetErrorHandlerExtR) set_error_handler =
      LibtiffFunction("TIFFOpenOptionsSetErrorHandlerExtR");
  decltype(&TIFFOpenOptionsSetWarningHandlerExtR) set_warning_handler =
      LibtiffFunction("TIFFOpenOptionsSetWarningHandlerExtR");
  decltype(&TIFFOpenOptionsSetMaxSingleMemAlloc) set_most_memory =
      LibtiffFunction("TIFFOpenOptionsSetMaxSingleMemAlloc");
  decltype(&TIFFClientOpenExt) open = LibtiffFunction("TIFFClientOpenExt");
  decltype(&TIFFClose) close = LibtiffFunction("TIFFClose");
  decltype(&TIFFGetFieldDefaulted) get_field = LibtiffFunction("TIFFGetFieldDefaulted");
  decltype(&TIFFSetField) set_field = LibtiffFunction("TIFFSetField");
  decltype(&TIFFIsTiled) is_tiled = LibtiffFunction("TIFFIsTiled");
  decltype(&TIFFScanlineSize) scanline_size = LibtiffFunction("TIFFScanlineSize");
  decltype(&TIFFReadScanline) read_scanline = LibtiffFunction("TIFFReadScanline");
  decltype(&TIFFTileSize) tile_size = LibtiffFunction("TIFFTileSize");
  decltype(&TIFFReadTile) read_tile = LibtiffFunction("TIFFReadTile");
  decltype(&TIFFWriteEncodedStrip) write_strip = LibtiffFunction("TIFFWriteEncodedStrip");
  decltype(&TIFFFlush) flush = LibtiffFunction("TIFFFlush");
  decltype(&TIFFReadRGBAImageOriented) read_rgba = LibtiffFunction("TIFFReadRGBAImageOriented");
  decltype(&TIFFRGBAImageOK) can_read_rgba = LibtiffFunction("TIFFRGBAImageOK");
};

const Libtiff& libtiff() {
  static const Libtiff library;
  return library;
}

using Tiff = std::unique_ptr<TIFF, void (*)(TIFF*)>;

ByteSource& source_of(thandle_t handle) { return *static_cast<ByteSource*>(handle); }

tmsize_t read(thandle_t handle, void* to, tmsize_t size) {
  return size <= 0 ? 0 : tmsize_t(source_of(handle).read(to, size_t(size)));
}

toff_t seek(thandle_t handle, toff_t offset, int from) {
  ByteSource& source = source_of(handle);
  source.seek(from == SEEK_SET ? offset : (from == SEEK_CUR ? source.place() : source.size()) + offset);
  return source.place();
}

// What libtiff calls for the bytes of a file.
struct TiffAccess {
  const char* mode;
  TIFFReadWriteProc read, write;
  TIFFSeekProc seek;
  TIFFSizeProc size;
};

Tiff open(const std::string& name, thandle_t handle, const TiffAccess& access, tmsize_t most_memory) {
  TIFFOpenOptions* options = libtiff().make_options();
  const auto silent = [](TIFF*, void*, const char*, const char*, va_list) { return 1; };
  libtiff().set_error_handler(options, silent, nullptr);
  libtiff().set_warning_handler(options, silent, nullptr);
  libtiff().set_most_memory(options, most_memory);
  TIFF* file = libtiff().open(
      name.c_str(), access.mode, handle, access.read, access.write, access.seek, [](thandle_t) { return 0; },
      access.size, nullptr, nullptr, options);
  libtiff().free_options(options);
  return {file, [](TIFF* one) {
            if (one) libtiff().close(one);
          }};
}

constexpr TiffAccess reading{"rm", read, [](thandle_t, void*, tmsize_t) -> tmsize_t { return 0; }, seek,
                             [](thandle_t handle) { return toff_t(source_of(handle).size()); }};

template <class Value>
Value tag(TIFF* file, uint32_t name, Value otherwise) {
  Value value = otherwise;
  return libtiff().get_field(file, name, &value) ? value : otherwise;
}

// How the file keeps its samples.
struct Layout {
  int samples = 0;        // of a pixel in the file
  bool is_plain = false;  // they are numbers of 8, 16 or 32 bits that can be used as they are
  bool is_white_0 = false;
  bool is_grey = false;
  bool is_separate = false;  // one plane after the other
};

Layout layout_of(TIFF* file, PictureHeader& header) {
  Layout layout;
  layout.samples = tag<uint16_t>(file, TIFFTAG_SAMPLESPERPIXEL, 1);
  const int bits = tag<uint16_t>(file, TIFFTAG_BITSPERSAMPLE, 1);
  const int format = tag<uint16_t>(file, TIFFTAG_SAMPLEFORMAT, SAMPLEFORMAT_UINT);
  const int photometric = tag<uint16_t>(file, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_MINISBLACK);
  layout.is_separate = tag<uint16_t>(file, TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG) == PLANARCONFIG_SEPARATE;
  layout.is_white_0 = photometric == PHOTOMETRIC_MINISWHITE;
  layout.is_grey = (layout.is_white_0 || photometric == PHOTOMETRIC_MINISBLACK) && layout.samples <= 2;
  const bool has_type = (format == SAMPLEFORMAT_UINT && (bits == 8 || bits == 16)) ||
                        (format == SAMPLEFORMAT_IEEEFP && bits == 32 && !layout.is_white_0);
  const bool is_colour = photometric == PHOTOMETRIC_RGB && (layout.samples == 3 || layout.samples == 4);
  layout.is_plain = has_type && (layout.is_grey || is_colour) && !(libtiff().is_tiled(file) && layout.is_separate);
  if (layout.is_plain) {
    header.type = bits == 8 ? SampleType::bits_8 : bits == 16 ? SampleType::bits_16 : SampleType::floats;
    header.channels = channels_named(layout.samples);
  } else {
    header.channels = channels_named(layout.is_grey ? 1 : 4);
  }
  return layout;
}

bool read_lines(TIFF* file, const Layout& layout, const PictureHeader& header, size_t sample_size, char* to) {
  const size_t pixel = size_t(layout.samples) * sample_size, row_size = size_t(header.columns) * pixel;
  std::vector<char> line(std::max<size_t>(size_t(std::max<tmsize_t>(libtiff().scanline_size(file), 0)), row_size));
  for (int plane = 0; plane < (layout.is_separate ? layout.samples : 1); ++plane)
    for (int row = 0; row < header.rows; ++row) {
      if (libtiff().read_scanline(file, line.data(), uint32_t(row), uint16_t(plane)) != 1) return false;
      char* target = to + size_t(row) * row_size;
      if (!layout.is_separate)
        std::memcpy(target, line.data(), row_size);
      else
        for (size_t i = 0; i < size_t(header.columns); ++i)
          std::memcpy(target + i * pixel + size_t(plane) * sample_size, line.data() + i * sample_size, sample_size);
    }
  return true;
}

constexpr size_t most_tile_memory = size_t(1) << 28;  // 8192 × 8192 pixels of 4 bytes

bool read_tiles(TIFF* file, const Layout& layout, const PictureHeader& header, size_t sample_size, char* to) {
  const int columns = int(std::min<uint32_t>(tag<uint32_t>(file, TIFFTAG_TILEWIDTH, 0), INT32_MAX));
  const int rows = int(std::min<uint32_t>(tag<uint32_t>(file, TIFFTAG_TILELENGTH, 0), INT32_MAX));
  const size_t pixel = size_t(layout.samples) * sample_size;
  if (columns < 1 || rows < 1 || size_t(libtiff().tile_size(file)) < size_t(columns) * size_t(rows) * pixel)
    return false;
  // A tile may be larger than the picture, but not without bound: its size is a claim of the file.
  if (size_t(libtiff().tile_size(file)) > most_tile_memory) return false;
  std::vector<char> tile(size_t(libtiff().tile_size(file)));
  for (int64_t y = 0; y < header.rows; y += rows)
    for (int64_t x = 0; x < header.columns; x += columns) {
      if (libtiff().read_tile(file, tile.data(), uint32_t(x), uint32_t(y), 0, 0) < 0) return false;
      const size_t width = size_t(std::min<int64_t>(columns, header.columns - x)) * pixel;
      for (int64_t row = y; row < std::min<int64_t>(y + rows, header.rows); ++row)
        std::memcpy(to + (size_t(row) * size_t(header.columns) + size_t(x)) * pixel,
                    tile.data() + size_t(row - y) * size_t(columns) * pixel, width);
    }
  return true;
}

// Palettes, YCbCr, CMYK, fewer than 8 bits and what else libtiff makes colours of.
bool read_converted(TIFF* file, const Layout& layout, Picture& picture) {
  const size_t count = size_t(picture.columns) * size_t(picture.rows);
  std::vector<uint32_t> pixels(count);
  libtiff().set_field(file, TIFFTAG_ORIENTATION,
                      ORIENTATION_TOPLEFT);  // libtiff would turn rows, but not exchange axes
  if (!libtiff().read_rgba(file, uint32_t(picture.columns), uint32_t(picture.rows), pixels.data(), ORIENTATION_TOPLEFT,
                           1))
    return false;
  auto& values = std::get<std::vector<uint8_t>>(picture.samples);
  for (size_t i = 0; i < count; ++i)
    if (layout.is_grey) {
      values[i] = uint8_t(TIFFGetR(pixels[i]));
    } else {
      const uint32_t colours[] = {TIFFGetR(pixels[i]), TIFFGetG(pixels[i]), TIFFGetB(pixels[i]), TIFFGetA(pixels[i])};
      std::copy_n(colours, 4, values.begin() + std::ptrdiff_t(4 * i));
    }
  return true;
}

void invert(Samples& samples) {
  std::visit(
      [](auto& values) {
        using Value = typename std::decay_t<decltype(values)>::value_type;
        if constexpr (std::is_integral_v<Value>)
          for (Value& value : values) value = Value(~value);
      },
      samples);
}

}  // namespace

std::optional<Picture> read_tiff(ByteSource& source, const HeaderCheck& wants) {
  const auto most_memory = tmsize_t(std::min<uint64_t>(4096 * source.size() + (1 << 26), uint64_t(1) << 33));
  const Tiff file = open(source.name(), &source, reading, most_memory);
  if (!file) return std::nullopt;
  const auto columns = tag<uint32_t>(file.get(), TIFFTAG_IMAGEWIDTH, 0),
             rows = tag<uint32_t>(file.get(), TIFFTAG_IMAGELENGTH, 0);
  if (columns < 1 || rows < 1 || columns > INT32_MAX || rows > INT32_MAX) return std::nullopt;
  Picture picture;
  picture.columns = int(columns);
  picture.rows = int(rows);
  const int orientation = tag<uint16_t>(file.get(), TIFFTAG_ORIENTATION, ORIENTATION_TOPLEFT);
  picture.orientation = orientation >= 1 && orientation <= 8 ? orientation : 1;
  const Layout layout = layout_of(file.get(), picture);
  std::array<char, 1024> reason{};  // as libtiff wants it
  if (!layout.is_plain && !libtiff().can_read_rgba(file.get(), reason.data())) return std::nullopt;
  if (!wants(picture)) return picture;

  picture.samples = samples_for(picture);
  if (!layout.is_plain) {
    picture.is_complete = read_converted(file.get(), layout, picture);
    return picture;
  }
  const auto read_all = [&](auto& values) {
    const auto read_plain = libtiff().is_tiled(file.get()) ? read_tiles : read_lines;
    return read_plain(file.get(), layout, picture, sizeof values[0], reinterpret_cast<char*>(values.data()));
  };
  picture.is_complete = std::visit(read_all, picture.samples);
  if (layout.is_white_0) invert(picture.samples);
  return picture;
}

namespace {

struct GrowingFile {
  NewFile& file;
  toff_t place = 0, end = 0;
};

GrowingFile& growing(thandle_t handle) { return *static_cast<GrowingFile*>(handle); }

tmsize_t write(thandle_t handle, void* bytes, tmsize_t size) {
  GrowingFile& to = growing(handle);
  if (size < 0 || !to.file.put(bytes, size_t(size))) return -1;
  to.place += toff_t(size);
  to.end = std::max(to.end, to.place);
  return size;
}

toff_t seek_growing(thandle_t handle, toff_t offset, int from) {
  GrowingFile& to = growing(handle);
  const toff_t place = from == SEEK_SET ? offset : (from == SEEK_CUR ? to.place : to.end) + offset;
  if (!to.file.seek(int64_t(place))) return toff_t(-1);
  return to.place = place;
}

constexpr TiffAccess writing{"w", [](thandle_t, void*, tmsize_t) -> tmsize_t { return 0; }, write, seek_growing,
                             [](thandle_t handle) { return growing(handle).end; }};

}  // namespace

void write_tiff(const std::string& path, int columns, int rows, int channels, int bits, const void* samples) {
  NewFile file(path);
  GrowingFile to{file};
  {
    const Tiff tiff = open(path, &to, writing, 0);
    require(tiff != nullptr, "expected to write the TIFF {}, but libtiff cannot", path);
    const auto set = [&](uint32_t name, int value) { libtiff().set_field(tiff.get(), name, value); };
    set(TIFFTAG_IMAGEWIDTH, columns);
    set(TIFFTAG_IMAGELENGTH, rows);
    set(TIFFTAG_SAMPLESPERPIXEL, channels);
    set(TIFFTAG_BITSPERSAMPLE, bits);
    set(TIFFTAG_ORIENTATION, ORIENTATION_TOPLEFT);
    set(TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG);
    set(TIFFTAG_PHOTOMETRIC, channels == 3 ? PHOTOMETRIC_RGB : PHOTOMETRIC_MINISBLACK);
    set(TIFFTAG_ROWSPERSTRIP, rows);
    const auto size = tmsize_t(columns) * rows * channels * (bits / 8);
    const tmsize_t written = libtiff().write_strip(tiff.get(), 0, const_cast<void*>(samples), size);  // only read
    file.check();
    require(written == size && libtiff().flush(tiff.get()) == 1,
            "expected to write {} as a TIFF of {} × {} pixels, but it cannot hold them; use fewer pixels", path,
            columns, rows);
  }
  file.finish();
}

}  // namespace holotrace
