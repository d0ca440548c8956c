// Gerchberg–Saxton on every OpenCL device: its arithmetic against the processor's, what goes to a device and comes back, and
// what happens if the device fails.

#include <gtest/gtest.h>

#include <cmath>

#include "holotrace/slm/encode/encode.h"
#include "holotrace/slm/encode/iterate/gerchberg_saxton.h"
#include "holotrace/slm/encode/iterate/iteration_devices.h"
#include "holotrace/slm/encode/iterate/projection_arrays.h"
#include "support/build_paths.h"
#include "support/stages_on_devices.h"
#include "support/targets.h"
#if HOLOTRACE_HAS_OPENCL
#include "support/faulty_api.h"
#endif

namespace holotrace {
namespace {

using ComplexPattern = Array2D<std::complex<float>>;

// A picture in a few planes.
struct ProjectionCase {
  std::string name;
  EncodeParams params{.method = Encoding::gerchberg_saxton, .target_distances = {0.006}, .iterations = 8};
  Slm slm = make_panel(48, 36);

  std::vector<TargetPlane> targets() const { return picture_targets(slm, params); }

  Field start() const {
    Field field = random_field(slm.grid, 6);
    for (auto& u : field.samples.values) u /= std::abs(u);
    return field;
  }
};

std::vector<ProjectionCase> projection_cases() {
  ProjectionCase one{"one plane"}, several{"three planes"}, part{"a stop and a part that counts"}, odd{"an odd size"},
      weighted{"weighted"}, uneven{"uneven light"}, weighted_part{"weighted, a part of two planes"};
  several.params.target_distances = {0.006, 0.009, 0.012};
  for (ProjectionCase* counted : {&part, &weighted_part}) {
    counted->params.stop = 0.6;
    counted->params.target_columns = 30;
    counted->params.target_rows = 20;
  }
  weighted_part.params.target_distances = {0.006, 0.009};
  for (ProjectionCase* strengthening : {&weighted, &weighted_part})
    strengthening->params.method = Encoding::weighted_gerchberg_saxton;
  odd.slm = make_panel(51, 38);
  auto light = std::make_shared<Array2D<float>>(uneven.slm.grid.ny, uneven.slm.grid.nx);
  for (size_t i = 0; i < light->size(); ++i) light->values[i] = 0.2F + float(i % 13) / 10;
  uneven.slm.effects.light_map = light;
  uneven.slm.own_effects = {"light-map"};
  return {one, several, part, odd, weighted, uneven, weighted_part};
}

// Two iterations, with another factor than the method's, so that the second one has what the first one leaves.
struct Iterated {
  std::vector<double> numbers;
  ComplexPattern pattern;
};

Iterated iterated(ProjectionArrays& arrays, size_t planes) {
  Iterated found;
  for (int iteration = 0; iteration < 2; ++iteration) {
    for (size_t k = 0; k < planes; ++k) {
      arrays.show(k);
      found.numbers.push_back(arrays.cross_sum(k));
    }
    for (size_t k = 0; k < planes; ++k) {
      found.numbers.push_back(arrays.leave_residual(k, 1.3));
      arrays.add_step(k, planes == 1 && iteration == 0 ? 1 : 0.4);
    }
    arrays.take_step();
  }
  found.pattern = arrays.pattern();
  return found;
}

double relative(const ComplexPattern& found, const ComplexPattern& expected) {
  double error = 0, square = 0;
  for (size_t i = 0; i < expected.size(); ++i) {
    error += double(std::norm(found.values[i] - expected.values[i]));
    square += double(std::norm(expected.values[i]));
  }
  return std::sqrt(error / square);
}

class ProjectionDevices : public test::StagesOnDevices {
 protected:
  ProjectionDevices() { one_.params.iterations = 3; }

