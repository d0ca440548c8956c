#include "holotrace/slm/encode/panel_images.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <map>
#include <string>
#include <utility>

#include "holotrace/base/cycles.h"
#include "holotrace/base/error.h"
#include "holotrace/base/threads.h"
#include "holotrace/base/units.h"
#include "holotrace/slm/encode/phase_levels.h"

namespace holotrace {
namespace {

void check_shape(const Hologram& hologram) {
  require(hologram.modulation != Modulation::complex,
          "expected holograms of phase or of amplitude as pictures for a panel, got one of both; encode it for a phase "
          "or amplitude panel");
}

// Phase that is added, as cycles at each pixel.
class AddedPhase {
 public:
  AddedPhase(const Hologram& hologram, const PanelImageParams& params, const Array2D<float>& correction)
      : grid_(hologram.grid), lens_(params.lens), wavelength_(hologram.wavelength), correction_(correction) {
    require(params.blaze.size() <= 2, "expected one or two periods for blaze, along x and y, got {}",
            params.blaze.size());
    const auto per_metre = [&](size_t axis) {
      return axis < params.blaze.size() && params.blaze[axis] != 0 ? 1 / params.blaze[axis] : 0;
    };
    blaze_x_ = per_metre(0);
    blaze_y_ = per_metre(1);
    if (!is_there()) return;
    require(hologram.modulation == Modulation::phase,
            "expected blaze, lens and correction with a hologram of phases, got one of amplitudes; leave them out");
    require(correction_.size() == 0 || (correction_.nx == grid_.nx && correction_.ny == grid_.ny),
            "expected a correction of {} × {} pixels, as the hologram has, got {} × {}; take that of this panel",
            grid_.nx, grid_.ny, correction_.nx, correction_.ny);
    require((blaze_x_ == 0 && blaze_y_ == 0 && lens_ == 0) || grid_.pitch > 0,
            "expected a hologram whose pitch is known, to add a blaze or a lens; give --pitch");
    require(lens_ == 0 || (wavelength_ > 0 && hologram.colours.empty()),
            "expected a hologram of one known wavelength, to add a lens; {}",
            hologram.colours.empty() ? "give --wavelength" : "make a hologram for each colour");
    check_fringes("x", blaze_x_, grid_.width());
    check_fringes("y", blaze_y_, grid_.height());
  }

  bool is_there() const { return blaze_x_ != 0 || blaze_y_ != 0 || lens_ != 0 || correction_.size() > 0; }

  double at(int row, int column) const {
    const double x = grid_.x(column), y = grid_.y(row);
    double cycles = x * blaze_x_ + y * blaze_y_;
    if (lens_ != 0) {
      const double square = x * x + y * y;
      cycles -= std::copysign(square / (std::hypot(x, y, lens_) + std::abs(lens_)), lens_) / wavelength_;
    }
    return correction_.size() > 0 ? cycles + double(correction_(row, column)) : cycles;
  }

 private:
  // The finest fringe is where the lens turns light as the blaze does, at an edge of the panel.
  void check_fringes(const char* axis, double blaze, double side) const {
    const double of_lens = lens_ == 0 ? 0 : side / 2 / std::hypot(side / 2, lens_) / wavelength_;
    const double finest = std::abs(blaze) + of_lens;
    require(
        finest * 2 * grid_.pitch <= 1 + 1e-9,
        "expected added fringes of two pixels ({}) or more along {}, got {} at the panel's edge; give a longer period for "
        "blaze, or a longer focal length for lens",
        format_length(2 * grid_.pitch), axis, format_length(1 / finest));
  }

