#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "holotrace/base/array.h"
#include "holotrace/data/panel_image.h"
#include "holotrace/io/files/output_set.h"

namespace holotrace {

/// The endings of files that panels and their programs read: .png, .bmp, .tif, .tiff, .npy and .csv.
const std::vector<std::string>& panel_image_endings();

/// Whether files of that ending hold levels: tables do (.npy, .csv), pictures hold greys.
bool holds_levels(const std::string& path);

/// Writes the values as they are, completely or not at all.
///
///     .png          8 or 16 bits, 1 or 3 channels
///     .bmp          8 bits with a palette of greys, or 24 bits
///     .tif, .tiff   8 or 16 bits, 1 or 3 channels, without compression
///     .npy          uint8 or uint16, shape (rows, columns) or (rows, columns, 3)
///     .csv          one channel: a line "Y/X,0,1,…" of columns, then lines of a row's number and its values, as Santec's
///                   programs read them
///
/// @throws Error for another ending, 16 bits in a BMP, three channels in a CSV, and where NewFile does
void save_panel_image(const std::string& path, const PanelImage& image);

/// The `kind` in the metadata beside pictures for a panel: such a picture is no hologram any more.
inline constexpr const char* panel_image_kind = "panel-image";

/// Writes pictures into a set as NAME, NAME_2, …, each with NAME.json beside it, which says by the texts in `done` what was done to
/// the holograms; the first one records the other files (record_beside).
void save_panel_images(const OutputSet& set, const std::string& name, const std::vector<PanelImage>& images,
                       const std::map<std::string, std::string>& done);

/// The record in the metadata beside a file, and these metadata; empty without them.
FileRecord record_beside(const std::string& path);

/// Reads what save_panel_image writes as .npy or .csv: whole numbers, or phases [rad] as floats. A CSV may lack the numbers of
/// its columns and rows, and separate values by semicolons, blanks or tabs.
struct PanelTable {
  Array2D<double> values;
  bool are_phases = false;  ///< they are floats of a .npy
};
PanelTable load_panel_table(const std::string& path);

/// Reads a vendor's level table: a line for each grey or level, in rising order from 0, of the value that is sent, or of the grey and
/// that value. Commas, semicolons, blanks and tabs separate; lines that begin with a letter or # are headings.
/// @throws Error naming file and line for numbers that are not whole or above 65535, and greys out of order
std::vector<uint16_t> load_level_table(const std::string& path);

/// Reads a vendor's correction, a grey picture of 8 or 16 bits, as cycles: grey/256 or grey/65536.
/// @throws Error naming the file if it is not such a picture
Array2D<float> load_correction(const std::string& path);

}  // namespace holotrace
