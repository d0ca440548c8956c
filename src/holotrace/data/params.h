#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "holotrace/base/vec.h"
#include "holotrace/data/field.h"

// Every parameter of every stage. `describe` lists the fields of a struct once, with name, kind
// and help; that list feeds scene files, flags and help texts. A visitor has the members
//   count, number, flag      (name, value, help)     plain values
//   length, lengths, angle   (name, value, help)     text with a unit
//   choice                   (name, value, names, help)   one of a few names
//   texts                    (name, value, help)     a list of texts
//   coordinate               (name, value, help)     a length of any sign
//   position                 (name, value, help)     three lengths of any sign

namespace holotrace {

/// The names of an enumeration's values.
template <class Enum>
struct Choice {
  const char* name;
  Enum value;
};

// --- trace: Scene → Sources ---------------------------------------------------------------------

/// What a traced sample lights: every pixel in its box; the same, with visibility and radiance of each tile of the
/// panel; or one pixel alone (the paper's Steps 0–5 to the letter), which makes no waves but the field itself.
enum class Strategy { shared, tiled, gather };

/// Which rays look for first hits: a raster seen from the panel's centre, or random ones over the panel's acceptance.
enum class Pattern { grid, random };

/// The phase of a wave: even over the circle; 0; a fixed function of the surface point; that plus k times the optical
/// path from the last diffuse or glossy surface; k times the whole optical path from a laser.
enum class SourcePhase { random, constant, surface, path, laser };

/// How the amplitude of a wave follows from radiance L: as √L, or as L itself (the paper's Step 5).
enum class AmplitudeLaw { sqrt, linear };

/// Where a scene's waves begin, and how much light is followed for each.
struct TraceParams {
  Strategy strategy = Strategy::shared;         ///< what a traced sample lights
  Pattern pattern = Pattern::grid;              ///< which rays look for first hits
  int columns = 256, rows = 256;                ///< of the raster of first hits (grid)
  int64_t samples = 65536;                      ///< first hits (random)
  int pixel_samples = 16;                       ///< S, rays from every pixel (gather)
  int tile_columns = 8, tile_rows = 4;          ///< of the panel (tiled)
  double field_of_view = 0;                     ///< half angle of the raster [rad]; 0: the panel's acceptance
  int paths = 64;                               ///< light paths per first hit
  int max_depth = 8;                            ///< surfaces on a path
  double clamp = 0;                             ///< most radiance that one path may bring [W/m²/sr]; 0: no clamp
  SourcePhase phase = SourcePhase::random;      ///< that waves start with
  double grain = 0;                             ///< side of the cells of equal surface phase [m]; 0: the pixel pitch
  AmplitudeLaw amplitude = AmplitudeLaw::sqrt;  ///< from radiance
  std::vector<std::string> layers{};            ///< light path expressions; none: all light, "E.*L"
  bool separate_layers = false;                 ///< each layer a hologram of its own, or all in one
  bool separate_lights = false;                 ///< each light a hologram of its own: they do not interfere
  int frames = 1;                               ///< M, holograms with independent phases, shown one after the other
  int64_t seed = 1;                             ///< of every random number
};

template <class Visitor>
void describe(Visitor& v, TraceParams& p) {
  v.choice("strategy", p.strategy,
           {{"shared", Strategy::shared}, {"tiled", Strategy::tiled}, {"gather", Strategy::gather}},
           "each sample lights every pixel; the same with the light that each tile sees; or one pixel alone");
  v.choice("pattern", p.pattern, {{"grid", Pattern::grid}, {"random", Pattern::random}},
           "first hits: a raster seen from the panel's centre, or random over the panel's acceptance");
  v.count("columns", p.columns, "columns of the raster");
  v.count("rows", p.rows, "rows of the raster");
  v.count("samples", p.samples, "first hits of the random pattern");
  v.count("pixel_samples", p.pixel_samples, "gather: rays from every pixel");
  v.count("tile_columns", p.tile_columns, "tiled: columns of tiles that the panel is cut into");
  v.count("tile_rows", p.tile_rows, "tiled: rows of tiles");
  v.angle("field_of_view", p.field_of_view, "half angle of the raster; 0 deg: the panel's acceptance asin(lambda/2p)");
  v.count("paths", p.paths, "light paths per first hit");
  v.count("max_depth", p.max_depth, "most surfaces on a path");
  v.number("clamp", p.clamp, "most radiance that one path may bring; 0: no clamp, which is right but may be noisy");
  v.choice("phase", p.phase,
           {{"random", SourcePhase::random},
            {"constant", SourcePhase::constant},
            {"surface", SourcePhase::surface},
            {"path", SourcePhase::path},
            {"laser", SourcePhase::laser}},
           "of the waves: random, 0, fixed to the surface, that and the way through mirrors and glass, a laser's");
  v.length("grain", p.grain, "side of the cells of equal surface phase; 0 m: the pixel pitch");
  v.choice("amplitude", p.amplitude, {{"sqrt", AmplitudeLaw::sqrt}, {"linear", AmplitudeLaw::linear}},
           "amplitude from radiance L: its root (brightness is radiance) or L itself (the paper's Step 5)");
  v.texts("layers", p.layers, "light path expressions, as E(D|G)L; none: all light");
  v.flag("separate_layers", p.separate_layers, "each layer a hologram of its own, or all in one");
  v.flag("separate_lights", p.separate_lights, "each light a hologram of its own, added without interference");
  v.count("frames", p.frames, "holograms with independent phases, shown one after the other");
  v.count("seed", p.seed, "seed of every random number");
}

// --- render: Scene → Image ----------------------------------------------------------------------

/// What gathers the light of a picture: a pinhole, a round lens, or the panel's own area within its acceptance.
enum class Lens { pinhole, round, panel };

/// The picture of a scene that an eye before the panel takes.
struct RenderParams {
  int columns = 0, rows = 512;        ///< of the picture [pixels]; columns 0: square
  double field_of_view = 0;           ///< half angle over the height [rad]; 0: the panel's acceptance
  Vec3 eye{0, 0, 0};                  ///< place of the lens [m], on the panel or before it: z ≥ 0
  Lens lens = Lens::pinhole;          ///< what gathers the light
  double pupil = 4e-3;                ///< diameter of the round lens [m]
  double focus = 0.3;                 ///< distance from the panel to the plane in focus [m]
  int paths = 64;                     ///< light paths per pixel
  int max_depth = 8;                  ///< surfaces on a path
  double clamp = 0;                   ///< most radiance that one path may bring [W/m²/sr]; 0: no clamp
  std::vector<std::string> layers{};  ///< light path expressions, added up; none: all light
  bool has_background = true;         ///< shown where no surface is; the waves of a hologram have none there
  int64_t seed = 1;                   ///< of every random number
};

template <class Visitor>
void describe(Visitor& v, RenderParams& p) {
  v.count("columns", p.columns, "width in pixels; 0: square");
  v.count("rows", p.rows, "height in pixels");
  v.angle("field_of_view", p.field_of_view,
          "half angle over the height; 0 deg: the panel's acceptance asin(lambda/2p)");
  v.position("eye", p.eye, "place of the lens, on the panel or before it (z of 0 m or more)");
  v.choice("lens", p.lens, {{"pinhole", Lens::pinhole}, {"round", Lens::round}, {"panel", Lens::panel}},
           "a pinhole, a round pupil, or the panel's own area");
  v.length("pupil", p.pupil, "diameter of the round lens");
  v.length("focus", p.focus, "distance from the panel to the plane in focus");
  v.count("paths", p.paths, "light paths per pixel");
  v.count("max_depth", p.max_depth, "most surfaces on a path");
  v.number("clamp", p.clamp, "most radiance that one path may bring; 0: no clamp");
  v.texts("layers", p.layers, "light path expressions, added up; none: all light");
  v.flag("background", p.has_background, "shown where no surface is; the pictures that run compares with leave it out");
  v.count("seed", p.seed, "seed of every random number");
}

// --- synthesize: Sources → Field ----------------------------------------------------------------

/// How light reaches the panel. Of waves: summed one by one in double; tile by tile; by way of planes near each tile;
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
      "how waves are summed: one by one in double, tile by tile, by planes near each tile, in slices of depth, the "
      "cheapest that meets the tolerance (auto); or a scene's surfaces as triangles that shine");
  v.number("tolerance", p.tolerance, "relative L2 error allowed against exact");
  v.count("slices", p.slices, "layers: slices of depth; 0: as many as the tolerance needs");
  v.flag("silhouettes", p.has_silhouettes, "layers: each slice hides what lies behind it");
  v.choice("shading", p.shading, {{"flat", Shading::flat}, {"smooth", Shading::smooth}},
           "triangles: each shines evenly, or from corner to corner");
  v.choice("triangle_phase", p.triangle_phase,
           {{"random", TrianglePhase::random}, {"constant", TrianglePhase::constant}},
           "triangles: one for each, or 0 for all");
}