  Grid grid_;
  double blaze_x_ = 0, blaze_y_ = 0, lens_, wavelength_;
  const Array2D<float>& correction_;
};

// The panel by which the levels of a hologram were chosen.
PhaseLevels levels_of(const Hologram& hologram) {
  Slm known = hologram.slm ? with_effects(*hologram.slm, hologram.effects) : Slm{};
  known.effects.aberration.clear();  // levels have these static errors in them
  known.effects.phase_map = nullptr;
  return {known, hologram.levels, hologram.wavelength > 0 ? hologram.wavelength : 1};
}

Array2D<uint16_t> with_phase(const Hologram& hologram, const AddedPhase& added) {
  if (!added.is_there()) return hologram.level;
  const PhaseLevels levels = levels_of(hologram);
  auto out = Array2D<uint16_t>::unset(hologram.level.ny, hologram.level.nx);
  parallel_for(0, out.ny, [&](int64_t row) {
    for (int i = 0; i < out.nx; ++i) {
      const std::complex<double> wanted =
          levels.phasors()[hologram.level(int(row), i)] * std::complex<double>(cis_cycles(added.at(int(row), i)));
      out(int(row), i) = uint16_t(levels.level_of(wanted.real(), wanted.imag()));
    }
  });
  return out;
}

// A picture whose rows and columns are exchanged first, and which is mirrored then.
struct Orientation {
  bool is_transposed = false, is_mirrored_x = false, is_mirrored_y = false;

  explicit Orientation(const PanelImageParams& params) {
    is_mirrored_x = params.flip == Flip::x || params.flip == Flip::both;
    is_mirrored_y = params.flip == Flip::y || params.flip == Flip::both;
    if (params.is_transposed) transpose();
    if (params.turn == Turn::quarter || params.turn == Turn::three_quarters) transpose();
    if (params.turn == Turn::quarter || params.turn == Turn::half) is_mirrored_y = !is_mirrored_y;
    if (params.turn == Turn::half || params.turn == Turn::three_quarters) is_mirrored_x = !is_mirrored_x;
  }

