#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "holotrace/data/hologram.h"
#include "holotrace/data/params/hologram.h"
#include "holotrace/io/files/output_set.h"

namespace holotrace {

/// The place of a hologram in a series that was written together: frames, colours, … of one scene.
struct SeriesPart {
  size_t number = 1, count = 1;  ///< which one it is, from 1, and how many there are
};

/// Writes the levels of a hologram as linear grey values, not sRGB-coded (.png, .bmp, .tif), or as they are (.npy, .csv). The
/// metadata are a JSON object with the keys of Hologram in data/members.h, and with kind, modulus, part, parts and files
/// (docs/reference/file_formats.md describes each): in a PNG as the text "holotrace"; beside other files, and beside a PNG that
/// cannot hold so much, in NAME.png.json. For M levels:
///
///     phase:      grey = round(ℓ·256/M)      in 8 bits (M ≤ 256), or round(ℓ·65536/M) in 16 bits
///     amplitude:  grey = round(ℓ·255/(M−1))  in 8 bits (M ≤ 256), or round(ℓ·65535/(M−1)) in 16 bits
///
/// so that the 8-bit grey g always means the phase 2πg/256 or the amplitude g/255.
/// The amplitudes of a complex hologram are in a second file, NAME_modulus.png. `slm` has the panel's figures and all
/// its effects, so the hologram does not need the panel's own file. A phase map is an image
/// beside it, NAME_phase_map.exr [rad], and a light map NAME_light_map.exr, with the hologram's name. `effects` are those that the
/// levels compensate.
/// @param part    its place in a series
/// @param files   the files that belong to this one, as the next call must know them, when its own are written; none: no
///                record
/// @throws Error as check_hologram_path does, and where NewFile throws
void save_hologram(const std::string& path, const Hologram& hologram, const SeriesPart& part = {},
                   const std::function<FileRecord()>& files = {});

/// Checks, before the work, that a hologram can be written. @throws Error for an ending that is not among panel_image_endings
void check_hologram_path(const std::string& path);

/// Writes a series of holograms into a set as NAME, NAME_2, …; the first one records the others.
void save_holograms(const OutputSet& set, const std::string& name, const std::vector<Hologram>& holograms);

/// The channels of a file that hold a hologram each: red, green and blue of a coloured picture without metadata, else grey.
/// @throws Error as load_hologram does for a file that is neither a picture nor a table
std::vector<Channel> hologram_channels(const std::string& path);

/// Whether a file has the metadata of a hologram, in it or beside it.
bool is_hologram_file(const std::string& path);

/// What save_hologram was told about the series and the files; nothing if the file holds no metadata.
SeriesPart series_part(const std::string& path);
FileRecord hologram_record(const std::string& path);

/// The viewing conditions of a hologram, without reading its levels; unknown if the file holds no metadata.
/// @throws Error  if there is no such file, and as load_hologram does for damaged metadata
ViewingConditions viewing_of_file(const std::string& path);

/// Changes what a hologram's file says of itself, or says it if the file has no metadata.
using CompleteHologram = std::function<void(HologramParams&)>;

/// Reads what save_hologram wrote, the sidecars NAME.json of earlier versions, and holograms of other programs: pictures, tables
/// of levels, and .npy of floats, phases [rad] or amplitudes of 0 to 1, which become the nearest levels. Without metadata: a phase
/// hologram of 256 or 65536 levels by the bits of a picture, of 2 for a .npy of true and false, of 256 for other tables up to 255;
/// illumination 1 W/m², pitch 0 and wavelength 0; the caller sets these. Metadata beside a file count only if its levels are those that they
/// were written for.
/// @throws Error naming the file if it is neither, has colours and no channel is named, or has values that are no level; and if a
///         phase map or amplitudes that the metadata name are missing; for other levels or another modulation than
///         those of the metadata
/// @param complete  asked for what flags say; the wavelength counts only for a file without metadata
Hologram load_hologram(const std::string& path, const CompleteHologram& complete = {});

}  // namespace holotrace
