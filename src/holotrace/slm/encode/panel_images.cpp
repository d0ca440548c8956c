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

void check_levels(const Hologram& hologram) {
  require(hologram.modulation != Modulation::complex,
          "expected holograms of phase or of amplitude as pictures for a panel, got one of both; encode it for a phase "
          "or amplitude panel");
  for (const uint16_t level : hologram.level.values)
    require(level < hologram.levels, "expected levels below {} in a hologram for a panel, got {}", hologram.levels,
            level);
}

void check_phases(const Hologram& hologram) {
  require(hologram.modulation == Modulation::phase,
          "expected blaze, lens and correction with a hologram of phases, got one of amplitudes; leave them out");
}

// The phase of blaze and lens at each pixel [cycles].
class BlazeAndLens {
 public:
  BlazeAndLens(const Hologram& hologram, const PanelImageParams& params)
      : grid_(hologram.grid), lens_(params.lens), wavelength_(hologram.wavelength) {
    require(params.blaze.size() <= 2, "expected one or two periods for blaze, along x and y, got {}",
            params.blaze.size());
    const auto per_metre = [&](size_t axis) {
      return axis < params.blaze.size() && params.blaze[axis] != 0 ? 1 / params.blaze[axis] : 0;
    };
    blaze_x_ = per_metre(0);
    blaze_y_ = per_metre(1);
    if (!is_there()) return;
    check_phases(hologram);
    require(grid_.pitch > 0, "expected a hologram whose pitch is known, to add a blaze or a lens; give --pitch");
    require(lens_ == 0 || (wavelength_ > 0 && hologram.colours.empty()),
            "expected a hologram of one known wavelength, to add a lens; {}",
            hologram.colours.empty() ? "give --wavelength" : "make a hologram for each colour");
    check_fringes("x", blaze_x_, grid_.width());
    check_fringes("y", blaze_y_, grid_.height());
  }

  bool is_there() const { return blaze_x_ != 0 || blaze_y_ != 0 || lens_ != 0; }

  double at(int row, int column) const {
    const double x = grid_.x(column), y = grid_.y(row), cycles = x * blaze_x_ + y * blaze_y_;
    if (lens_ == 0) return cycles;
    const double longer = (x * x + y * y) / (std::hypot(x, y, lens_) + std::abs(lens_));  // √(r² + f²) − |f|
    return cycles - std::copysign(longer, lens_) / wavelength_;
  }

 private:
  // The finest fringe is where the lens turns light as the blaze does, at an edge of the panel.
  void check_fringes(const char* axis, double blaze, double side) const {
    const double of_lens = lens_ == 0 ? 0 : side / 2 / std::hypot(side / 2, lens_) / wavelength_;
    const double finest = std::abs(blaze) + of_lens;
    require(finest * 2 * grid_.pitch <= 1 + 1e-9,
            "expected added fringes of two pixels ({}) or more along {}, got {} at the panel's edge; give a longer "
            "period for blaze, or a longer focal length for lens",
            format_length(2 * grid_.pitch), axis, format_length(1 / finest));
  }

  Grid grid_;
  double blaze_x_ = 0, blaze_y_ = 0, lens_, wavelength_;
};

// The steps by which the levels of a hologram were chosen. Static errors are in the levels already, and not in these steps.
PhaseLevels steps_of(const Hologram& hologram) {
  return {hologram.slm ? with_effects(*hologram.slm, hologram.effects) : Slm{}, hologram.levels,
          hologram.wavelength > 0 ? hologram.wavelength : 1};
}

