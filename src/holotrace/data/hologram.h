#pragma once

#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "holotrace/base/array.h"
#include "holotrace/base/vec.h"
#include "holotrace/data/field.h"
#include "holotrace/data/params/camera.h"
#include "holotrace/data/slm.h"

namespace holotrace {

/// Where a hologram is meant to be looked at from, and where its picture is in focus: as its run did.
struct ViewingConditions {
  std::vector<double> distances{};  ///< distances from the panel to the planes in focus [m], ≥ 0; empty: unknown
  double pupil = 0;                 ///< diameter of the eye's pupil or the lens [m]; 0: all light that leaves the panel
  Vec3 eye{0, 0, 0};                ///< position of that pupil [m], z ≥ 0
  bool follows_eye = false;         ///< the view's window is ViewWindow::eye

  bool are_known() const { return !distances.empty(); }
};

/// The viewing conditions of a camera. Without a pupil the eye's position has no effect, and is left out.
inline ViewingConditions viewing_conditions(const CameraParams& camera) {
  if (camera.pupil == 0) return {camera.distances};
  return {camera.distances, camera.pupil, camera.eye, camera.window == ViewWindow::eye};
}

/// The camera in these conditions; the default camera where they are unknown.
inline CameraParams camera_in(const ViewingConditions& viewing) {
  CameraParams camera;
  if (!viewing.are_known()) return camera;
  camera.distances = viewing.distances;
  camera.pupil = viewing.pupil;
  camera.eye = viewing.eye;
  if (viewing.follows_eye) camera.window = ViewWindow::eye;
  return camera;
}

/// One of the wavelengths of a hologram that shows several.
struct JointColour {
  double wavelength = 0;    ///< [m]
  double illumination = 0;  ///< Hologram::illumination at that wavelength [W/m²]
  bool operator==(const JointColour&) const = default;
};

/// What makes light weaker in one colour than in another, so that views balance it (axial_reach).
struct LightLosses {
  bool by_cone = true;    ///< the cone of the waves, which the light of a target does not have
  bool by_pixels = true;  ///< the pixels' aperture, which iterations undo
  bool operator==(const LightLosses&) const = default;
};

/// The data shown on an SLM: one level 0 … levels−1 per pixel, shape (ny, nx), and what an optical
/// setup must know to show it.
struct Hologram {
  Grid grid;
  Array2D<uint16_t> level;  ///< levels of phase, or of amplitude
  int levels = 256;
  Modulation modulation = Modulation::phase;
  double wavelength = 0;  ///< wavelength that it was computed for [m]
  ImageSide image = ImageSide::virtual_image;
  std::optional<SpectralFilter> filter;  ///< stop that selects the order with the image, if the encoding needs it
  std::string encoder;
  std::optional<Slm> slm;  ///< the panel that it was made for, if known
  /// Irradiance of the light on the panel that reproduces the brightness of the field [W/m²]. Holograms (colours,
  /// path groups, lights, frames) that are shown together are lit in proportion to it. See encode.h.
  double illumination = 1;
  std::vector<JointColour> colours{};  ///< for a hologram of several wavelengths: all of them; otherwise empty
  Label label{};
  LightLosses losses{};
  Array2D<uint16_t> modulus_level{};   ///< levels of amplitude, beside those of phase, if the modulation is complex
  std::vector<std::string> effects{};  ///< effects of the panel that the levels compensate (slm_effect_names)
  ViewingConditions viewing{};         ///< how its run looked at it, or the planes that it was made for
};

/// Bits of the greys that show so many levels: 8 or 16.
inline int grey_bits(int levels) { return levels <= 256 ? 8 : 16; }

/// Greys per level ℓ of M, of so many bits: the grey is round(ℓ·2ᵇ/M) for phases, and round(ℓ·(2ᵇ − 1)/(M − 1)) for amplitudes.
inline double greys_per_level(int levels, Modulation modulation, int bits) {
  const double greys = bits == 8 ? 256 : 65536;
  return modulation == Modulation::amplitude ? (greys - 1) / (levels - 1) : greys / levels;
}

/// The grey of a level.
inline uint16_t grey_of(uint16_t level, int levels, Modulation modulation) {
  return uint16_t(std::lround(level * greys_per_level(levels, modulation, grey_bits(levels))));
}

/// The illumination of a hologram for the light of one wavelength [W/m²].
inline double illumination_at(const Hologram& hologram, double wavelength) {
  for (const JointColour& colour : hologram.colours)
    if (std::abs(colour.wavelength / wavelength - 1) < 1e-9) return colour.illumination;
  return hologram.illumination;
}

/// A hologram, and the panel that shows it.
struct PanelHologram {
  Hologram hologram;  ///< with its pitch and wavelength
  Slm slm;
};

}  // namespace holotrace