 private:
  void transpose() {
    is_transposed = !is_transposed;
    std::swap(is_mirrored_x, is_mirrored_y);
  }
};

PanelImage oriented(const Array2D<uint16_t>& values, int bits, const Orientation& orientation) {
  PanelImage image{values.nx, values.ny, 1, bits, std::vector<uint16_t>(values.size())};
  if (orientation.is_transposed) std::swap(image.columns, image.rows);
  size_t at = 0;
  for (int j = 0; j < image.rows; ++j)
    for (int i = 0; i < image.columns; ++i) {
      int row = orientation.is_mirrored_y ? image.rows - 1 - j : j;
      int column = orientation.is_mirrored_x ? image.columns - 1 - i : i;
      if (orientation.is_transposed) std::swap(row, column);
      image.values[at++] = values(row, column);
    }
  return image;
}

PanelImage picture_of(const Hologram& hologram, const PanelImageParams& params, const PanelTables& tables,
                      PanelValue value) {
  check_shape(hologram);
  Array2D<uint16_t> values = with_phase(hologram, AddedPhase(hologram, params, tables.correction));
  int bits = grey_bits(hologram.levels);
  const std::vector<uint16_t>& lut = tables.lut;
  const size_t greys = size_t(1) << bits;
  require(
      lut.empty() || lut.size() == greys || lut.size() == size_t(hologram.levels),
      "expected a level table of {} values, one for each grey of {} bits, or one for each of the {} levels, got {} values",
      greys, bits, hologram.levels, lut.size());
  const bool is_by_level = lut.empty() ? value == PanelValue::level : lut.size() != greys;
  if (!lut.empty()) bits = *std::max_element(lut.begin(), lut.end()) <= 255 ? 8 : 16;
  for (uint16_t& number : values.values) {
    require(number < hologram.levels, "expected levels below {} in a hologram for a panel, got {}", hologram.levels,
            number);
    if (!is_by_level) number = grey_of(number, hologram.levels, hologram.modulation);
    if (!lut.empty()) number = lut[number];
  }
  return oriented(values, bits, Orientation(params));
}

// Three pictures as red, green and blue.
PanelImage joined(const PanelImage& red, const PanelImage& green, const PanelImage& blue) {
  PanelImage image = red;
  image.channels = 3;
  image.bits = std::max({red.bits, green.bits, blue.bits});
  image.values.resize(3 * red.values.size());
  for (size_t i = 0; i < red.values.size(); ++i) {
    image.values[3 * i] = red.values[i];
    image.values[3 * i + 1] = green.values[i];
    image.values[3 * i + 2] = blue.values[i];
  }
  return image;
}

std::vector<PanelImage> packed_colours(const std::vector<Hologram>& holograms, std::vector<PanelImage> images) {
  std::map<double, std::vector<PanelImage>, std::greater<>> of_wavelength;
  for (size_t i = 0; i < holograms.size(); ++i) of_wavelength[holograms[i].wavelength].push_back(std::move(images[i]));
  const size_t frames = of_wavelength.begin()->second.size();
  const bool are_alike = std::all_of(of_wavelength.begin(), of_wavelength.end(),
                                     [&](const auto& entry) { return entry.second.size() == frames; });
  require(
      of_wavelength.size() == 3 && are_alike,
      "expected holograms of three wavelengths, as many of each, to pack colours, got {} holograms of {} {}; pass all "
      "holograms of a run in three colours, or leave out pack",
      holograms.size(), of_wavelength.size(), of_wavelength.size() == 1 ? "wavelength" : "wavelengths");
  std::vector<PanelImage> packed;
  for (size_t frame = 0; frame < frames; ++frame) {
    std::vector<const PanelImage*> channels;
    for (const auto& [wavelength, frames_of_it] : of_wavelength) channels.push_back(&frames_of_it[frame]);
    packed.push_back(joined(*channels[0], *channels[1], *channels[2]));
  }
  return packed;
}

constexpr size_t bit_planes = 24;

// Binary pictures as the bits of 24, eight for each channel, in the order in which the channels are shown.
std::vector<PanelImage> packed_bits(const std::vector<PanelImage>& images, const std::string& order,
                                    const Observer& observer) {
  std::vector<PanelImage> packed;
  for (size_t first = 0; first < images.size(); first += bit_planes) {
    PanelImage& image = packed.emplace_back(images.front());
    image.channels = 3;
    image.bits = 8;
    image.values.assign(3 * images.front().values.size(), 0);
    for (size_t bit = 0; bit < std::min(bit_planes, images.size() - first); ++bit) {
      const size_t channel = std::string("rgb").find(order[bit / 8]);
      for (size_t i = 0; i < images[first + bit].values.size(); ++i)
        image.values[3 * i + channel] |= uint16_t((images[first + bit].values[i] != 0 ? 1 : 0) << bit % 8);
    }
  }
  if (const size_t last = images.size() % bit_planes; last != 0)
    observer.warn(fmt::format("the last picture has {} of 24 bit planes; the others are 0: show only these", last));
  return packed;
}

}  // namespace

std::vector<PanelImage> panel_images(const std::vector<Hologram>& holograms, const PanelImageParams& params,
                                     const PanelTables& tables, PanelValue value, const Observer& observer) {
  require(!holograms.empty(), "expected a hologram to make a picture for a panel of, got none");
  const Grid& grid = holograms.front().grid;
  std::vector<PanelImage> images;
  for (const Hologram& hologram : holograms) {
    require(hologram.grid.nx == grid.nx && hologram.grid.ny == grid.ny,
            "expected holograms of one panel, got one of {} × {} pixels beside one of {} × {}", hologram.grid.nx,
            hologram.grid.ny, grid.nx, grid.ny);
    const bool has_bits = params.packing != Packing::none && params.packing != Packing::colours;
    require(!has_bits || hologram.levels == 2,
            "expected binary holograms to pack bits, got one of {} levels; encode for a panel of 2 levels",
            hologram.levels);
    require(!has_bits || tables.lut.empty(), "expected no level table with bits, which are 0 and 1; leave it out");
    images.push_back(picture_of(hologram, params, tables, value));
  }
  switch (params.packing) {
    case Packing::none:
      return images;
    case Packing::colours:
      return packed_colours(holograms, std::move(images));
    case Packing::bits_rgb:
      return packed_bits(images, "rgb", observer);
    case Packing::bits_grb:
      return packed_bits(images, "grb", observer);
    case Packing::bits_bgr:
      return packed_bits(images, "bgr", observer);
  }
  fail("expected a known packing");
}

}  // namespace holotrace
