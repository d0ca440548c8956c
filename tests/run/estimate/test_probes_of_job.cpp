// The probes of an estimate (apps/), by what they run. No time is asserted.

#include <gtest/gtest.h>

#include "holotrace/run/estimate/display_probe.h"
#include "holotrace/run/estimate/synthesis_probe.h"
#include "holotrace/run/illumination_plan.h"
#include "holotrace/run/viewing.h"

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

// 2 mm of panel at 100 mm need 30 wavelengths of 100 nm (Viewing.AsManyMomentsAsTheViewsNeed). A quarter of the side at
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

}  // namespace
}  // namespace holotrace