// --- encode: Field → Hologram -------------------------------------------------------------------

/// What a pixel of a hologram holds: the phase, the modulus, or the interference with a tilted reference.
enum class Encoding { phase, amplitude, off_axis };

/// How the field on the panel becomes levels of its pixels.
struct EncodeParams {
  Encoding method = Encoding::phase;           ///< what a pixel holds
  ImageSide image = ImageSide::virtual_image;  ///< show U (virtual) or its conjugate (real)
  /// Of the off-axis reference [rad]; both 0: sin = 3λ/8p in x, λ/4p without bias.
  double reference_angle_x = 0, reference_angle_y = 0;
  double reference_ratio = 1;  ///< amplitude of the reference over the largest |U|
  bool with_bias = true;       ///< keep I_U + I_R of Eq. 9
  int levels = 0;              ///< 0: as many as the SLM has
};

template <class Visitor>
void describe(Visitor& v, EncodeParams& p) {
  v.choice("method", p.method,
           {{"phase", Encoding::phase}, {"amplitude", Encoding::amplitude}, {"off-axis", Encoding::off_axis}},
           "what a pixel holds: the phase, the modulus, or the interference with a tilted reference");
  v.choice("image", p.image, {{"virtual", ImageSide::virtual_image}, {"real", ImageSide::real_image}},
           "show U (scene behind the panel) or conj(U) (points focus in front of it)");
  v.angle("reference_angle_x", p.reference_angle_x,
          "off-axis: tilt of the reference in x; both 0 deg: asin(3 lambda/8p) in x, asin(lambda/4p) without bias");
  v.angle("reference_angle_y", p.reference_angle_y, "off-axis: tilt of the reference in y");
  v.number("reference_ratio", p.reference_ratio, "off-axis: amplitude of the reference over the largest |U|");
  v.flag("with_bias", p.with_bias, "off-axis: keep the terms I_U + I_R of Eq. 9");
  v.count("levels", p.levels, "levels; 0: as many as the SLM has");
}

