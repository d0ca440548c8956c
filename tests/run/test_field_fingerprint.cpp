#include <gtest/gtest.h>

#include <functional>
#include <set>

#include "holotrace/run/scene_light.h"

namespace holotrace {
namespace {

struct Described {
  Grid panel{96, 256, 8e-6};
  SynthesizeParams params;
  Sources set{.wavelength = 532e-9};
  std::vector<int> first_rows{0, 128};

  Described() {
    set.label.name = "lamp";
    set.waves = {{{0.001, 0.002, -0.1}, 0.5F, 1.0F}, {{0, 0, -0.2}, 0.25F, 2.0F}};
  }
  uint64_t number() const { return field_fingerprint(panel, params, {&set}, first_rows); }
};

// An unfinished file is finished by jobs of its number alone: whatever changes the field has to change it.
TEST(FieldFingerprint, DiffersWithAllThatTheFieldDependsOn) {
  const std::vector<std::function<void(Described&)>> changes{
      [](Described&) {},
      [](Described& d) { d.panel.nx = 97; },
      [](Described& d) { d.panel.ny = 257; },
      [](Described& d) { d.panel.pitch = 8.1e-6; },
      [](Described& d) { d.panel.centre_x = 1e-3; },
      [](Described& d) { d.panel.centre_y = 1e-3; },
      [](Described& d) { d.params.method = SynthesisMethod::tiled; },
      [](Described& d) { d.params.tolerance /= 2; },
      [](Described& d) { d.params.device.kind = DeviceKind::opencl; },
      [](Described& d) {
        d.params.device = {DeviceKind::opencl, 1};
      },
      [](Described& d) {
        d.first_rows = {0, 64};
      },
      [](Described& d) { d.set.label.name = "lamps"; },
      [](Described& d) { d.set.label.frame = 1; },
      [](Described& d) { d.set.wavelength = 533e-9; },
      [](Described& d) { d.set.label.cone_wavelength = 450e-9; },
      [](Described& d) { d.set.waves[1].origin.z = -0.21; },
      [](Described& d) { d.set.waves[1].amplitude = 0.3F; },
      [](Described& d) { d.set.waves[0].phase = 1.5F; },
      [](Described& d) { d.set.waves.pop_back(); },
      [](Described& d) {
        d.set.tiles = {2, 1, {1, 2, 3, 4}};
      },
      [](Described& d) {
        d.set.tiles = {1, 2, {1, 2, 3, 4}};
      },
      [](Described& d) {
        d.set.tiles = {1, 2, {1, 2, 3, 5}};
      },
      [](Described& d) {
        d.set.second_foci = {{}, {{0, 0, -0.3}, {1, 0, 0}}};
      },
  };
  std::set<uint64_t> numbers;
  for (const auto& change : changes) {
    Described d;
    change(d);
    EXPECT_EQ(d.number(), d.number());
    numbers.insert(d.number());
  }
  EXPECT_EQ(numbers.size(), changes.size());
}

TEST(FieldFingerprint, TellsTheOrderOfSets) {
  Described a, b;
  b.set.wavelength = 638e-9;
  const auto number = [&](const std::vector<const Sources*>& sets) {
    return field_fingerprint(a.panel, a.params, sets, a.first_rows);
  };
  EXPECT_NE(number({&a.set, &b.set}), number({&b.set, &a.set}));
}

}  // namespace
}  // namespace holotrace