// The levels with a phase more: cycles(row, column).
template <class Cycles>
Array2D<uint16_t> with_phase(const Array2D<uint16_t>& levels, const PhaseLevels& steps, const Cycles& cycles) {
  auto out = Array2D<uint16_t>::unset(levels.ny, levels.nx);
  parallel_for(0, out.ny, [&](int64_t row) {
    for (int i = 0; i < out.nx; ++i) {
      const std::complex<double> wanted = steps.phasors()[levels(int(row), i)] * cis_cycles(cycles(int(row), i));
      out(int(row), i) = uint16_t(steps.level_of(wanted.real(), wanted.imag()));
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

Array2D<uint16_t> oriented(const Array2D<uint16_t>& levels, const Orientation& orientation) {
  const bool is_transposed = orientation.is_transposed;
  auto out = Array2D<uint16_t>::unset(is_transposed ? levels.nx : levels.ny, is_transposed ? levels.ny : levels.nx);
  for (int j = 0; j < out.ny; ++j)
    for (int i = 0; i < out.nx; ++i) {
      int row = orientation.is_mirrored_y ? out.ny - 1 - j : j;
      int column = orientation.is_mirrored_x ? out.nx - 1 - i : i;
      if (is_transposed) std::swap(row, column);
      out(j, i) = levels(row, column);
    }
  return out;
}

PanelImage sent_values(const Hologram& hologram, const Array2D<uint16_t>& levels, const std::vector<uint16_t>& lut,
                       PanelValue value) {
  PanelImage image{levels.nx, levels.ny, 1, grey_bits(hologram.levels), {}};
  const size_t greys = size_t(1) << image.bits;
  require(lut.empty() || lut.size() == greys || lut.size() == size_t(hologram.levels),
          "expected a level table of {} values, one for each grey of {} bits, or one for each of the {} levels, got {} "
          "values",
          greys, image.bits, hologram.levels, lut.size());
  const bool is_by_level = lut.empty() ? value == PanelValue::level : lut.size() != greys;
  if (!lut.empty()) image.bits = *std::max_element(lut.begin(), lut.end()) <= 255 ? 8 : 16;
  image.values.reserve(levels.size());
  for (const uint16_t level : levels.values) {
    const uint16_t shown = is_by_level ? level : grey_of(level, hologram.levels, hologram.modulation);
    image.values.push_back(lut.empty() ? shown : lut[shown]);
  }
  return image;
}

PanelImage picture_of(const Hologram& hologram, const PanelImageParams& params, const PanelTables& tables,
                      PanelValue value) {
  check_levels(hologram);
  Array2D<uint16_t> levels = hologram.level;
  const BlazeAndLens added(hologram, params);
  if (added.is_there())
    levels = with_phase(levels, steps_of(hologram), [&](int row, int column) { return added.at(row, column); });
  levels = oriented(levels, Orientation(params));
  const Array2D<float>& correction = tables.correction;
  if (correction.size() > 0) {  // of the panel's own pixels
    check_phases(hologram);
    require(correction.nx == levels.nx && correction.ny == levels.ny,
            "expected a correction of {} × {} pixels, as the picture for the panel has, got {} × {}; take that of this "
            "panel",
            levels.nx, levels.ny, correction.nx, correction.ny);
    levels =
        with_phase(levels, steps_of(hologram), [&](int row, int column) { return double(correction(row, column)); });
  }
  return sent_values(hologram, levels, tables.lut, value);
}

// Warns if the levels allow already for what a maker's table corrects.
void warn_of_double_correction(const Hologram& hologram, const PanelTables& tables, const Observer& observer) {
  const auto has = [&](const char* effect) {
    return std::find(hologram.effects.begin(), hologram.effects.end(), effect) != hologram.effects.end();
  };
  const auto warn = [&](const char* table, const char* effect) {
    observer.warn(fmt::format(
        "the levels of the hologram allow for the panel's {} already, and {} does so a second time; leave one of them out",
        effect, table));
  };
  if (!tables.lut.empty() && has("calibration")) warn("the level table", "calibration");
  for (const char* effect : {"phase-map", "aberration"})
    if (tables.correction.size() > 0 && has(effect)) warn("the correction", effect);
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
      "expected holograms of three wavelengths, as many of each, to pack colours, got wavelengths: {}, holograms: {}; pass "
      "all holograms of a run in three colours, or leave out pack",
      of_wavelength.size(), holograms.size());
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
  warn_of_double_correction(holograms.front(), tables, observer);
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
