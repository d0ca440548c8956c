#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <string>
#include <vector>

#include "holotrace/base/vec.h"
#include "holotrace/data/field.h"
#include "holotrace/data/params/parameter.h"
#include "holotrace/data/params/path_tracing.h"

// encode: Field → Hologram

namespace holotrace {

/// How a field becomes levels: its phase; its modulus; its interference with a tilted reference beam; both phase and
/// modulus (complex panels); two phases on alternate pixels; phases with error diffusion; iterated projections
/// (Gerchberg–Saxton, plain or weighted); gradient descent through the panel and free space; or two levels. The
/// automatic choice is that of run/choose.h for scenes, `phase` for a field, and `sgd` for a picture, a focal stack or a light field.
enum class Encoding {
  automatic,
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

/// The methods' names in scene files, flags, reports and messages.
inline constexpr std::initializer_list<Choice<Encoding>> encoding_names{
    {"auto", Encoding::automatic},
    {"phase", Encoding::phase},
    {"amplitude", Encoding::amplitude},
    {"off-axis", Encoding::off_axis},
    {"complex", Encoding::complex},
    {"double-phase", Encoding::double_phase},
    {"error-diffusion", Encoding::error_diffusion},
    {"gerchberg-saxton", Encoding::gerchberg_saxton},
    {"weighted-gerchberg-saxton", Encoding::weighted_gerchberg_saxton},
    {"sgd", Encoding::sgd},
    {"binary", Encoding::binary}};

/// What a method does with a field. What it can do with a panel follows.
struct EncodingTraits {
  bool keeps_modulus = true, keeps_phase = true;  ///< of the field
  bool writes_fringes = false;   ///< of the field with a tilted reference wave; the stop passes one order
  bool aims_at_targets = false;  ///< finds its levels by iterations
  bool is_pointwise = true;      ///< finds each pixel by itself, so that devices can, too
  double stop = 1;               ///< EncodeParams::stop if none is asked for
};
constexpr EncodingTraits traits_of(Encoding method) {
  switch (method) {
    case Encoding::phase:
      return {.keeps_modulus = false};
    case Encoding::amplitude:
      return {.keeps_phase = false};
    case Encoding::off_axis:
      return {.writes_fringes = true};
    case Encoding::double_phase:
      return {.stop = 0.4};
    case Encoding::error_diffusion:
      return {.is_pointwise = false, .stop = 0.4};
    case Encoding::gerchberg_saxton:
    case Encoding::weighted_gerchberg_saxton:
    case Encoding::sgd:
      return {.aims_at_targets = true, .is_pointwise = false};
    case Encoding::binary:
      return {.keeps_modulus = false, .writes_fringes = true};
    case Encoding::complex:
    case Encoding::automatic:
      break;
  }
  return {};
}

/// The method, or another one if it is automatic.
inline Encoding method_or(Encoding given, Encoding otherwise) {
  return given == Encoding::automatic ? otherwise : given;
}

/// Start phase of iterations, and phase of a target picture: the field's own phase (0 for a picture), or random.
enum class StartPhase { field, random };

/// What iterations aim at: the modulus of the field on the panel, carried to the target planes; the light that the
/// path tracer finds in the target planes (a focal stack); or that and what eyes anywhere before the panel see. The
/// automatic choice is that of run/choose.h for scenes, and `field` for a field.
enum class EncodeTarget { automatic, field, render, light_field };

/// The names of the targets.
inline constexpr std::initializer_list<Choice<EncodeTarget>> target_names{{"auto", EncodeTarget::automatic},
                                                                          {"field", EncodeTarget::field},
                                                                          {"render", EncodeTarget::render},
                                                                          {"light-field", EncodeTarget::light_field}};

/// How much time a hologram of a scene is worth. It chooses the numbers of frames, target planes, iterations and light
/// paths (run/choose.h); automatic: draft.
enum class Quality { automatic, draft, good, best };

/// The names of the qualities.
inline constexpr std::initializer_list<Choice<Quality>> quality_names{
    {"auto", Quality::automatic}, {"draft", Quality::draft}, {"good", Quality::good}, {"best", Quality::best}};

/// Quantity in which the two levels of a binary hologram differ.
enum class BinaryLevels { panel, phase, amplitude };

/// Defaults of the iterations, and of the step of sgd from random phases of one frame [rad], used where 0 is given.
inline constexpr int gerchberg_saxton_iterations = 50, sgd_iterations = 200, target_field_iterations = 30;
inline constexpr int most_target_planes = 16;
inline constexpr double sgd_step = 0.4;

/// The step of sgd from the holograms of the last picture, over the relative error of the amplitude that they show [rad]; and the
/// largest loss, the square of that error, from which it goes on: of a smooth start it is about the same.
inline constexpr double sgd_next_step = 0.4, sgd_far_loss = 0.07;

/// Pupil and diameter of the eyebox of eyes that are given without them [m].
inline constexpr double eye_pupil = 3e-3, eye_box = 2e-3;

/// Where the middle of a pupil may be, about an eye in its plane: an ellipse, a rectangle, or anywhere before the panel.
struct Eyebox {
  double width = 0, height = 0;  ///< [m]
  bool is_round = false, is_all = false;

