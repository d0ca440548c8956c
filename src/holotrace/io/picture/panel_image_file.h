#pragma once

#include <cstdint>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "holotrace/base/array.h"
#include "holotrace/data/panel_image.h"
#include "holotrace/io/files/output_set.h"

namespace holotrace {

/// The endings of files that panels and their programs read: .png, .bmp, .tif, .tiff, .npy and .csv.
const std::vector<std::string>& panel_image_endings();

/// What files of that ending hold: levels if they are tables (.npy, .csv), else greys.
PanelValue value_in(const std::string& path);

/// Writes the values as they are, completely or not at all.
///
///     .png          8 or 16 bits, 1 or 3 channels
///     .bmp          8 bits with a palette of greys, or 24 bits
///     .tif, .tiff   8 or 16 bits, 1 or 3 channels, without compression
///     .npy          uint8 or uint16, shape (rows, columns) or (rows, columns, 3)
///     .csv          one channel: a line "Y/X,0,1,…" of columns, then lines of a row's number and its values, as Santec's
///                   programs read them
///
/// @param texts  inside a PNG; other formats hold none
/// @throws Error as check_panel_image, and where NewFile does
void save_panel_image(const std::string& path, const PanelImage& image,
                      const std::map<std::string, std::string>& texts = {});

/// The `kind` in the metadata of holograms, and of pictures for a panel, which are no holograms any more.
inline constexpr const char *hologram_kind = "hologram", *panel_image_kind = "panel-image";

/// Whether metadata say one of the two.
bool has_kind(const nlohmann::json& json);

/// Writes pictures into a set as NAME, NAME_2, …, each with NAME.json beside it, which says by the texts in `done` what was done to
/// the holograms; the first one records the other files (record_beside).
void save_panel_images(const OutputSet& set, const std::string& name, const std::vector<PanelImage>& images,
                       const std::map<std::string, std::string>& done);

/// What was done to the holograms of a picture for a panel, by flag, as the metadata beside it say; null for another file.
nlohmann::ordered_json done_to_panel_image(const std::string& path);

/// The record in the metadata beside a file, and these metadata; empty without them.
FileRecord record_beside(const std::string& path);

/// Checks that a file of that ending can hold a picture. @throws Error for another ending, 16 bits in a BMP, and three channels in a
/// CSV
void check_panel_image(const std::string& path, const PanelImage& image);

/// Numbers as save_panel_image writes them into a .npy or .csv, or as other programs do.
struct PanelTable {
  Array2D<double> values;  ///< [row][column and channel]
  int channels = 1;        ///< 1 or 3
  bool are_floats = false;
  bool are_bits = false;  ///< true and false
};

/// Reads a .csv of numbers, or a .npy of whole or floating-point numbers. A CSV may lack the numbers of its columns and rows, and
/// separate values by semicolons, blanks or tabs.
/// @throws Error naming the file, and the line of a CSV, for what is no such table
PanelTable load_panel_table(const std::string& path);

/// Whether a file is such a table: a .csv, or a .npy that holds no complex numbers, as fields do.
bool is_panel_table(const std::string& path);

/// Reads a vendor's level table: a line for each grey or level, in rising order from 0, of the value that is sent, or of the grey and
/// that value. Commas, semicolons, blanks and tabs separate; lines that begin with a letter or # are headings.
/// @throws Error naming file and line for numbers that are not whole or above 65535, and greys out of order
std::vector<uint16_t> load_level_table(const std::string& path);

/// Reads a vendor's correction as cycles: a grey picture of 8 or 16 bits (grey/256 or grey/65536), levels in a .csv (level/levels), or
/// phases in radians in a .npy.
/// @param levels  of the panel
/// @throws Error naming the file if it is none of these, or a JPEG
Array2D<float> load_correction(const std::string& path, int levels);

/// Both tables; "" in place of a path: none. @throws Error as these two do
PanelTables load_panel_tables(const std::string& lut, const std::string& correction, int levels);

}  // namespace holotrace
