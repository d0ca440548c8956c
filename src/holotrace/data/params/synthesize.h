#pragma once

#include "holotrace/data/params/choice.h"

// synthesize: Sources → Field

namespace holotrace {

/// How light reaches the panel. Of waves: summed one by one in double; tile by tile; by a non-uniform FFT in each tile;
/// by slices of depth; or by the cheapest of these that meets the tolerance. Of surfaces: as triangles that shine.
enum class SynthesisMethod { automatic, exact, tiled, planes, layers, triangles };

/// How a triangle shines: evenly, or from corner to corner (Gouraud).
enum class Shading { flat, smooth };

/// The phase of a triangle's light: one for each, random, or the same for all.
enum class TrianglePhase { random, constant };

/// How the waves or surfaces of a scene become the field on the panel.
struct SynthesizeParams {
  SynthesisMethod method = SynthesisMethod::automatic;  ///< how waves are summed
  double tolerance = 1e-3;                              ///< relative L2 error allowed against exact, in (0, 1)
  int slices = 0;                ///< layers: of depth; 0: as many as keep the phase of a slice within the tolerance
  bool has_silhouettes = false;  ///< layers: a slice hides what lies behind it
  Shading shading = Shading::smooth;                     ///< of triangles
  TrianglePhase triangle_phase = TrianglePhase::random;  ///< of triangles
};

template <class Visitor>
void describe(Visitor& v, SynthesizeParams& p) {
  v.choice(
      "method", p.method,
      {{"auto", SynthesisMethod::automatic},
       {"exact", SynthesisMethod::exact},
       {"tiled", SynthesisMethod::tiled},
       {"planes", SynthesisMethod::planes},
       {"layers", SynthesisMethod::layers},
       {"triangles", SynthesisMethod::triangles}},
      "how waves are summed: one by one in double, tile by tile, by a non-uniform FFT in each tile, in slices of depth, the "
      "cheapest that meets the tolerance (auto); or a scene's surfaces as triangles that shine");
  v.number("tolerance", p.tolerance, range::between(0, 1), "relative L2 error allowed against exact");
  v.count("slices", p.slices, range::not_negative, "layers: slices of depth; 0: as many as the tolerance needs");
  v.flag("silhouettes", p.has_silhouettes, "layers: each slice hides what lies behind it");
  v.choice("shading", p.shading, {{"flat", Shading::flat}, {"smooth", Shading::smooth}},
           "triangles: each shines evenly, or from corner to corner");
  v.choice("triangle_phase", p.triangle_phase,
           {{"random", TrianglePhase::random}, {"constant", TrianglePhase::constant}},
           "triangles: one for each, or 0 for all");
}

}  // namespace holotrace
