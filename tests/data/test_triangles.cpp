#include <gtest/gtest.h>

#include "holotrace/data/sources.h"

namespace holotrace {
namespace {

TEST(Triangles, AFrameHasItsRandomPhasesWhicheverFrameCameBefore) {
  Triangles set;
  set.wavelength = 532e-9;
  set.phase_keys = {3, 12};
  set.seed = 7;
  for (size_t i = 0; i < 2; ++i)  // in frame 0, as shading makes them: a phase of their own, and the random one
    set.triangles.push_back({.corners = {}, .phase = float(0.5 + double(i) + random_phase(7, 0, set.phase_keys[i]))});
  for (const uint32_t frame : {4u, 1u, 9u, 0u}) {
    set_frame(set, frame);
    EXPECT_EQ(set.label.frame, frame);
    for (size_t i = 0; i < 2; ++i)
      // Phases stay below 16 rad: each of up to four changes rounds by at most half a float's step there, 2⁻²¹.
      EXPECT_NEAR(double(set.triangles[i].phase), 0.5 + double(i) + random_phase(7, frame, set.phase_keys[i]),
                  4 * 0x1p-21)
          << "frame " << frame;
  }
}

}  // namespace
}  // namespace holotrace
