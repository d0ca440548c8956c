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

/// What finds the surface that a ray meets: Embree's trees, or the uniform subdivision of the paper's appendix.
enum class Acceleration { embree, grid };

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
  Acceleration accelerator = Acceleration::embree;  ///< of the rays
  int64_t seed = 1;                                 ///< of every random number
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
  v.choice("accelerator", p.accelerator, {{"embree", Acceleration::embree}, {"grid", Acceleration::grid}},
           "of the rays: Embree's trees, or a uniform grid of cells (the paper's appendix)");
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
  double eye_separation = 0;          ///< of two eyes along x, about `eye` [m]: a stereo pair; 0: one eye
  int paths = 64;                     ///< light paths per pixel
  int max_depth = 8;                  ///< surfaces on a path
  double clamp = 0;                   ///< most radiance that one path may bring [W/m²/sr]; 0: no clamp
  std::vector<std::string> layers{};  ///< light path expressions, added up; none: all light
  bool has_background = true;         ///< shown where no surface is; the waves of a hologram have none there
  Acceleration accelerator = Acceleration::embree;  ///< of the rays
  int64_t seed = 1;                                 ///< of every random number
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
  v.length("eye_separation", p.eye_separation,
           "of two eyes along x, about eye: a stereo pair and its anaglyph; 0 m: one");
  v.count("paths", p.paths, "light paths per pixel");
  v.count("max_depth", p.max_depth, "most surfaces on a path");
  v.number("clamp", p.clamp, "most radiance that one path may bring; 0: no clamp");
  v.texts("layers", p.layers, "light path expressions, added up; none: all light");
  v.flag("background", p.has_background, "shown where no surface is; the pictures that run compares with leave it out");
  v.choice("accelerator", p.accelerator, {{"embree", Acceleration::embree}, {"grid", Acceleration::grid}},
           "of the rays: Embree's trees, or a uniform grid of cells (the paper's appendix)");
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

/// How a field becomes levels: by its phase; its modulus; its interference with a tilted reference; both phase and
/// modulus of a complex panel; two phases in turn; phases whose errors go to their neighbours; by alternate projections
/// (plain or weighted); by gradient descent through the panel and free space; or two levels alone.
enum class Encoding {
  phase,
  amplitude,
  off_axis,
  complex,
  double_phase,
  error_diffusion,
  gerchberg_saxton,
  weighted_gerchberg_saxton,
  sgd,
  binary
};

/// What iterations begin with, and what phase a picture that is a target gets: the field's own (a picture's: 0), or a
/// random one.
enum class StartPhase { field, random };

/// In what the two levels of a binary hologram differ.
enum class BinaryLevels { panel, phase, amplitude };

/// How the field on the panel becomes levels of its pixels.
struct EncodeParams {
  Encoding method = Encoding::phase;           ///< of making levels
  ImageSide image = ImageSide::virtual_image;  ///< show U (virtual) or its conjugate (real)
  /// Of the off-axis reference [rad]; both 0: sin = 3λ/8p in x, λ/4p without bias.
  double reference_angle_x = 0, reference_angle_y = 0;
  double reference_ratio = 1;                        ///< amplitude of the reference over the largest |U|
  bool with_bias = true;                             ///< keep I_U + I_R of Eq. 9
  int levels = 0;                                    ///< 0: as many as the SLM has
  BinaryLevels binary_levels = BinaryLevels::panel;  ///< of the method binary; panel: what the panel modulates
  /// Half width of the stop that double-phase and error-diffusion ask the camera for, as a part of 1/2p.
  double stop = 0.4;
  std::vector<double> target_distances{};   ///< of the planes that iterations look at [m], ≥ 0
  int target_columns = 0, target_rows = 0;  ///< part of those planes that counts, about the axis [pixels]; 0: all
  bool resample = false;                    ///< a target picture of another size to that part
  bool is_joint = false;                    ///< one hologram for all wavelengths, or one for each
  int iterations = 0;                       ///< 0: 50 of Gerchberg–Saxton, 200 of sgd
  double step = 0;                          ///< sgd: of the phase in an iteration [rad]; 0: as found best
  StartPhase start = StartPhase::field;     ///< of iterations, and of a target picture
  int64_t seed = 1;                         ///< of random starts
  std::vector<std::string> effects{};       ///< of the panel, which the levels allow for; "all"
};

