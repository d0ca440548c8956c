#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "holotrace/base/vec.h"
#include "holotrace/data/params/parameter.h"
#include "holotrace/data/params/path_tracing.h"

// render: Scene → Image

namespace holotrace {

/// Aperture of the camera: a pinhole, a round lens, or the panel's own area within its acceptance.
enum class Lens { pinhole, round, panel };

/// Renders that a run compares its views with: none, of few paths, or of all.
enum class Reference { none, quick, full };

/// Light paths per pixel where none are given or chosen.
inline constexpr int default_paths = 64;

/// The picture of a scene seen by an eye in front of the panel.
struct RenderParams {
  int columns = 0, rows = 512;        ///< size of the picture [pixels]; columns 0: chosen, else square
  double field_of_view = 0;           ///< half angle over the height [rad]; 0: chosen, else the panel's acceptance
  double azimuth = 0, elevation = 0;  ///< direction of the picture's middle from the panel's centre: right, up [rad]
  Vec3 eye{0, 0, 0};                  ///< position of the lens [m], on the panel or in front of it: z ≥ 0
  Lens lens = Lens::pinhole;          ///< aperture of the camera
  double pupil = 4e-3;                ///< diameter of the round lens [m]
  double focus = 0.3;                 ///< distance from the panel to the plane in focus [m]; < 0: in front of it
  std::vector<double> focal_stack{};  ///< distances from the panel to planes [m]: a focal stack instead of a picture
  double eye_separation = 0;  ///< distance between two eyes along x, centred on `eye` [m]: a stereo pair; 0: one eye
  int paths = 0;              ///< light paths per pixel; 0: chosen, 64 for a single picture
  int max_depth = 8;          ///< largest number of surfaces on a light path
  int roulette_depth = 6;     ///< first surface at which roulette may end a light path
  double clamp = 0;           ///< upper limit of the radiance of one path [W/m²/sr]; 0: no limit
  std::vector<std::string> path_expressions{};      ///< light path expressions whose light is summed; empty: all light
  bool has_background = true;                       ///< shows the environment where no surface is
  Acceleration accelerator = Acceleration::embree;  ///< structure that finds the surface on a ray
  Denoise denoise = Denoise::automatic;             ///< which pictures are denoised
  Reference reference = Reference::quick;  ///< of `run`: whether and how well it renders what its views should show
  int64_t seed = 1;                        ///< seed for all random numbers
  /// Wavelength at which glass has its refractive index for all colours, in pictures that are seen in the light of one laser [m]; 0: each
  /// colour has its own.
  double glass_wavelength = 0;
};

/// Light paths per pixel of a picture.
inline int paths_per_pixel(const RenderParams& params) { return params.paths > 0 ? params.paths : default_paths; }

template <class Visitor>
void describe(Visitor&& v, RenderParams& p) {
  v(count("columns", p.columns, range::not_negative,
          "width in pixels; 0: in the shape of the sensor, or square if field_of_view is given"));
  v(count("rows", p.rows, range::at_least(1), "height in pixels"));
  v(angle("field_of_view", p.field_of_view, range::half_angle,
          "half angle of view over the height; 0 deg: the window of the views"));
  v(angle("azimuth", p.azimuth, range::tilt,
          "direction of the picture's middle, seen from the panel's centre: angle to the right of the panel's axis"));
  v(angle("elevation", p.elevation, range::tilt, "direction of the picture's middle: angle above the panel's axis"));
  v(position("eye", p.eye, range::not_negative,
             "position of the lens, on the panel or in front of it (z of 0 m or more)"));
  v(choice("lens", p.lens, {{"pinhole", Lens::pinhole}, {"round", Lens::round}, {"panel", Lens::panel}},
           "aperture of the camera: a pinhole, a round lens, or the panel's own area"));
  v(length("pupil", p.pupil, range::positive, "diameter of the round lens"));
  v(length("focus", p.focus, range::any, "distance from the panel to the plane in focus; negative: in front of it"));
  v(lengths(
      "focal_stack", p.focal_stack, range::any,
      "distances from the panel to planes; makes a focal stack with the panel as lens, on the panel's pixels, from "
      "one tracing"));
  v(length("eye_separation", p.eye_separation, range::not_negative,
           "distance between two eyes along x, centred on eye; makes a stereo pair and its anaglyph; 0 m: one eye"));
  v(count("paths", p.paths, range::not_negative, "light paths per pixel; 0: as quality says for sgd, else 64"));
  v(count("max_depth", p.max_depth, range::at_least(1), "largest number of surfaces on a light path"));
  v(count(
      "roulette_depth", p.roulette_depth, range::at_least(1),
      "first surface at which Russian roulette may end a light path; later surfaces give longer paths and mostly less "
      "noise"));
  v(number("clamp", p.clamp, range::not_negative, "upper limit of the radiance of one path in W/m2/sr; 0: no limit"));
  v(texts("path_expressions", p.path_expressions, "light path expressions whose light is summed; empty: all light"));
  v(flag("background", p.has_background,
         "environment shown where no surface is; reference pictures of run show it if [trace] background is true"));
  v(choice(
      "accelerator", p.accelerator, {{"embree", Acceleration::embree}, {"grid", Acceleration::grid}},
      "structure that finds the surface on a ray: Embree's trees, or a uniform grid of cells (the paper's appendix)"));
  v(choice(
      "denoise", p.denoise, denoise_names,
      "denoising of pictures by Open Image Denoise 2, if it is installed: pictures to look at, which are PNG files (auto); "
      "none; or also radiance, in EXR and HDF5 files (all); references of metrics stay as they are"));
  v(choice(
      "reference", p.reference, {{"none", Reference::none}, {"quick", Reference::quick}, {"full", Reference::full}},
      "renders that run compares its views with: none (no metrics), quick (a quarter of the paths, and metrics without their noise) or full"));
  v(count("seed", p.seed, range::not_negative, "seed for all random numbers"));
}

}  // namespace holotrace
