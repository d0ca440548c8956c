#pragma once

#include "holotrace/data/params/parameter.h"

// synthesize: Sources → Field

namespace holotrace {

/// How the field is computed. From waves: one by one in double (`exact`); tile by tile (`tiled`); by a non-uniform FFT
/// in each tile (`planes`); by slices of depth (`layers`); by the fastest of these that meets the tolerance
/// (`automatic`). From surfaces: as luminous triangles (`triangles`).
enum class SynthesisMethod { automatic, exact, tiled, planes, layers, triangles };

/// Amplitude over a triangle: uniform, or interpolated between its corners (Gouraud).
enum class Shading { flat, smooth };

/// Phase of the light of the triangles: a random one for each, or the same for all.
enum class TrianglePhase { random, constant };

/// How the waves or surfaces of a scene become the field on the panel.
struct SynthesizeParams {
  SynthesisMethod method = SynthesisMethod::automatic;  ///< how the field is computed
  double tolerance = 1e-3;                              ///< relative L2 error allowed against exact, in (0, 1)
  int slices =
      0;  ///< layers: number of slices of depth; 0: as many as the tolerance needs, or for a picture with depths the panel's depth of focus
  bool has_silhouettes = false;                          ///< layers: each slice hides what lies behind it
  Shading shading = Shading::smooth;                     ///< amplitude over a triangle
  TrianglePhase triangle_phase = TrianglePhase::random;  ///< phase of the triangles' light
  DeviceChoice device{};                                 ///< device that sums the waves
};

template <class Visitor>
void describe(Visitor&& v, SynthesizeParams& p) {
  v(choice("method", p.method,
           {{"auto", SynthesisMethod::automatic},
            {"exact", SynthesisMethod::exact},
            {"tiled", SynthesisMethod::tiled},
            {"planes", SynthesisMethod::planes},
            {"layers", SynthesisMethod::layers},
            {"triangles", SynthesisMethod::triangles}},
           "how the field is computed. From waves: one by one in double precision (exact), tile by tile "
           "(tiled), by a non-uniform FFT in each tile (planes), or by slices of depth (layers); auto: the "
           "faster of tiled and planes that meets the tolerance, else exact. From the scene's surfaces: as "
           "luminous triangles (triangles)"));
  v(number("tolerance", p.tolerance, range::between(0, 1),
           "largest relative L2 error of the field against the method exact"));
  v(count("slices", p.slices, range::not_negative,
          "layers: number of slices of depth; 0: as many as the tolerance needs, or for a picture with depths the "
          "panel's depth of focus"));
  v(flag("silhouettes", p.has_silhouettes, "layers: each slice hides what lies behind it"));
  v(choice("shading", p.shading, {{"flat", Shading::flat}, {"smooth", Shading::smooth}},
           "triangles: amplitude over a triangle: uniform (flat), or interpolated between its corners (smooth)"));
  v(choice("triangle_phase", p.triangle_phase,
           {{"random", TrianglePhase::random}, {"constant", TrianglePhase::constant}},
           "triangles: phase of their light: a random one for each, or 0 for all"));
  v(devices("device", p.device, "sums the waves (with OpenCL: by tiled or planes)"));
}

template <>
inline constexpr bool runs_on_all_devices<SynthesizeParams> = true;

}  // namespace holotrace