template <class Visitor>
void describe(Visitor& v, EncodeParams& p) {
  v.choice("method", p.method,
           {{"phase", Encoding::phase},
            {"amplitude", Encoding::amplitude},
            {"off-axis", Encoding::off_axis},
            {"complex", Encoding::complex},
            {"double-phase", Encoding::double_phase},
            {"error-diffusion", Encoding::error_diffusion},
            {"gerchberg-saxton", Encoding::gerchberg_saxton},
            {"weighted-gerchberg-saxton", Encoding::weighted_gerchberg_saxton},
            {"sgd", Encoding::sgd},
            {"binary", Encoding::binary}},
           "what a pixel holds: the phase, the modulus, the interference with a tilted reference, both (complex "
           "panels), two phases in turn, phases with their errors diffused, phases found by iterations, or two levels");
  v.choice("image", p.image, {{"virtual", ImageSide::virtual_image}, {"real", ImageSide::real_image}},
           "show U (scene behind the panel) or conj(U) (points focus in front of it)");
  v.angle("reference_angle_x", p.reference_angle_x,
          "off-axis: tilt of the reference in x; both 0 deg: asin(3 lambda/8p) in x, asin(lambda/4p) without bias");
  v.angle("reference_angle_y", p.reference_angle_y, "off-axis: tilt of the reference in y");
  v.number("reference_ratio", p.reference_ratio, "off-axis: amplitude of the reference over the largest |U|");
  v.flag("with_bias", p.with_bias, "off-axis: keep the terms I_U + I_R of Eq. 9");
  v.count("levels", p.levels, "levels; 0: as many as the SLM has");
  v.choice("binary_levels", p.binary_levels,
           {{"panel", BinaryLevels::panel}, {"phase", BinaryLevels::phase}, {"amplitude", BinaryLevels::amplitude}},
           "binary: two phases half a turn apart, or dark and bright; panel: as the panel modulates");
  v.number("stop", p.stop, "double-phase, error-diffusion: half width of the camera's stop as a part of 1/2p");
  v.lengths("target_distances", p.target_distances, "iterations: planes that the image is made for");
  v.count("target_columns", p.target_columns, "iterations, pictures: width of the part that counts; 0: the panel's");
  v.count("target_rows", p.target_rows, "iterations, pictures: height of the part that counts; 0: the panel's");
  v.flag("resample", p.resample, "a target picture of another size to the part that counts");
  v.flag("joint", p.is_joint, "iterations: one hologram for all wavelengths, or one for each");
  v.count("iterations", p.iterations, "0: 50 of gerchberg-saxton, 200 of sgd, 30 for the field of a picture");
  v.number("step", p.step, "sgd: of the phase in an iteration, in radians; 0: 0.4");
  v.choice("start", p.start, {{"field", StartPhase::field}, {"random", StartPhase::random}},
           "of iterations and of target pictures: the field's own phase (a picture's is 0), or a random one");
  v.count("seed", p.seed, "of random starts");
  v.texts("effects", p.effects,
          "of the panel that the levels allow for: calibration; sgd: crosstalk, gaps, aberration, phase-map, "
          "dead-pixels, too; or all");
}

// --- show: Hologram → Field ---------------------------------------------------------------------

/// The shape of the light on the panel.
enum class Wavefront { plane, spherical, gaussian };

/// The light on the panel, what of the panel is modelled, and how finely the field that leaves it is sampled.
struct ShowParams {
  int subpixels = 1;      ///< samples per pixel and axis: n holds the orders |m| ≤ (n−1)/2
  int fine_samples = 0;   ///< per pixel and axis on which crosstalk is modelled; 0: as it needs
  double wavelength = 0;  ///< of the illumination [m]; 0: the hologram's
  double irradiance = 1;  ///< of the illumination, on the axis [W/m²]
  Wavefront light = Wavefront::plane;
  double tilt_x = 0, tilt_y = 0;  ///< of the light from the panel's axis [rad]
  double source_distance = 0;     ///< spherical: from the point it comes from [m]; < 0: it goes to a point before
  double beam_radius = 0;         ///< Gaussian: at 1/e² of the irradiance, on the panel [m]
  double bandwidth = 0;           ///< full width at half maximum of the light's spectrum, a Gaussian [m]
  double source_angle = 0;        ///< full angle that the source is seen under from the panel, a disc [rad]
  int moments = 0;                ///< that partly coherent light and flicker are averaged over; 0: 16, or 1 without
  std::vector<std::string> effects{};  ///< of the panel that are on; "all"
};

