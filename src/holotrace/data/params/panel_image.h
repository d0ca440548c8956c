#pragma once

#include <vector>

#include "holotrace/data/params/parameter.h"

// panel_images: Holograms → PanelImages

namespace holotrace {

/// How the picture that is sent to a panel is mirrored: left and right (x), top and bottom (y), or both.
enum class Flip { none, x, y, both };

/// How far that picture is turned counterclockwise [quarters of a turn].
enum class Turn { none, quarter, half, three_quarters };

/// What one picture holds: one hologram; the holograms of the colours of a frame, as red, green and blue; or 24 binary
/// holograms as the bits of red, green and blue, in the order in which a controller shows the channels.
enum class Packing { none, colours, bits_rgb, bits_grb, bits_bgr };

/// What is done to holograms on their way to the panel of a bench.
struct PanelImageParams {
  Flip flip = Flip::none;
  bool is_transposed = false;
  Turn turn = Turn::none;
  std::vector<double> blaze{};  ///< periods Λ of a blazed grating along x and y [m]; 0 or not given: none
  double lens = 0;              ///< focal length f of an added lens [m]; < 0: a diverging one; 0: none
  Packing packing = Packing::none;
};

template <class Visitor>
void describe(Visitor&& v, PanelImageParams& p) {
  v(choice("flip", p.flip, {{"none", Flip::none}, {"x", Flip::x}, {"y", Flip::y}, {"xy", Flip::both}},
           "mirroring of the picture for the panel: left and right (x), top and bottom (y), or both"));
  v(flag("transpose", p.is_transposed, "rows of the picture for the panel become its columns, after flip"));
  v(choice("turn", p.turn,
           {{"0", Turn::none}, {"90", Turn::quarter}, {"180", Turn::half}, {"270", Turn::three_quarters}},
           "counterclockwise turn of the picture for the panel in degrees, after flip and transpose"));
  v(lengths(
      "blaze", p.blaze, range::any,
      "period of an added blazed grating along x, or along x and y (\"80 -160 um\"); moves a real image toward positive x and y, by "
      "distance x wavelength / period, and a virtual image the other way; 0 m: none"));
  v(length(
      "lens", p.lens, range::any,
      "focal length f of an added lens, negative: a diverging one; moves an image from z to z' with 1/z' = 1/z + 1/f; 0 m: none"));
  v(choice(
      "pack", p.packing,
      {{"none", Packing::none},
       {"colours", Packing::colours},
       {"bits-rgb", Packing::bits_rgb},
       {"bits-grb", Packing::bits_grb},
       {"bits-bgr", Packing::bits_bgr}},
      "several holograms in one picture; colours: three wavelengths as red, green and blue; bits-rgb: 24 binary holograms as the "
      "bits of red, green and blue, the least significant bit first; bits-grb, bits-bgr: the same for channels in another order"));
}

}  // namespace holotrace
