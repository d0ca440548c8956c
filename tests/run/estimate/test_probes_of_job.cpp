// The probes of an estimate by what they run. No time is asserted, except for one ratio of predictions.

#include <gtest/gtest.h>

#include <cmath>

#include "holotrace/run/estimate/display_probe.h"
#include "holotrace/run/estimate/field_probes.h"
#include "holotrace/run/estimate/small_panel.h"
#include "holotrace/run/illumination_plan.h"
#include "holotrace/run/pipeline.h"
#include "holotrace/run/viewing.h"
#include "trace/scenes.h"

namespace holotrace {
namespace {

Job job_of_spectrum() {
  Job job;
  job.wavelengths = {532e-9};
  job.slm = {.name = "test", .grid = {256, 256, 8e-6}};
  job.camera.distances = {0.1};
  job.show.bandwidth = 100e-9;
  return job;
}

// 2 mm of panel at 100 mm need 30 wavelengths of 100 nm (Viewing.AsManyIlluminationStatesAsTheViewsNeed). A quarter of the side at
// a quarter of the distance needs 8 by itself: λz/S stays 26 µm, f = 38496/m too, and the light moves a quarter as far: 7.4, or 8 at least.
TEST(JobProbes, ASmallPanelHasTheIlluminationStatesOfTheJob) {
  const Job job = job_of_spectrum();
  const auto count = [](const Job& of) {
    return plan_illumination(of.slm, of.show, 532e-9, of.encode.image, viewpoints(of.camera, of.render)).states.size();
  };
  EXPECT_EQ(count(job), 30U);
  Job small = on_small_panel(job, 0.25);
  EXPECT_EQ(count(small), 30U);
  small.show.illumination_states = 0;
  EXPECT_EQ(count(small), 8U);  // without the job's number
  Job given = job;
  given.show.illumination_states = 5;
  EXPECT_EQ(on_small_panel(given, 0.25).show.illumination_states, 5);
  given.show = {};
  EXPECT_EQ(on_small_panel(given, 0.25).show.illumination_states, 0);  // coherent light
  // Light of two polarisations takes these states twice. The number of states is that of one.
  Job crossed = job;
  crossed.slm.effects.crystal = Crystal{.polariser = 0.35};
  crossed.slm.own_effects = {"crystal"};
  EXPECT_EQ(count(crossed), 60U);
  EXPECT_EQ(on_small_panel(crossed, 0.25).show.illumination_states, 30);
  EXPECT_EQ(most_states(crossed, viewpoints(crossed.camera, crossed.render)), 60);
  EXPECT_EQ(most_instants(crossed, viewpoints(crossed.camera, crossed.render)), 30);
}

// A lens without a pupil is refused at every size.
TEST(JobProbes, AJobThatCannotBeShownHasNoTimesAndAReason) {
  Job job = job_of_spectrum();
  job.camera.focal_length = 0.05;
  DisplayProbe probe(job);
  EXPECT_EQ(probe.run(0.25).predicted, 0);
  EXPECT_TRUE(probe.stages.empty());
  EXPECT_NE(probe.why_none.find("pupil"), std::string::npos) << probe.why_none;
}

// 4000 waves on 500 × 500 pixels are 1e9: without a forecast the first part is 2e6 of them.
TEST(JobProbes, TheFirstPartOfAnExactSumIsSmall) {
  Job job = job_of_spectrum();
  SynthesisProbe probe(job, {});
  probe.waves_pixels = 1e9;
  EXPECT_DOUBLE_EQ(probe.first_part(), 2e-3);
  probe.waves_pixels = 1e14;
  EXPECT_DOUBLE_EQ(probe.first_part(), 2e-8);
  probe.waves_pixels = 1e5;
  EXPECT_DOUBLE_EQ(probe.first_part(), 1);
  probe.forecast = 1;
  probe.waves_pixels = 1e9;
  EXPECT_DOUBLE_EQ(probe.first_part(), 0.1);
}

// The cost model's answer runs no wave: it took the planning, and tells what the next probe takes, of a fourfold part
// and of one of two equal sets, which is planned twice.
TEST(JobProbes, AForecastPricesTheFirstSumByItself) {
  Job job = job_of_spectrum();
  Sources set;
  set.wavelength = 532e-9;
  set.waves.resize(10);
  SynthesisProbe probe(job, {});
  probe.sets = {set, set};
  probe.waves = 20;
  probe.forecast = 8;
  probe.planning = 0.5;
  const ProbeResult told = probe.run(1.0 / 16);
  EXPECT_DOUBLE_EQ(told.seconds, 0.5);
  EXPECT_DOUBLE_EQ(told.predicted, 8.5);
  EXPECT_DOUBLE_EQ(told.next, 0.5 * (2 * 0.5 + 8 * 0.25));
}

// 0.1 s of overhead and 2 s of work. Parts of 1/16 and 1/4 take 0.225 and 0.6 s, which predict 3.6 and 2.4 s; both
// together tell 2.1 s.
TEST(JobProbes, TwoPartsTellTheOverheadFromTheWork) {
  EXPECT_NEAR(without_overhead({1.0 / 16, 3.6}, {0.25, 2.4}), 2.1, 1e-12);
  EXPECT_DOUBLE_EQ(without_overhead({}, {0.25, 2.4}), 2.4) << "the first probe";
  EXPECT_DOUBLE_EQ(without_overhead({1.0 / 16, 2}, {0.25, 2.4}), 2.4) << "noise: never more than the larger part says";
  EXPECT_DOUBLE_EQ(without_overhead({1.0 / 16, 30}, {0.25, 2.4}), 1.2) << "and never less than half";
  PartPredictions predictions;
  EXPECT_DOUBLE_EQ(predictions.add({1.0 / 16, 3.6}), 3.6);
  EXPECT_NEAR(predictions.add({0.25, 2.4}), 2.1, 1e-12);
  EXPECT_NEAR(predictions.add({0.25, 2.4}), 2.1, 1e-12) << "the same part once more";
}

// The parts of a probe are seen from other distances, but told by the job's.
TEST(JobProbes, StagesHaveTheNamesOfTheJobs) {
  Job job;
  job.slm.grid = Grid{128, 128, 8e-6};
  job.slm.levels = 256;
  job.wavelengths = {532e-9};
  job.encode.method = Encoding::sgd;
  job.encode.target = EncodeTarget::field;
  job.encode.iterations = 32;
  job.camera.distances = {0.06, 0.07};
  DisplayProbe probe(job);
  const ProbeResult told = probe.run(probe.first_part());
  EXPECT_EQ(probe.why_none, "");
  std::vector<std::string> names;
  double sum = 0;
  for (const StageReport& stage : probe.stages) {
    names.push_back(stage.stage);
    EXPECT_GT(stage.seconds, 0) << stage.stage;
    sum += stage.seconds;
  }
  EXPECT_EQ(names, (std::vector<std::string>{"encode", "show", "look at 60 mm", "look at 70 mm"}));
  EXPECT_DOUBLE_EQ(told.predicted, sum);
  EXPECT_GT(told.next, 0) << "iterations are priced";
}

// Holograms of a scene in several colours have a stage of encoding for each. 25 times as many iterations take some 20 times as
// long, and not the same: 2 leaves room for noise of a factor of ten.
TEST(JobProbes, IterationsOfEachColourCount) {
  Job job;
  job.slm.grid = Grid{128, 128, 8e-6};
  job.slm.levels = 256;
  job.wavelengths = {638e-9, 532e-9};
  job.encode.method = Encoding::sgd;
  job.encode.target = EncodeTarget::render;
  job.encode.target_distances = {0.06};
  job.trace.frames = 1;
  job.camera.distances = {0.06};
  const auto seconds_of = [&](int iterations) {
    job.encode.iterations = iterations;
    DisplayProbe probe(job);
    probe.run(1);
    EXPECT_EQ(probe.why_none, "");
    std::vector<double> seconds;
    for (const StageReport& stage : probe.stages)
      if (stage.stage.starts_with("encode ")) seconds.push_back(stage.seconds);
    return seconds;
  };
  const std::vector<double> few = seconds_of(16), many = seconds_of(400);
  ASSERT_EQ(few.size(), 2U);
  ASSERT_EQ(many.size(), 2U);
  for (size_t i = 0; i < 2; ++i) EXPECT_GT(many[i], 2 * few[i]) << i;
}

// 512·√(1/8) is 181, a prime; the next length of factors 2, 3 and 5 is 192. Of 509, a prime itself, none is looked for.
TEST(JobProbes, ASmallPanelIsAsEasyToTransformAsTheJobs) {
  EXPECT_EQ(fewer_pixels(512, std::sqrt(0.125)), 192);
  EXPECT_EQ(fewer_pixels(509, std::sqrt(0.125)), 180);
  EXPECT_EQ(fewer_pixels(2000, 0.5), 1000);
  EXPECT_EQ(fewer_pixels(512, 1), 512);
  EXPECT_EQ(fewer_pixels(16, 0.01), 2);
  Job job = job_of_spectrum();
  job.slm.grid.nx = 512;
  EXPECT_EQ(on_small_panel(job, std::sqrt(0.125)).slm.grid.nx, 192);
}

TEST(JobProbes, SlicesTakeATransformEachAndOneBackOfEachSet) { EXPECT_EQ(transforms_of({4, 0, 2}), 5 + 0 + 3); }

// 1 s done once and 0.5 s for each state: two take 2 s, four 3 s, thirty 16 s.
TEST(JobProbes, IlluminationStatesTakeTheSameEach) {
  EXPECT_DOUBLE_EQ(seconds_of_states(30, 2, 2, 3), 16);
  EXPECT_DOUBLE_EQ(seconds_of_states(30, 2, 2, 1.9), 2) << "noise: no less than nothing";
  EXPECT_DOUBLE_EQ(seconds_of_states(30, 2, 2, 9), 30) << "and no more than the first each";
}

// A wall lit by a lamp: later probes know the first one.
TEST(JobProbes, RaysArePredictedFromTwoParts) {
  Job job = job_of_spectrum();
  job.scene.materials = {DiffuseMaterial{}};
  job.scene.meshes = {make_wall(-0.1, 5e-3, 5e-3)};
  job.scene.lights = {PointLight{{0, 0, -0.02}, {1e-3, 1e-3, 1e-3}}};
  job.trace.columns = job.trace.rows = 256;
  TraceProbe probe(job);
  const auto run = [&](double part) {
    const ProbeResult told = probe.run(part);
    EXPECT_EQ(told.predicted, probe.predicted);
    return PartPrediction{1 / probe.scale,
                          probe.prepare_seconds + std::max(0.0, probe.seconds - probe.prepare_seconds) * probe.scale};
  };
  const PartPrediction first = run(1.0 / 64);
  EXPECT_DOUBLE_EQ(probe.predicted, first.seconds);
  EXPECT_DOUBLE_EQ(first.part, 1.0 / 64);
  for (int repeat = 0; repeat < 2; ++repeat) {
    const PartPrediction later = run(1.0 / 16);
    EXPECT_DOUBLE_EQ(probe.predicted, without_overhead(first, later));
  }
  EXPECT_DOUBLE_EQ(probe.ray_seconds(), std::max(0.0, probe.predicted - probe.prepare_seconds));
}

// Luminous points are all there in any part of the rays: nothing grows.
TEST(JobProbes, PointsAloneDoNotGrowWithTheRays) {
  Job job = job_of_spectrum();
  job.scene.points = {{{0, 0, -0.1}}, {{1e-4, 0, -0.1}}};
  job.trace.columns = job.trace.rows = 512;
  TraceProbe probe(job);
  const ProbeResult told = probe.run(1.0 / 64);
  EXPECT_FALSE(probe.has_rays());
  EXPECT_EQ(probe.scale, 1);
  EXPECT_EQ(told.predicted, told.seconds);
  EXPECT_EQ(probe.light.sources.front().waves.size(), 2U);
}

// At a quarter of its place, before a quarter of the panel, a wave is seen at the same angles.
TEST(JobProbes, WavesInTheSmallKeepTheirAngles) {
  Sources set{.wavelength = 532e-9};
  set.waves = {{{4e-3, -2e-3, -0.1}, 0.5F, 1.0F}};
  const Sources small = in_the_small(set, 0.25);
  EXPECT_EQ(small.waves.front().origin, (Vec3{1e-3, -0.5e-3, -0.025}));
  EXPECT_EQ(small.waves.front().amplitude, 0.5F);
}

// 4 slices of 0.1 to 0.103 m: a probe of 1/16 of the work carries one of them, on a panel of a quarter of the pixels.
TEST(JobProbes, ASumOfSlicesGoesByItsTransforms) {
  Job job = job_of_spectrum();
  job.synthesize.method = SynthesisMethod::layers;
  job.synthesize.slices = 4;
  Sources set{.wavelength = 532e-9};
  for (int i = 0; i < 64; ++i) set.waves.push_back({{1e-5 * i, 0, -0.1 - 0.001 * (i % 4)}, 1.0F, 0.0F});
  SynthesisProbe probe(job, {set});
  ASSERT_EQ(probe.slices, std::vector<double>{4});
  const ProbeResult told = probe.run(1.0 / 16);
  // 256² pixels over 128², by P·log₂P 16·65536 / (14·16384) = 4.571; 5 transforms over 2. The first sum, which only plans,
  // counts as time that is spent, and not for the prediction.
  const double factor = 4.0 * 16 / 14 * 5 / 2;
  EXPECT_LT(told.predicted, factor * told.seconds);
  EXPECT_GT(told.predicted, 0);
}

// An encoder's stop bounds the light of a source more narrowly than the panel does, and each wavelength has its own.
TEST(JobIlluminationStates, AreThoseOfTheWavelengthAndTheEncodersStop) {
  Job job = job_of_spectrum();
  job.show = {};
  job.show.source_angle = 0.01;
  job.wavelengths = {638e-9, 450e-9};
  const auto from = viewpoints(job.camera, job.render);
  // The orders that the samples hold, n/p: N = ceil(π/4·(8α·p/(nλ))²); π/4·64·(0.01·8e-6/(n·λ))² with n of ShowParams.
  const auto expected = [&](double wavelength, double band) {
    const double moved = 0.01 / (wavelength * band);
    return int64_t(std::ceil(3.14159265358979 / 4 * 64 * moved * moved));
  };
  const double open = job.show.subpixels / 8e-6;
  EXPECT_EQ(states_at(job, 638e-9, from), expected(638e-9, open));
  EXPECT_EQ(states_at(job, 450e-9, from), expected(450e-9, open));
  EXPECT_EQ(most_states(job, from), expected(450e-9, open)) << "not the first wavelength's";
  // Off-axis with bias: the carrier is 3/8p, a third of which is the half width: a band of 1/4p.
  job.encode.method = Encoding::off_axis;
  EXPECT_EQ(states_at(job, 638e-9, from), expected(638e-9, 0.25 / 8e-6));
  job.show.wavelength = 532e-9;
  EXPECT_EQ(states_at(job, 638e-9, from), expected(532e-9, 0.25 / 8e-6)) << "of the light that it is shown with";
}

}  // namespace
}  // namespace holotrace
