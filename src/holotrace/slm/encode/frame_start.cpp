#include "holotrace/slm/encode/frame_start.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "holotrace/base/cycles.h"
#include "holotrace/base/error.h"
#include "holotrace/base/random.h"
#include "holotrace/base/threads.h"
#include "holotrace/base/units.h"
#include "holotrace/data/params/encode.h"
#include "holotrace/slm/encode/blank_hologram.h"
#include "holotrace/slm/encode/double_phase.h"
#include "holotrace/slm/encode/iterate/processor_loops.h"
#include "holotrace/slm/encode/iterate/target_propagation.h"
#include "holotrace/slm/encode/kinoform.h"
#include "holotrace/slm/encode/low_pass.h"
#include "holotrace/slm/encode/target.h"

namespace holotrace {
namespace {

const TargetPlane& middle_plane(const TargetSet& targets, double wavelength) {
  std::vector<const TargetPlane*> of_colour;
  for (const TargetPlane& target : targets.planes)
    if (target.wavelength == wavelength) of_colour.push_back(&target);
  require(!of_colour.empty(), "expected target planes at {}, got none", format_length(wavelength));
  return *of_colour[of_colour.size() / 2];
}

// A panel divided into as many cells as there are frames, in rows of equal length and as square as they can be.
struct Cells {
  int columns, rows;
};

Cells cells_of(int frames, const Grid& panel) {
  const double wanted = std::sqrt(frames * panel.width() / panel.height());
  int columns = 1;
  for (int n = 2; n <= frames; ++n)
    if (frames % n == 0 && std::abs(n - wanted) < std::abs(columns - wanted)) columns = n;
  return {columns, frames / columns};
}

// The field that shows the middle plane by a plane wave through the middle of a cell of the panel, or of the part of it whose
// tilts the panel and the stop let through. Its modulus is 1 or less; one in 100 pixels is clipped.
Field smooth_field(const TargetPlane& target, const FrameOfMany& which, const Slm& slm, const EncodeParams& params) {
  const Grid& panel = slm.grid;
  const Cells cells = cells_of(which.frames, panel);
  const double reach = stop_width(params) * target.wavelength * std::abs(target.z) / (2 * panel.pitch);
  const double x = ((which.frame % cells.columns + 0.5) / cells.columns - 0.5) * std::min(panel.width(), reach);
  const double y = ((which.frame / cells.columns + 0.5) / cells.rows - 0.5) * std::min(panel.height(), reach);
  const double per_metre = which.frames > 1 ? 1 / (target.wavelength * std::abs(target.z)) : 0;
  Field there(panel, target.wavelength, target.z);
  parallel_for(0, panel.ny, [&](int64_t j) {
    for (int i = 0; i < panel.nx; ++i)
      there.samples(int(j), i) = target.amplitude(int(j), i) *
                                 std::complex<float>(cis_cycles((x * panel.x(i) + y * panel.y(double(j))) * per_metre));
  });
  const TargetPropagation way(slm, target.wavelength, target.z,
                              {.aperture = PixelAperture::left_out, .stop = stop_width(params)});
  Field field = way.to_panel({there});
  field.z = 0;
  normalise_modulus(1e-2, {}, field);
  return field;
}

Field speckle_field(const TargetSet& targets, double wavelength, const FrameOfMany& which, const Slm& slm,
                    EncodeParams params) {
  params.method = Encoding::phase;
  params.iterations = 1;
  params.start = which.frames == 1 && !targets.draw_views ? StartPhase::field : StartPhase::random;
  params.seed += which.frame;
  return field_of_target(middle_plane(targets, wavelength), slm, params);
}

// What an eye sees in the middle plane from the middle of its box.
const ViewTargets& middle_view(const TargetSet& targets, double wavelength, const Vec3& eye) {
  std::vector<const ViewTargets*> of_eye;
  for (const ViewTargets& view : targets.views)
    if (view.wavelength == wavelength && view.pupils.front().centre == eye) of_eye.push_back(&view);
  require(!of_eye.empty(), "expected views of the eye at {} at {}, got none", format_length(eye.z),
          format_length(wavelength));
  return *of_eye[of_eye.size() / 2];
}

// The amplitude of a view where a ray from the eye through a place of the panel meets its plane.
float amplitude_behind(const ViewTargets& view, const Vec3& eye, const Vec2& place) {
  const double along = (eye.z - view.z) / eye.z;
  const Grid& picture = view.picture;
  const auto nearest = [](double samples, int count) { return std::clamp(int(std::lround(samples)), 0, count - 1); };
  const int column = nearest((eye.x + (place.x - eye.x) * along - picture.x(0)) / picture.pitch, picture.nx);
  const int row = nearest((picture.y(0) - eye.y - (place.y - eye.y) * along) / picture.pitch, picture.ny);
  return view.amplitudes.front()(row, column);
}

// A wave that converges to an eye, the frame's in turn, of a modulus of 1 or less: of the picture that the eye sees through each
// place of the panel, if the panel can show it. Noise makes several frames differ.
Field converging_field(const TargetSet& targets, const FrameOfMany& which, const Slm& slm, const EncodeParams& params,
                       double wavelength) {
  const bool has_modulus = shows_smooth_starts(slm, params);
  const double noise = has_modulus ? which.frames > 1 ? 0.25 : 0 : 0.35;  // cycles, either way
  const Vec3 eye = targets.eyes[size_t(which.frame) % targets.eyes.size()];
  const ViewTargets& view = middle_view(targets, wavelength, eye);
  Field field(slm.grid, wavelength);
  parallel_for(0, slm.grid.ny, [&](int64_t j) {
    for (int i = 0; i < slm.grid.nx; ++i) {
      const Vec2 place{slm.grid.x(i), slm.grid.y(double(j))};
      CounterRandom random(uint64_t(params.seed), uint32_t(which.frame), uint64_t(j * slm.grid.nx + i));
      const double way = length(eye - Vec3{place.x, place.y, 0});
      field.samples(int(j), i) =
          (has_modulus ? amplitude_behind(view, eye, place) : 1.0F) *
          std::complex<float>(cis_cycles((eye.z - way) / wavelength + noise * (2 * random.uniform() - 1)));
    }
  });
  if (has_modulus) normalise_modulus(1e-2, {}, field);
  return field;
}

}  // namespace

bool has_crosstalk(const Slm& slm, const EncodeParams& params) {
  return modulation_of(params, slm) == Modulation::phase && known_panel(slm, params).effects.crosstalk > 0;
}

bool shows_smooth_starts(const Slm& slm, const EncodeParams& params) {
  constexpr int coarse = 4;  // levels
  if (has_crosstalk(slm, params)) return false;
  const Modulation modulation = modulation_of(params, slm);
  const int levels = params.levels == 0 ? slm.levels : params.levels;
  return modulation == Modulation::complex || (modulation == Modulation::phase && levels > coarse);
}

FrameStart start_of_frames(const TargetSet& targets, double wavelength, int frames, const Slm& slm,
                           const EncodeParams& params) {
  constexpr double least_shift = 0.7;  // of the window's smaller side
  if (params.start == StartPhase::random) return FrameStart::random;
  if (!targets.eyes.empty()) return FrameStart::converging;
  if (has_crosstalk(slm, params)) return FrameStart::random;
  if (!shows_smooth_starts(slm, params) || wavelengths_of(targets).size() != 1 || targets.draw_views)
    return FrameStart::speckle;
  const Grid& panel = slm.grid;
  const double shift = wavelength * std::abs(middle_plane(targets, wavelength).z) / (2 * panel.pitch);
  const bool has_room = shift >= least_shift * std::min(panel.width(), panel.height());
  const bool has_second_term = modulation_of(params, slm) == Modulation::phase;
  return frames == 1 || has_room || !has_second_term ? FrameStart::smooth : FrameStart::speckle;
}

double step_from(FrameStart start, const TargetSet& targets, const Grid& panel, int iterations, int frames) {
  constexpr double shallow = 24;  // depths of focus
  const double larger = targets.draw_views ? 1 : std::min(std::sqrt(frames), 2.0);
  if (start == FrameStart::converging) return 0.2;
  if (start != FrameStart::smooth) return sgd_step * larger;
  double near = 0, far = std::numeric_limits<double>::infinity();  // reciprocal distances [1/m]
  for (const TargetPlane& plane : targets.planes) {
    near = std::max(near, 1 / std::abs(plane.z));
    far = std::min(far, 1 / std::abs(plane.z));
  }
  const double side = std::max(panel.width(), panel.height());
  const double depth = near > far ? (near - far) * side * side / (2 * targets.planes.front().wavelength) : 0;
  return larger * std::min(sgd_step, 0.1 * std::max(std::sqrt(iterations / 50.0), depth / shallow));
}

Array2D<std::complex<float>> start_pattern(const Field& field, const EncodeParams& params, Modulation modulation) {
  Array2D<std::complex<float>> pattern =
      params.image == ImageSide::real_image ? conjugate(field).samples : field.samples;
  const bool is_complex = modulation == Modulation::complex;
  const float largest = is_complex ? float(modulus_moments(field).largest) : 0;
  const float modulus = is_complex ? 0.5F : 1;
  parallel_for(0, pattern.ny, [&](int64_t j) {
    std::complex<float>* u = pattern.row(int(j));
    if (params.start == StartPhase::random)
      for (int i = 0; i < pattern.nx; ++i)
        u[i] = modulus *
               std::complex<float>(cis_cycles(
                   CounterRandom(uint64_t(params.seed), field.label.frame, uint64_t(j * pattern.nx + i)).uniform()));
    else if (largest > 0)
      for (int i = 0; i < pattern.nx; ++i) u[i] /= largest;
    else
      make_unit_modulus(u, size_t(pattern.nx));
  });
  return pattern;
}

void write_start(const Array2D<std::complex<float>>& pattern, const PhaseLevels& levels, Hologram& hologram) {
  if (hologram.modulation == Modulation::complex) {
    hologram.modulus_level = Array2D<uint16_t>(pattern.ny, pattern.nx);
    for (size_t i = 0; i < pattern.size(); ++i)
      hologram.modulus_level.values[i] =
          uint16_t(std::lround((hologram.levels - 1) * std::min(1.0F, std::abs(pattern.values[i]))));
  }
  if (hologram.modulation != Modulation::amplitude) return write_phase_levels(pattern, false, levels, hologram.level);
  for (size_t i = 0; i < pattern.size(); ++i)
    hologram.level.values[i] =
        uint16_t(std::lround((hologram.levels - 1) * std::clamp((1 + pattern.values[i].real()) / 2, 0.0F, 1.0F)));
}

void write_frame_start(FrameStart start, const TargetSet& targets, const FrameOfMany& which, const Slm& slm,
                       const EncodeParams& params, const PhaseLevels& levels, Hologram& hologram) {
  const double wavelength = hologram.wavelength;
  if (start == FrameStart::smooth || start == FrameStart::converging) {
    Field field = start == FrameStart::smooth ? smooth_field(middle_plane(targets, wavelength), which, slm, params)
                                              : converging_field(targets, which, slm, params, wavelength);
    if (hologram.modulation == Modulation::phase && shows_smooth_starts(slm, params))
      return write_double_phase_levels(field, false, levels, hologram.level);
    return write_start(field.samples, levels, hologram);
  }
  Field field(slm.grid, wavelength);
  if (start == FrameStart::speckle) field = speckle_field(targets, wavelength, which, slm, params);
  field.label.frame = uint32_t(which.frame);
  EncodeParams own = params;
  if (start == FrameStart::random) own.start = StartPhase::random;
  write_start(start_pattern(field, own, hologram.modulation), levels, hologram);
}

}  // namespace holotrace
