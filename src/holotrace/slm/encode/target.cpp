#include "holotrace/slm/encode/target.h"

#include <cmath>

#include "holotrace/base/cycles.h"
#include "holotrace/base/error.h"
#include "holotrace/base/random.h"
#include "holotrace/base/threads.h"
#include "holotrace/base/units.h"
#include "holotrace/data/params/encode.h"
#include "holotrace/slm/encode/iterate/target_propagation.h"
#include "holotrace/slm/encode/iterate/target_sums.h"
#include "holotrace/wave/propagate/propagate.h"

namespace holotrace {
namespace {

double place(double distance, ImageSide image) { return image == ImageSide::real_image ? distance : -distance; }

void check_distances(const std::vector<double>& distances) {
  require(!distances.empty(),
          "expected at least one target distance, got none; give target_distances (--target-distances)");
  for (const double distance : distances)
    require(std::isfinite(distance), "expected finite target distances, got {}", format_length(distance));
}

// 1 in the middle, 0 around it; empty if the middle is the whole panel.
Array2D<float> weight_of(const Grid& panel, TargetSize size) {
  if (size.columns == panel.nx && size.rows == panel.ny) return {};
  Array2D<float> weight(panel.ny, panel.nx);
  const int left = (panel.nx - size.columns) / 2, top = (panel.ny - size.rows) / 2;
  for (int j = 0; j < size.rows; ++j)
    for (int i = 0; i < size.columns; ++i) weight(top + j, left + i) = 1;
  return weight;
}

// Field with the target's modulus and the phase that the parameters name.
Field target_field(const TargetPlane& target, const Grid& panel, const EncodeParams& params) {
  Field field(panel, target.wavelength, target.z);
  parallel_for(0, panel.ny, [&](int64_t j) {
    for (int i = 0; i < panel.nx; ++i) {
      std::complex<double> turn = 1;
      if (params.start == StartPhase::random)
        turn = cis_cycles(CounterRandom(uint64_t(params.seed), 0, uint64_t(j * panel.nx + i)).uniform());
      field.samples(int(j), i) = std::complex<float>(double(target.amplitude(int(j), i)) * turn);
    }
  });
  return field;
}

// Step with momentum: u ← u + momentum·(u − before), before ← u.
void go_on(double momentum, Field& before, Field& u) {
  const float m = float(momentum);
  parallel_for(
      0, u.grid.ny,
      [&](int64_t j) {
        std::complex<float>*now = u.samples.row(int(j)), *last = before.samples.row(int(j));
        for (int i = 0; i < u.grid.nx; ++i) {
          const std::complex<float> here = now[i];
          now[i] = here + m * (here - last[i]);
          last[i] = here;
        }
      },
      {}, 16);
}

}  // namespace

TargetSize target_size(const Grid& panel, const EncodeParams& params) {
  const int columns = params.target_columns, rows = params.target_rows;
  require(columns >= 0 && rows >= 0 && columns <= panel.nx && rows <= panel.ny,
          "expected a target of at most {} × {} pixels, as many as the panel has, or 0 for all of them, got {} × {}",
          panel.nx, panel.ny, columns, rows);
  return {columns > 0 ? columns : panel.nx, rows > 0 ? rows : panel.ny};
}

std::vector<TargetPlane> targets_of(const Field& field, const EncodeParams& params) {
  check_distances(params.target_distances);
  const TargetSize size = target_size(field.grid, params);
  std::vector<TargetPlane> targets;
  for (const double distance : params.target_distances) {
    // |conj(U)| at +d equals |U| at −d.
    const Field there = propagate(field, -distance);
    TargetPlane target{place(distance, params.image), field.wavelength, Array2D<float>(field.grid.ny, field.grid.nx),
                       weight_of(field.grid, size)};
    for (size_t i = 0; i < there.samples.size(); ++i) target.amplitude.values[i] = std::abs(there.samples.values[i]);
    targets.push_back(std::move(target));
  }
  return targets;
}

TargetSize size_of_shape(const TargetSize& size, int columns, int rows) {
  const double scale = std::min(double(size.columns) / columns, double(size.rows) / rows);
  return {std::max(1, int(std::lround(scale * columns))), std::max(1, int(std::lround(scale * rows)))};
}

std::vector<TargetPlane> targets_of_picture(const Image& light, const Grid& panel, double wavelength,
                                            const EncodeParams& params) {
  check_distances(params.target_distances);
  const TargetSize size = target_size(panel, params);
  require(light.channels == 1, "expected the light of one wavelength in a target picture, got {} channels",
          light.channels);
  require(light.nx == size.columns && light.ny == size.rows,
          "expected a target picture of {} × {} pixels, as target_columns and target_rows or the panel say, got {} × "
          "{}; give its size by those, or resample it (--resample true, in Python resample=True)",
          size.columns, size.rows, light.nx, light.ny);
  for (int j = 0; j < light.ny; ++j)
    for (int i = 0; i < light.nx; ++i)
      require(
          !(light(j, i) < 0),
          "expected light of 0 or more in a target picture, got {:g} at row {}, column {}; give the light itself, not an "
          "amplitude with a sign",
          light(j, i), j, i);
  TargetPlane target{0, wavelength, Array2D<float>(panel.ny, panel.nx), weight_of(panel, size)};
  const int left = (panel.nx - size.columns) / 2, top = (panel.ny - size.rows) / 2;
  for (int j = 0; j < size.rows; ++j)
    for (int i = 0; i < size.columns; ++i) target.amplitude(top + j, left + i) = std::sqrt(std::max(0.0F, light(j, i)));
  std::vector<TargetPlane> targets;
  for (const double distance : params.target_distances) {
    target.z = place(distance, params.image);
    targets.push_back(target);
  }
  check_targets(targets, panel);
  return targets;
}

Field field_of_target(const TargetPlane& target, const Slm& slm, const EncodeParams& params, const Observer& observer) {
  const TargetPropagation propagation(slm, target.wavelength, target.z,
                                      {.samples = PixelSamples::four, .stop = stop_width(params)});
  const double power = target_power(target);
  const int wanted = params.iterations > 0 ? params.iterations : target_field_iterations;
  const int steps = traits_of(params.method).aims_at_targets || power == 0 ? 0 : wanted;
  // As many samples per pixel as the propagation has, whose powers add up to that of the target.
  std::vector<Field> asked = propagation.to_plane(Field(slm.grid, target.wavelength));
  const Field at_pixels = target_field(target, slm.grid, params);
  for (Field& samples : asked)
    for (size_t i = 0; i < samples.samples.size(); ++i)
      samples.samples.values[i] = at_pixels.samples.values[i] / std::sqrt(float(asked.size()));
  Field u = propagation.to_panel(asked);
  Field before = u;
  std::vector<double> convergence;
  for (int step = 0, since = 0; step < steps; ++step, ++since) {
    std::vector<Field> shown = propagation.to_plane(u);
    Array2D<float> light = power_of(shown, slm.grid);
    convergence.push_back(leave_residual(target, 1, light) / power);
    multiply(light, shown);
    if (step > 0 && convergence[size_t(step)] > convergence[size_t(step) - 1]) since = 0;  // restarts the momentum
    add_part(propagation.to_panel(shown), 1, u);
    go_on(double(since) / (since + 3.0), before, u);
    observer.progress((step + 1.0) / steps);
  }
  if (steps > 0) {
    observer.fact("iterations", steps);
    observer.fact("error_first", Fact(convergence.front()));
    observer.fact("error_last", Fact(convergence.back()));
    observer.curve("convergence", convergence);
  }
  u.z = 0;
  if (params.image == ImageSide::real_image)
    for (std::complex<float>& sample : u.samples.values) sample = std::conj(sample);
  return u;
}

void check_targets(const std::vector<TargetPlane>& targets, const Grid& panel) {
  require(!targets.empty(), "expected a target for the image, got none");
  for (const TargetPlane& target : targets) {
    check_wavelength(target.wavelength);
    require(std::isfinite(target.z), "expected a finite place of the target, got {}", format_length(target.z));
    const auto fits = [&](const Array2D<float>& values) { return values.nx == panel.nx && values.ny == panel.ny; };
    require(fits(target.amplitude), "expected a target of {} × {} pixels, as many as the panel has, got {} × {}",
            panel.nx, panel.ny, target.amplitude.nx, target.amplitude.ny);
    require(target.weight.size() == 0 || fits(target.weight),
            "expected weights of {} × {} pixels, as many as the panel has, got {} × {}", panel.nx, panel.ny,
            target.weight.nx, target.weight.ny);
    for (size_t i = 0; i < target.amplitude.size(); ++i) {
      const float a = target.amplitude.values[i], w = target.weight.size() == 0 ? 1.0F : target.weight.values[i];
      require(std::isfinite(a) && a >= 0 && w >= 0 && w <= 1,
              "expected amplitudes of 0 or more and weights in [0, 1] in a target, got {} and {} at row {}, column {}",
              a, w, i / size_t(panel.nx), i % size_t(panel.nx));
    }
  }
}

}  // namespace holotrace