  static ComplexPattern found(const ProjectionCase& one, const EncodeParams& params, const Observer& observer = {}) {
    return project_in_turn(one.targets(), one.start().samples, one.slm, params, observer).pattern;
  }
  static Hologram encoded(const ProjectionCase& one, const EncodeParams& params, const Observer& observer = {}) {
    return encode_targets(one.targets(), one.start(), one.slm, params, observer);
  }
  ProjectionCase one_{"one"};
};

HOLOTRACE_FOR_ALL_DEVICES(ProjectionDevices);

// Propagations agree to 1e-6 of their norm, sums of 2000 positive terms better. A pixel of the pattern is the sum of two
// such parts; where they nearly cancel, its phase is less certain.
TEST_P(ProjectionDevices, HaveTheSumsAndPatternOfTheProcessor) {
  for (const ProjectionCase& one : projection_cases()) {
    const std::vector<TargetPlane> targets = one.targets();
    const ProjectionSetup setup{targets, one.slm, one.params};
    ProcessorProjection on_processor(setup, one.start().samples);
    DeviceProjection there(device_, setup, one.start().samples);
    const Iterated expected = iterated(on_processor, targets.size()), found = iterated(there, targets.size());
    ASSERT_EQ(found.numbers.size(), expected.numbers.size());
    for (size_t i = 0; i < found.numbers.size(); ++i)
      EXPECT_NEAR(found.numbers[i], expected.numbers[i], 4e-6 * expected.numbers[i]) << one.name << i;
    EXPECT_LT(relative(found.pattern, expected.pattern), 1e-5) << one.name;
  }
}

// The whole way to the hologram: the curve of errors, and what the levels show.
TEST_P(ProjectionDevices, ReachTheErrorOfTheProcessor) {
  for (const ProjectionCase& one : projection_cases()) {
    std::vector<double> curves[2];
    Heard heard[2];
    for (const int i : {0, 1}) {
      Observer observer = heard[i].observer();
      observer.on_curve = [&](const std::string&, const std::vector<double>& values) { curves[i] = values; };
      encoded(one, i == 0 ? one.params : on_device(one.params), observer);
    }
    ASSERT_EQ(curves[1].size(), 9u);
    for (size_t i = 0; i < curves[1].size(); ++i)
      EXPECT_NEAR(curves[1][i], curves[0][i], 1e-4 * curves[0][i]) << one.name << i;
    EXPECT_EQ(heard[1].number("error_last"), curves[1].back());
    EXPECT_NEAR(heard[1].number("psnr_db"), heard[0].number("psnr_db"), 0.01) << one.name;
    EXPECT_NEAR(heard[1].number("target_efficiency"), heard[0].number("target_efficiency"), 1e-3) << one.name;
    EXPECT_NEAR(heard[1].number("illumination"), heard[0].number("illumination"),
                1e-3 * heard[0].number("illumination"))
        << one.name;
  }
}

// Of an iteration one error of each row; the weighted method fits its scale again, by two sums.
TEST_P(ProjectionDevices, ReturnTheRowSumsOnly) {
  const auto returned = [&](int iterations) {
    one_.params.iterations = iterations;
    const size_t before = device_.use().bytes_out;
    found(one_, on_device(one_.params));
    return device_.use().bytes_out - before;
  };
  const size_t rows = size_t(one_.slm.grid.ny), pattern = size_t(one_.slm.grid.pixels()) * 2 * sizeof(float);
  EXPECT_EQ(returned(4) - returned(3), rows * sizeof(float));
  EXPECT_EQ(returned(3), (2 + 4) * rows * sizeof(float) + pattern);  // the scale, and errors before and after all
  one_.params.method = Encoding::weighted_gerchberg_saxton;
  EXPECT_EQ(returned(4) - returned(3), rows * 3 * sizeof(float));
}

// What the levels show is judged there, too: two sums of each row more.
TEST_P(ProjectionDevices, JudgeTheLevels) {
  const auto returned = [&](const auto& work) {
    const size_t before = device_.use().bytes_out;
    work(one_, on_device(one_.params), Observer());
    return device_.use().bytes_out - before;
  };
  EXPECT_EQ(returned(encoded) - returned(found), size_t(one_.slm.grid.ny) * 2 * sizeof(float));
}

TEST_P(ProjectionDevices, WriteNothingPastTheirBuffers) {
  const size_t before = device_.broken_guards();
  device_.guard_buffers(true);
  one_.slm = make_panel(51, 38);  // not whole groups
  one_.params.target_distances = {0.006, 0.009};
  for (const Encoding method : {Encoding::gerchberg_saxton, Encoding::weighted_gerchberg_saxton}) {
    one_.params.method = method;
    encoded(one_, on_device(one_.params));
  }
  device_.guard_buffers(false);
  EXPECT_EQ(device_.broken_guards(), before);
}

// All planes are used in every iteration, whatever parameters of sgd say: the choice is the same at all rates.
TEST_P(ProjectionDevices, AreChosenByTheWorkOfAllPlanes) {
  one_.params.target_distances = {0.006, 0.009, 0.012, 0.015};
  const std::vector<TargetPlane> targets = one_.targets();
  int taken = 0;
  for (double bytes = 1; bytes < 1e12; bytes *= 1.3) {
    test::set_processor_rates({.samples = 2e4});
    set_device_rates([=](Device&) { return DeviceRates{0, bytes, 1e15}; });
    EncodeParams all = automatic(one_.params), one_plane = all;
    all.planes_per_update = 0;
    one_plane.planes_per_update = 1;
    one_plane.subpixels = 2;
    const bool is_taken = device_for_projections(targets, {one_.slm, all}) != nullptr;
    EXPECT_EQ(device_for_projections(targets, {one_.slm, one_plane}) != nullptr, is_taken) << bytes;
    taken += is_taken;
  }
  EXPECT_GT(taken, 10);
  EXPECT_LT(taken, 90);
}

// Without memory for the samples of all planes, those of one plane after the other are computed again for its step: the pattern is
// the same. The limit is what it has made for all planes, beside which a step does not fit.
TEST_P(ProjectionDevices, DoOnePlaneAfterTheOtherIfMemoryIsShort) {
  for (const Encoding method : {Encoding::gerchberg_saxton, Encoding::weighted_gerchberg_saxton}) {
    one_.params.method = method;
    one_.params.target_distances = {0.006, 0.009, 0.012};
    const std::vector<TargetPlane> targets = one_.targets();
    const ProjectionSetup setup{targets, one_.slm, one_.params};
    const double samples = 4 * 8 * double(one_.slm.grid.pixels());
    const auto kernels_of = [&](double memory, Iterated& found, double& held) {
      device_.limit_memory((double(device_.use().bytes_held) + memory) / 0.8);
      const size_t before = device_.use().bytes_held;
      DeviceProjection there(device_, setup, one_.start().samples);
      held = double(device_.use().bytes_held - before);
      const size_t kernels = device_.use().kernels;
      found = iterated(there, targets.size());
      return device_.use().kernels - kernels;
    };
    Iterated expected, found;
    double whole = 0, least = 0;
    const size_t once = kernels_of(1e9, expected, whole);
    EXPECT_GT(kernels_of(whole, found, least), once);
    EXPECT_EQ(whole - least, 2 * samples) << "those of two planes less";
    EXPECT_EQ(found.numbers, expected.numbers);
    EXPECT_EQ(found.pattern.values, expected.pattern.values);
  }
}

#if HOLOTRACE_HAS_OPENCL
// Every 23rd call fails: memory, transfers and kernels of all parts, the last judgement of the levels included. A named
// device says so in one sentence. Under `auto` the processor takes over, with one warning.
TEST_P(ProjectionDevices, ReleaseTheirMemoryAndGiveWayAfterAnyFault) {
  one_.params.iterations = 1;
  one_.params.method = Encoding::weighted_gerchberg_saxton;
  make_device_fast(1e15);
  encoded(one_, on_device(one_.params));  // compiles the kernels
  const Hologram expected = encoded(one_, one_.params);
  const auto on_named = [&] { encoded(one_, on_device(one_.params)); };
  const int faults = test::fail_every(23, on_named, [&](const std::string& error) {
    Heard heard;
    Hologram hologram;
    EXPECT_EQ(error_of([&] { hologram = encoded(one_, automatic(one_.params), heard.observer()); }), "no error");
    EXPECT_EQ(heard.warnings, std::vector{test::warning_after(error)});
    // The levels of a device stay if only their judgement fails; single ones differ by its rounding.
    size_t differing = 0;
    for (size_t i = 0; i < expected.level.size(); ++i)
      differing += hologram.level.values[i] != expected.level.values[i];
    EXPECT_LE(differing, 3u);
    EXPECT_NEAR(hologram.illumination, expected.illumination, 1e-4 * expected.illumination);
  });
  EXPECT_GT(faults, 5);
}
#endif

}  // namespace
}  // namespace holotrace