// --- show: Hologram → Field ---------------------------------------------------------------------

/// The light on the panel, and how finely the field that leaves it is sampled.
struct ShowParams {
  int subpixels = 1;      ///< samples per pixel and axis: n holds the orders |m| ≤ (n−1)/2
  double wavelength = 0;  ///< of the illumination [m]; 0: the hologram's
  double irradiance = 1;  ///< of the illumination [W/m²]
};

template <class Visitor>
void describe(Visitor& v, ShowParams& p) {
  v.count("subpixels", p.subpixels, "samples per pixel and axis; 3 shows the orders -1, 0, 1");
  v.length("wavelength", p.wavelength, "of the plane wave on the SLM; 0 m: the hologram's own");
  v.number("irradiance", p.irradiance, "of that wave in W/m2");
}

// --- propagate: Field → Field -------------------------------------------------------------------

/// By which transfer function a field travels through free space; automatic: the one that the sampling allows.
enum class PropagationMethod { automatic, angular_spectrum, rayleigh_sommerfeld, fresnel };

/// How a field travels through free space, and the window it arrives in.
struct PropagateParams {
  PropagationMethod method = PropagationMethod::automatic;  ///< of the transfer function
  int columns = 0, rows = 0;                                ///< of the output window [samples]; 0: as the input
  double pitch = 0;                                         ///< of the output's samples [m]; 0: the input's
  double centre_x = 0, centre_y = 0;                        ///< of the output window [m]
  bool is_periodic = false;  ///< the window repeats for ever: no padding, by the angular spectrum
};

