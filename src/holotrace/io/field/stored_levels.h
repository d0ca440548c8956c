#pragma once

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "holotrace/base/array.h"
#include "holotrace/data/params/hologram.h"
#include "holotrace/data/slm.h"

// The values in files of holograms, of this and of other programs, and the levels that they mean.

namespace holotrace {

/// The text of a PNG that holds the metadata of a hologram.
inline constexpr const char* hologram_text = "holotrace";

/// The values of a hologram's file before it is known what they mean.
struct StoredLevels {
  enum class Kind { greys, levels, floats };
  Kind kind = Kind::greys;
  int nx = 0, ny = 0, bits = 8, channels = 1;
  int levels = 256;        ///< their number, if neither metadata nor the caller say it; 0: it must be said
  std::string metadata{};  ///< text inside a PNG; empty if there is none
  std::variant<std::vector<uint8_t>, std::vector<uint16_t>, std::vector<double>> values{};  ///< [row][column][channel]

  double greatest() const;
  bool has_colours() const;  ///< whether red, green and blue differ in a pixel
};

/// @throws Error naming the file if it is neither an image of 8 or 16 bits nor a table, or is truncated
StoredLevels read_stored_levels(const std::string& path);

/// The levels that the values of a file mean: of greys (hologram_file.h), levels, phases [rad] or amplitudes of 0 to 1.
/// @param channel  of a coloured picture
/// @param source   file whose metadata have the number of levels, for errors; "": none
/// @throws Error naming `path` for a value that is no level, and for colours where no channel is named
Array2D<uint16_t> levels_of(const StoredLevels& stored, Channel channel, int levels, Modulation modulation,
                            const std::string& path, const std::string& source);

/// Writes levels as greys or, into tables, as they are.
/// @param metadata  text inside the file, which then is a PNG; "": none
/// @throws Error for a level that is not below `levels`, and where save_panel_image throws
void write_levels(const std::string& path, const Array2D<uint16_t>& levels_of_pixels, int levels, Modulation modulation,
                  const std::string& metadata = "");

}  // namespace holotrace
