#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "holotrace/base/vec.h"
#include "holotrace/data/params/acceleration.h"
#include "holotrace/data/params/choice.h"

// render: Scene → Image

namespace holotrace {

/// What gathers the light of a picture: a pinhole, a round lens, or the panel's own area within its acceptance.
enum class Lens { pinhole, round, panel };

/// The picture of a scene that an eye before the panel takes.
struct RenderParams {
  int columns = 0, rows = 512;                  ///< of the picture [pixels]; columns 0: square
  double field_of_view = 0;                     ///< half angle over the height [rad]; 0: the panel's acceptance
  Vec3 eye{0, 0, 0};                            ///< place of the lens [m], on the panel or before it: z ≥ 0
  Lens lens = Lens::pinhole;                    ///< what gathers the light
  double pupil = 4e-3;                          ///< diameter of the round lens [m]
  double focus = 0.3;                           ///< distance from the panel to the plane in focus [m]
  double eye_separation = 0;                    ///< of two eyes along x, about `eye` [m]: a stereo pair; 0: one eye
  int paths = 64;                               ///< light paths per pixel
  int max_depth = 8;                            ///< surfaces on a path
  double clamp = 0;                             ///< most radiance that one path may bring [W/m²/sr]; 0: no clamp
  std::vector<std::string> path_expressions{};  ///< light path expressions, added up; none: all light
  bool has_background = true;                   ///< shown where no surface is; the waves of a hologram have none there
  Acceleration accelerator = Acceleration::embree;  ///< of the rays
  int64_t seed = 1;                                 ///< of every random number
};

template <class Visitor>
void describe(Visitor& v, RenderParams& p) {
  v.count("columns", p.columns, range::not_negative, "width in pixels; 0: square");
  v.count("rows", p.rows, range::at_least(1), "height in pixels");
  v.angle("field_of_view", p.field_of_view, range::half_angle,
          "half angle over the height; 0 deg: the panel's acceptance asin(lambda/2p)");
  v.position("eye", p.eye, range::not_negative, "place of the lens, on the panel or before it (z of 0 m or more)");
  v.choice("lens", p.lens, {{"pinhole", Lens::pinhole}, {"round", Lens::round}, {"panel", Lens::panel}},
           "a pinhole, a round pupil, or the panel's own area");
  v.length("pupil", p.pupil, range::positive, "diameter of the round lens");
  v.length("focus", p.focus, range::positive, "distance from the panel to the plane in focus");
  v.length("eye_separation", p.eye_separation, range::not_negative,
           "of two eyes along x, about eye: a stereo pair and its anaglyph; 0 m: one");
  v.count("paths", p.paths, range::at_least(1), "light paths per pixel");
  v.count("max_depth", p.max_depth, range::at_least(1), "most surfaces on a path");
  v.number("clamp", p.clamp, range::not_negative, "most radiance that one path may bring; 0: no clamp");
  v.texts("path_expressions", p.path_expressions, "light path expressions, added up; none: all light");
  v.flag("background", p.has_background, "shown where no surface is; the pictures that run compares with leave it out");
  v.choice("accelerator", p.accelerator, {{"embree", Acceleration::embree}, {"grid", Acceleration::grid}},
           "of the rays: Embree's trees, or a uniform grid of cells (the paper's appendix)");
  v.count("seed", p.seed, range::not_negative, "seed for all random numbers");
}

}  // namespace holotrace
