#include <gtest/gtest.h>

#include <cmath>

#include "holotrace/base/units.h"
#include "holotrace/data/sources.h"

namespace holotrace {
namespace {

// A set as tracing makes it, in frame 0: a phase of its own of each wave plus the random one of its key.
Sources traced() {
  Sources sources;
  sources.wavelength = 532e-9;
  sources.seed = 7;
  sources.phase_keys = {3, Sources::no_phase_key, 12};
  for (size_t i = 0; i < 3; ++i) {
    const uint64_t key = sources.phase_keys[i];
    const double phase = 0.5 + double(i) + (key == Sources::no_phase_key ? 0 : random_phase(7, 0, key));
    sources.waves.push_back({{0, 0, -0.1}, 1, float(phase)});
  }
  return sources;
}

TEST(Sources, AFrameHasItsRandomPhasesWhicheverFrameCameBefore) {
  Sources sources = traced();
  for (const uint32_t frame : {4u, 1u, 9u, 0u}) {
    set_frame(sources, frame);
    EXPECT_EQ(sources.label.frame, frame);
    for (size_t i = 0; i < 3; ++i) {
      const uint64_t key = sources.phase_keys[i];
      const double random = key == Sources::no_phase_key ? 0 : random_phase(7, frame, key);
      // Phases stay below 16 rad: each of up to four changes rounds by at most half a float's step there, 2⁻²¹.
      EXPECT_NEAR(double(sources.waves[i].phase), 0.5 + double(i) + random, 4 * 0x1p-21) << "frame " << frame;
    }
  }
}

}  // namespace
}  // namespace holotrace