  /// How far out the offset of a pupil from the eye is: 0 in the middle, 1 at the edge.
  double part_of_way_out(double x, double y) const {
    if (!is_round) return std::max(std::abs(x) / (width / 2), std::abs(y) / (height / 2));
    return std::hypot(x, y) / (width / 2);
  }
};

/// How the field on the panel becomes the levels of its pixels.
struct EncodeParams {
  Encoding method = Encoding::automatic;       ///< what a pixel's level represents
  ImageSide image = ImageSide::virtual_image;  ///< show U (virtual) or its conjugate (real)
  /// Tilt of the off-axis reference [rad]; both 0: sin = 3λ/8p in x, λ/4p without bias.
  double reference_angle_x = 0, reference_angle_y = 0;
  double reference_ratio = 1;                        ///< amplitude of the reference over the largest |U|
  bool with_bias = true;                             ///< keep I_U + I_R of Eq. 9
  int levels = 0;                                    ///< number of levels; 0: as many as the SLM has
  BinaryLevels binary_levels = BinaryLevels::panel;  ///< method binary: quantity of the two levels
  /// Half width of the camera's stop as a fraction of 1/2p; 0: 1, or 0.4 for double-phase and error-diffusion, which
  /// need one. 1: no stop.
  double stop = 0;
  EncodeTarget target = EncodeTarget::automatic;  ///< what iterations aim at
  Denoise denoise = Denoise::automatic;           ///< targets render, light-field: which are denoised
  Quality quality = Quality::automatic;           ///< scenes: chooses frames, planes, iterations and paths not given
  std::vector<double>
      target_distances{};     ///< iterations: distances of the target planes from the panel [m]; < 0: on the other side
  std::vector<double> eye{};  ///< eyes that the light is for: x, y and z of each [m]; none: all that look
  double pupil = 0;           ///< diameter of their pupils [m]; 0: eye_pupil
  std::vector<std::string> eyebox{};  ///< box about each eye: diameter, width and height, or "all"; none: eye_box
  int planes = 0;  ///< targets render, light-field: most planes of the program's own choice; 0: 16, or by quality
  int target_columns = 0, target_rows = 0;  ///< part of those planes that the error counts, centred [pixels]; 0: all
  bool resample = false;                    ///< scale a target picture of another size to that part
  bool is_joint = false;                    ///< sgd: one hologram for all wavelengths
  int iterations = 0;                       ///< number of iterations; 0: the default of the method, above
  int next_iterations = 0;                  ///< sgd from the holograms of the last picture: their number; 0: a fifth
  bool is_rolling = false;                  ///< sgd from the frames of the last picture: find one new frame
  double least_gain = 0;                    ///< sgd: end early if the loss falls by less than this [dB]; 0: never
  double step = 0;  ///< sgd: step of the phase in the first iterations [rad]; 0: as the start and the frames need
  int planes_per_update = 1;             ///< sgd: number of target planes in each iteration, in turn; 0: all
  int subpixels = 1;                     ///< sgd: samples of the light per pixel and axis; 1: diffraction order 0
  StartPhase start = StartPhase::field;  ///< start phase of iterations, and phase of a target picture
  int64_t seed = 1;                      ///< seed for random start phases
  DeviceChoice device{};                 ///< device that computes the hologram; sgd: or all at once
  std::vector<std::string>
      effects{};  ///< effects of the panel that the levels compensate; or "all"; none named: its own
};

/// Number of iterations of a method: as many as asked for, or for 0 the method's default; 0 for methods without any.
inline int iterations_of(const EncodeParams& params) {
  if (!traits_of(params.method).aims_at_targets) return 0;
  if (params.iterations > 0) return params.iterations;
  return params.method == Encoding::sgd ? sgd_iterations : gerchberg_saxton_iterations;
}

/// Number of iterations of sgd from the holograms of the last picture of a film: as many as asked for, or for 0 a fifth of those
/// of a still, and 3 or more.
inline int next_iterations_of(const EncodeParams& params) {
  if (params.next_iterations > 0) return params.next_iterations;
  return std::max(3, (iterations_of(params) + 2) / 5);
}

/// Half width of the stop of a method as a fraction of 1/2p: the one asked for, or the method's default; 1 means none.
inline double stop_width(const EncodeParams& params) {
  return params.stop > 0 ? params.stop : traits_of(params.method).stop;
}

template <class Visitor>
void describe(Visitor&& v, EncodeParams& p) {
  v(choice(
      "method", p.method, encoding_names,
      "what a pixel's level represents: the phase; the modulus (amplitude); the interference with a tilted reference "
      "(off-axis); both phase and modulus (complex); two phases on alternate pixels (double-phase); the phase with "
      "its error diffused; a phase found by iterations (gerchberg-saxton, its weighted form, sgd); two levels "
      "(binary); auto: for scenes sgd, or, if a parameter of waves is given, phase (off-axis on amplitude panels, "
      "complex on "
      "complex panels); for fields phase; for pictures, focal stacks and light fields sgd"));
  v(choice(
      "image", p.image, image_side_names,
      "field that is shown: U (virtual: the scene is behind the panel) or conj(U) (real: it focuses in front of it)"));
  v(angle("reference_angle_x", p.reference_angle_x, range::tilt,
          "off-axis, binary: tilt of the reference in x; if both tilts are 0 deg: asin(3 lambda/8p), or "
          "asin(lambda/4p) for binary and without bias"));
  v(angle("reference_angle_y", p.reference_angle_y, range::tilt, "off-axis, binary: tilt of the reference in y"));
  v(number("reference_ratio", p.reference_ratio, range::positive,
           "off-axis: amplitude of the reference over the largest |U|"));
  v(flag("with_bias", p.with_bias, "off-axis: keep the terms I_U + I_R of Eq. 9"));
  v(count("levels", p.levels, range::or_value(0, range::from_to(2, 65536)),
          "number of levels; 0: as many as the SLM has"));
  v(choice(
      "binary_levels", p.binary_levels,
      {{"panel", BinaryLevels::panel}, {"phase", BinaryLevels::phase}, {"amplitude", BinaryLevels::amplitude}},
      "binary: quantity of the two levels: phase (0 and pi), amplitude (dark and bright), or what the panel modulates"));
  v(number(
      "stop", p.stop, range::fraction,
      "half width of the camera's stop as a fraction of 1/2p, for double-phase, error-diffusion and iterations; 1: "
      "no stop; 0: 0.4 for double-phase and error-diffusion, else 1"));
  v(choice(
      "target", p.target, target_names,
      "sgd, scenes: light that the holograms show: the modulus of the field of all waves (field); the path-traced "
      "light in planes through the scene (render); or that light and the views through pupils anywhere in front of "
      "the panel (light-field); auto: field if a parameter of waves is given, else render"));
  v(choice("denoise", p.denoise, denoise_names,
           "targets render, light-field: denoising of the targets by Open Image Denoise 2, if it is installed: where "
           "their noise is visible (auto); none; or all"));
  v(choice(
      "quality", p.quality, quality_names,
      "scenes: time that the picture is worth: number of frames, target planes (at most), iterations, and light paths "
      "per pixel, where none is given; draft: 1 (deep scenes: 4), 4, 30, 32; good: 8, 16, 70, 128; best: 16, 24, "
      "200, 256; targets that are denoised take an eighth of the paths, for eyes a quarter; auto: draft; with draft, good or best the method is sgd"));
  v(lengths("target_distances", p.target_distances, range::any,
            "iterations: distances of the target planes from the panel"));
  v(lengths("eye", p.eye, range::any,
            "sgd, scenes: position x y z of the eye that the light is for, in front of the panel (z above 0 m); three "
            "lengths for each of several eyes; empty: light for the whole space before the panel"));
  v(length("pupil", p.pupil, range::not_negative, "diameter of the eye's pupil; 0 m: the camera's, or 3 mm"));
  v(texts("eyebox", p.eyebox,
          "eyebox: area around the eye in which the centre of the pupil may be: a diameter (\"2 mm\"), a width and a "
          "height (\"6 2 mm\"), or \"all\" (anywhere in front of the panel); empty: 2 mm"));
  v(count("planes", p.planes, range::not_negative,
          "targets render, light-field: largest number of planes through the scene, if target_distances gives none; 0: "
          "16, or as quality says"));
  v(count("target_columns", p.target_columns, range::not_negative,
          "iterations, pictures: width in pixels of the part of a target plane that the error counts; 0: the panel's"));
  v(count("target_rows", p.target_rows, range::not_negative,
          "iterations, pictures: height in pixels of that part; 0: the panel's"));
  v(flag("resample", p.resample,
         "scaling of a target picture of another size to fit target_columns x target_rows, with its aspect ratio kept; "
         "false: such a picture is an error"));
  v(flag("joint", p.is_joint, "sgd: one hologram for all wavelengths; false: one for each"));
  v(count(
      "iterations", p.iterations, range::not_negative,
      fmt::format("number of iterations; 0: {} for gerchberg-saxton; {} for sgd, but as quality says for scenes with "
                  "the target render or light-field; {} for the field of a target picture",
                  gerchberg_saxton_iterations, sgd_iterations, target_field_iterations)));
  v(count("next_iterations", p.next_iterations, range::not_negative,
          "sgd, films: number of iterations from the holograms of the last picture; 0: a fifth of iterations, 3 or "
          "more"));
  v(flag("rolling", p.is_rolling,
         "sgd, films: one new frame that takes the place of the first of the last picture, found for the mean light of "
         "itself and the others; false: all frames are new"));
  v(number("least_gain", p.least_gain, range::not_negative,
           "sgd: stopping criterion in dB: the iterations end early if the mean loss falls by less than this from one "
           "window of updates to the next; a window has 10 updates or more; 0: no early end"));
  v(number(
      "step", p.step, range::not_negative,
      fmt::format(
          "sgd: step of the phase in the first iterations in radians; 0: for one frame {:g} from random phases, 0.2 for "
          "eyes, and less from a smooth start; for several frames up to twice as much, but not for eyes and light-field",
          sgd_step)));
  v(count("planes_per_update", p.planes_per_update, range::not_negative,
          "sgd: number of target planes in each iteration, in turn; 0: all of them"));
  v(count("subpixels", p.subpixels, range::at_least(1),
          "sgd: samples of the light per pixel and axis; 1: diffraction order 0; 3: orders -1, 0 and 1 of each axis"));
  v(choice("start", p.start, {{"field", StartPhase::field}, {"random", StartPhase::random}},
           "start phase of iterations and phase of target pictures: the field's own (0 for a picture), or random"));
  v(count("seed", p.seed, range::not_negative, "seed for random start phases"));
  v(devices("device", p.device,
            "computes the hologram (error-diffusion: the processor only; opencl:all: for sgd only, whose frames the "
            "devices share)"));
  v(texts(
      "effects", p.effects,
      "panel effects that the encoding compensates: calibration, crystal, aberration, phase-map, light-map; with sgd "
      "all but flicker; all; or none; empty: those of the panel's own file"));
}

/// The eyes of an encoding. @throws Error  unless there are three lengths for each, and z is above 0
std::vector<Vec3> eyes_of(const EncodeParams& params);

/// The box about each eye. @throws Error  for a text that is neither one or two lengths above 0 nor "all"
Eyebox eyebox_of(const EncodeParams& params);

/// The diameter of the pupils of the eyes [m].
inline double pupil_of(const EncodeParams& params) { return params.pupil > 0 ? params.pupil : eye_pupil; }

template <>
inline constexpr bool runs_on_all_devices<EncodeParams> = true;  // sgd: check_encode_params

}  // namespace holotrace
