#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "holotrace/slm/encode/iterate/gradient_descent.h"
#include "holotrace/slm/encode/iterate/target_propagation.h"
#include "support/stages_on_devices.h"
#include "support/targets.h"

namespace holotrace::test {

/// A descent to a picture in a few planes.
struct DescentCase {
  std::string name;
  int frames = 1, levels = 65536;
  EncodeParams params{.method = Encoding::sgd, .target_distances = {0.006, 0.009}, .iterations = 20};
  bool has_two_colours = false;
  Slm slm = make_panel(48, 36);
  bool has_views = false, has_no_planes = false;
  double view_z = -0.01;  ///< plane in which the views are in focus; their pupils are at 0.02 m

  TargetSet targets() const {
    TargetSet set{picture_targets(slm, params)};
    if (has_no_planes) set.planes.clear();
    if (has_two_colours)
      for (const TargetPlane& target : picture_targets(slm, params, 633e-9)) set.planes.push_back(target);
    if (has_views)
      set.draw_views = [this](int update, double wavelength) {
        CounterRandom random(3, 0, uint64_t(update));
        ViewTargets views{.z = view_z,
                          .wavelength = wavelength,
                          .window = window_of_pupils(slm.grid, 1.5e-4),
                          .picture = {},
                          .pupils = {},
                          .amplitudes = {}};
        views.pupils.push_back({{1e-4 * random.uniform(), 0, 0.02}, 1.5e-4});
        views.pupils.push_back({{-1.6e-4, -1e-4 * random.uniform(), 0.02}, 1.5e-4});  // beside the first
        views.picture =
            picture_grid(slm.grid, slm.grid.width(), slm.grid.height(), views.pupils.front(), wavelength, views.z);
        for (size_t k = 0; k < views.pupils.size(); ++k) {
          views.amplitudes.emplace_back(views.picture.ny, views.picture.nx, 0.5F);
          for (float& a : views.amplitudes.back().values) a = float(random.uniform());
        }
        return views;
      };
    if (has_no_planes) set.views = {set.draw_views(0, test_wavelength)};
    return set;
  }

  std::vector<Hologram> start() const {
    CounterRandom random(6, 0, 0);
    Slm panel = slm;
    panel.levels = levels;
    std::vector<Hologram> holograms;
    for (int m = 0; m < frames; ++m) {
      Hologram& hologram = holograms.emplace_back(make_hologram(panel, slm.modulation, [](int) { return 0; }));
      for (uint16_t& level : hologram.level.values) level = uint16_t(levels * random.uniform());
      if (slm.modulation != Modulation::complex) continue;
      hologram.modulus_level = hologram.level;
      for (uint16_t& level : hologram.modulus_level.values) level = uint16_t(levels * random.uniform());
    }
    return holograms;
  }
};

class DescentsOnDevices : public StagesOnDevices {
 protected:
  /// What descend makes of the start.
  static std::vector<Hologram> found(const DescentCase& one, const EncodeParams& params, const Observer& observer = {},
                                     const Checkpoint& checkpoint = {}) {
    std::vector<Hologram> frames = one.start();
    descend(one.targets(), one.slm, params, observer, frames, checkpoint);
    return frames;
  }
};

/// Whether all levels are the same.
inline bool are_same(const std::vector<Hologram>& a, const std::vector<Hologram>& b) {
  for (size_t m = 0; m < a.size(); ++m)
    if (a[m].level.values != b[m].level.values || a[m].modulus_level.values != b[m].modulus_level.values) return false;
  return a.size() == b.size();
}

}  // namespace holotrace::test
