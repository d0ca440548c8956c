#pragma once

#include <fmt/format.h>

#include <cstdint>
#include <string>
#include <vector>

#include "holotrace/data/field.h"
#include "holotrace/data/params/choice.h"

// encode: Field → Hologram

namespace holotrace {

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

/// Iterations, and the step of sgd [rad], where 0 is given.
inline constexpr int gerchberg_saxton_iterations = 50, sgd_iterations = 200, target_field_iterations = 30;
inline constexpr double sgd_step = 0.4;

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
  int iterations = 0;                       ///< 0: as many as the method takes, above
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
  v.angle("reference_angle_x", p.reference_angle_x, range::tilt,
          "off-axis: tilt of the reference in x; both 0 deg: asin(3 lambda/8p) in x, asin(lambda/4p) without bias");
  v.angle("reference_angle_y", p.reference_angle_y, range::tilt, "off-axis: tilt of the reference in y");
  v.number("reference_ratio", p.reference_ratio, range::positive,
           "off-axis: amplitude of the reference over the largest |U|");
  v.flag("with_bias", p.with_bias, "off-axis: keep the terms I_U + I_R of Eq. 9");
  v.count("levels", p.levels, range::or_value(0, range::from_to(2, 65536)), "levels; 0: as many as the SLM has");
  v.choice("binary_levels", p.binary_levels,
           {{"panel", BinaryLevels::panel}, {"phase", BinaryLevels::phase}, {"amplitude", BinaryLevels::amplitude}},
           "binary: two phases half a turn apart, or dark and bright; panel: as the panel modulates");
  v.number("stop", p.stop, range::above_to(0, 1),
           "double-phase, error-diffusion: half width of the camera's stop as a part of 1/2p");
  v.lengths("target_distances", p.target_distances, range::not_negative,
            "iterations: planes that the image is made for");
  v.count("target_columns", p.target_columns, range::not_negative,
          "iterations, pictures: width of the part that counts; 0: the panel's");
  v.count("target_rows", p.target_rows, range::not_negative,
          "iterations, pictures: height of the part that counts; 0: the panel's");
  v.flag("resample", p.resample, "a target picture of another size to the part that counts");
  v.flag("joint", p.is_joint, "iterations: one hologram for all wavelengths, or one for each");
  static const std::string iterations =
      fmt::format("number of iterations; 0: {} of gerchberg-saxton, {} of sgd, {} for the field of a picture",
                  gerchberg_saxton_iterations, sgd_iterations, target_field_iterations);
  v.count("iterations", p.iterations, range::not_negative, iterations.c_str());
  static const std::string step = fmt::format("sgd: step of the phase in an iteration, in radians; 0: {:g}", sgd_step);
  v.number("step", p.step, range::not_negative, step.c_str());
  v.choice("start", p.start, {{"field", StartPhase::field}, {"random", StartPhase::random}},
           "of iterations and of target pictures: the field's own phase (a picture's is 0), or a random one");
  v.count("seed", p.seed, range::not_negative, "seed for random starts");
  v.texts("effects", p.effects,
          "of the panel that the levels allow for: calibration; sgd: crosstalk, gaps, aberration, phase-map, "
          "dead-pixels, too; or all");
}

}  // namespace holotrace