template <class Visitor>
void describe(Visitor& v, ShowParams& p) {
  v.count("subpixels", p.subpixels, "samples per pixel and axis; 3 shows the orders -1, 0, 1");
  v.count("fine_samples", p.fine_samples, "per pixel and axis, for crosstalk; 0: as it needs");
  v.length("wavelength", p.wavelength, "of the light on the SLM; 0 m: the hologram's own");
  v.number("irradiance", p.irradiance, "of that light, on the axis, in W/m2");
  v.choice("light", p.light,
           {{"plane", Wavefront::plane}, {"spherical", Wavefront::spherical}, {"gaussian", Wavefront::gaussian}},
           "its wavefront and profile");
  v.angle("tilt_x", p.tilt_x, "of the light from the panel's axis, toward x");
  v.angle("tilt_y", p.tilt_y, "of the light from the panel's axis, toward y");
  v.coordinate("source_distance", p.source_distance,
               "spherical: from the point that the light comes from to the panel; below 0: to which it converges");
  v.length("beam_radius", p.beam_radius, "gaussian: of the beam on the panel, at 1/e2 of its irradiance");
  v.length("bandwidth", p.bandwidth, "of the light's spectrum, full width at half maximum; 0 m: one line");
  v.angle("source_angle", p.source_angle, "full angle that the light's source is seen under; 0 deg: a point");
  v.count("moments", p.moments, "that partly coherent light and flicker are averaged over; 0: 16, or 1 without them");
  v.texts(
      "effects", p.effects,
      "of the panel that are on: calibration, crosstalk, gaps, flicker, aberration, phase-map, dead-pixels, or all");
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

/// What a series of views moves: nothing, the plane in focus, or the eye along x.
enum class Sweep { none, focus, parallax };

/// A sensor without a lens, as on the paper's bench, a camera with a thin lens, or an eye, and what of its reading goes
/// into a picture.
struct CameraParams {
  std::vector<double> distances{0.3};  ///< from the panel to the planes looked at [m], ≥ 0
  double pupil = 0;              ///< diameter of the eye's pupil or the lens [m]; 0: all light that leaves the panel
  Vec3 eye{0, 0, 0};             ///< place of that pupil [m], on the panel or before it: z ≥ 0
  double focal_length = 0;       ///< of a thin lens in the pupil [m]: sizes are then those on its sensor
  double width = 0, height = 0;  ///< of the sensor [m]; 0: the panel's
  double centre_x = 0, centre_y = 0;  ///< of the sensor [m]
  double pixel = 0;                   ///< side of a sensor pixel [m]; 0: `binning` field samples
  int binning = 0;        ///< field samples per sensor pixel and axis; 0: one panel pixel, or as `pixel` needs
  double exposure = 0;    ///< irradiance that is white [W/m²]; 0: the 99.9th percentile
  int bits = 8;           ///< of a PNG: 8 or 16
  double electrons = 0;   ///< that a white pixel holds, with their shot noise; 0: no noise of light
  double read_noise = 0;  ///< of a pixel, rms, with `electrons` [electrons]
  int64_t noise_seed = 1;
  Sweep sweep = Sweep::none;            ///< a series of views beside those at `distances`
  int sweep_views = 24;                 ///< of the series
  double sweep_from = 0, sweep_to = 0;  ///< focus: distances; parallax: x of the eye [m]
  double sweep_seconds = 2;             ///< of the animated file, there and back
};

template <class Visitor>
void describe(Visitor& v, CameraParams& p) {
  v.lengths("distances", p.distances, "from the panel to the planes looked at");
  v.length("pupil", p.pupil, "diameter of the eye's pupil or the lens; 0 m: all light that leaves the panel");
  v.position("eye", p.eye, "place of that pupil, on the panel or before it (z of 0 m or more)");
  v.length(
      "focal_length", p.focal_length,
      "of a thin lens in the pupil: width, height and pixel are then those of its sensor; 0 m: no lens, or an eye");
  v.length("width", p.width, "of the sensor; 0 m: the panel's");
  v.length("height", p.height, "of the sensor; 0 m: the panel's");
  v.coordinate("centre_x", p.centre_x, "of the sensor");
  v.coordinate("centre_y", p.centre_y, "of the sensor");
  v.length("pixel", p.pixel, "side of a sensor pixel; 0 m: as binning says");
  v.count("binning", p.binning,
          "field samples per sensor pixel and axis; 0: one panel pixel, or with pixel as many as hold the light");
  v.number("exposure", p.exposure, "irradiance that is white in W/m2; 0: the 99.9th percentile");
  v.count("bits", p.bits, "of a PNG, 8 or 16");
  v.number("electrons", p.electrons, "that a white pixel holds, with their shot noise; 0: no noise");
  v.number("read_noise", p.read_noise, "of a pixel, rms, in electrons");
  v.count("noise_seed", p.noise_seed, "seed of the noise");
  v.choice("sweep", p.sweep, {{"none", Sweep::none}, {"focus", Sweep::focus}, {"parallax", Sweep::parallax}},
           "a series of views and its animation: through distances, or with the eye moving along x");
  v.count("sweep_views", p.sweep_views, "of the series");
  v.coordinate("sweep_from", p.sweep_from, "first distance (focus), or first x of the eye (parallax)");
  v.coordinate("sweep_to", p.sweep_to, "last distance, or last x of the eye");
  v.number("sweep_seconds", p.sweep_seconds, "of the animation, there and back");
}

}  // namespace holotrace