template <class Visitor>
void describe(Visitor& v, PropagateParams& p) {
  v.choice("method", p.method,
           {{"auto", PropagationMethod::automatic},
            {"angular-spectrum", PropagationMethod::angular_spectrum},
            {"rayleigh-sommerfeld", PropagationMethod::rayleigh_sommerfeld},
            {"fresnel", PropagationMethod::fresnel}},
           "auto takes the one that the sampling condition allows");
  v.count("columns", p.columns, "of the output window; 0: as the input");
  v.count("rows", p.rows, "of the output window; 0: as the input");
  v.length("pitch", p.pitch, "of the output's samples; 0 m: the input's");
  v.coordinate("centre_x", p.centre_x, "of the output window");
  v.coordinate("centre_y", p.centre_y, "of the output window");
  v.flag("periodic", p.is_periodic, "the window repeats for ever, as for gratings and plane waves: no padding");
}

// --- expose: Field → Image ----------------------------------------------------------------------

/// A sensor without a lens, as on the paper's bench, or an eye, and what of its reading goes into a picture.
struct CameraParams {
  std::vector<double> distances{0.3};  ///< from the panel to the planes looked at [m], ≥ 0
  double pupil = 0;                    ///< diameter of the eye's pupil [m]; 0: all light that leaves the panel
  Vec3 eye{0, 0, 0};                   ///< place of that pupil [m], on the panel or before it: z ≥ 0
  double width = 0, height = 0;        ///< of the sensor [m]; 0: the panel's
  double centre_x = 0, centre_y = 0;   ///< of the sensor [m]
  double pixel = 0;                    ///< side of a sensor pixel [m]; 0: `binning` field samples
  int binning = 0;      ///< field samples per sensor pixel and axis; 0: one panel pixel, or as `pixel` needs
  double exposure = 0;  ///< irradiance that is white [W/m²]; 0: the 99.9th percentile
  int bits = 8;         ///< of a PNG: 8 or 16
};

template <class Visitor>
void describe(Visitor& v, CameraParams& p) {
  v.lengths("distances", p.distances, "from the panel to the planes looked at");
  v.length("pupil", p.pupil, "diameter of the eye's pupil; 0 m: all light that leaves the panel");
  v.position("eye", p.eye, "place of that pupil, on the panel or before it (z of 0 m or more)");
  v.length("width", p.width, "of the sensor; 0 m: the panel's");
  v.length("height", p.height, "of the sensor; 0 m: the panel's");
  v.coordinate("centre_x", p.centre_x, "of the sensor");
  v.coordinate("centre_y", p.centre_y, "of the sensor");
  v.length("pixel", p.pixel, "side of a sensor pixel; 0 m: as binning says");
  v.count("binning", p.binning,
          "field samples per sensor pixel and axis; 0: one panel pixel, or with pixel as many as hold the light");
  v.number("exposure", p.exposure, "irradiance that is white in W/m2; 0: the 99.9th percentile");
  v.count("bits", p.bits, "of a PNG, 8 or 16");
}

}  // namespace holotrace
