// What a camera sees of a series of holograms, against the verbs one by one.

#include <gtest/gtest.h>

#include <algorithm>

#include "holotrace/base/error.h"
#include "holotrace/base/units.h"
#include "holotrace/run/scene_light.h"
#include "holotrace/run/view_holograms.h"
#include "holotrace/slm/encode/encode.h"
#include "holotrace/slm/panel/show.h"
#include "holotrace/view/camera.h"
#include "support/stages_on_devices.h"

namespace holotrace::test {
namespace {

using namespace literals;

constexpr double green = 532_nm, red = 638_nm;

// Levels of a grating that differs with `step`.
PanelHologram hologram_of(double wavelength, int step) {
  PanelHologram one;
  one.slm.grid = one.hologram.grid = {24, 16, 8_um};
  one.hologram.wavelength = wavelength;
  one.hologram.level = Array2D<uint16_t>(16, 24);
  for (size_t i = 0; i < one.hologram.level.size(); ++i)
    one.hologram.level.values[i] = uint16_t(i * size_t(step) % 256);
  return one;
}

HologramSeries series_of(const std::vector<PanelHologram>& holograms, std::vector<size_t>* asked = nullptr) {
  return {holograms.size(), [&holograms, asked](size_t i) {
            if (asked) asked->push_back(i);
            return holograms[i];
          }};
}

ViewingParams params_at(std::vector<double> distances) {
  ViewingParams params;
  params.camera.distances = std::move(distances);
  params.from = viewpoints(params.camera);
  return params;
}

// The irradiance of one hologram by the verbs themselves.
Image seen(const PanelHologram& one, const ViewingParams& params, double distance) {
  return look(show(one.hologram, one.slm, params.show), one.slm, distance, params.propagation, params.camera);
}

SeriesViews view(const std::vector<PanelHologram>& holograms, const ViewingParams& params) {
  Report report;
  return view_holograms(series_of(holograms), params, report);
}

TEST(ViewHolograms, OneHologramIsWhatTheVerbsShow) {
  const std::vector<PanelHologram> one{hologram_of(green, 7)};
  const ViewingParams params = params_at({10_mm, 20_mm});
  const SeriesViews views = view(one, params);
  ASSERT_EQ(views.views.images.size(), 2U);
  EXPECT_EQ(views.views.images[0].values, seen(one[0], params, 10_mm).values);
  EXPECT_EQ(views.views.images[1].values, seen(one[0], params, 20_mm).values);
  EXPECT_TRUE(views.sweep.images.empty());
  EXPECT_TRUE(views.stereo.images.empty());
}

// Tilted light of the same irradiance brings the panel the same power, and the panel sends the same on in every state.
TEST(ViewHolograms, OrdersOfSeveralStatesAddUpToTheEfficiency) {
  ViewingParams params = params_at({10_mm});
  params.show.subpixels = 3;
  params.show.source_angle = 1e-3;
  params.show.illumination_states = 5;
  Report report;
  view_holograms(series_of({hologram_of(green, 7)}), params, report);
  double sum = 0, efficiency = 0;
  int64_t states = 0;
  for (const StageReport& stage : report.stages)
    for (const auto& [name, value] : stage.facts) {
      if (name.starts_with("order_efficiency ")) sum += std::get<double>(value);
      if (name == "efficiency") efficiency = std::get<double>(value);
      if (name == "illumination_states") states = std::get<int64_t>(value);
    }
  EXPECT_EQ(states, 5);
  EXPECT_GT(efficiency, 0.5);
  EXPECT_NEAR(sum, efficiency, 1e-5);  // floats
}

TEST(ViewHolograms, FramesAreAveraged) {
  const std::vector<PanelHologram> frames{hologram_of(green, 7), hologram_of(green, 50)};
  const ViewingParams params = params_at({10_mm});
  const Image a = seen(frames[0], params, 10_mm), b = seen(frames[1], params, 10_mm);
  const SeriesViews views = view(frames, params);
  for (size_t i = 0; i < a.values.size(); ++i)  // of two floats: rounded once
    EXPECT_FLOAT_EQ(views.views.images[0].values[i], (a.values[i] + b.values[i]) / 2);
}

TEST(ViewHolograms, TwoWavelengthsMakeAColourPicture) {
  const ViewingParams params = params_at({10_mm});
  EXPECT_EQ(view({hologram_of(green, 7), hologram_of(red, 7)}, params).views.images[0].channels, 3);
}

TEST(ViewHolograms, EachHologramIsAskedForOnceInOrder) {
  const std::vector<PanelHologram> holograms{hologram_of(green, 1), hologram_of(red, 2), hologram_of(green, 3)};
  std::vector<size_t> asked;
  Report report;
  view_holograms(series_of(holograms, &asked), params_at({10_mm}), report);
  EXPECT_EQ(asked, (std::vector<size_t>{0, 1, 2}));
  EXPECT_EQ(std::count_if(report.stages.begin(), report.stages.end(), [](const auto& s) { return s.stage == "show"; }),
            1);
}

TEST(ViewHolograms, EyesAndSweepsHaveAnExposureOfTheirOwn) {
  ViewingParams params;
  params.camera.distances = {10_mm};
  params.camera.pupil = 0.1_mm;
  params.camera.eye = {0, 0, 20_mm};
  params.camera.sweep = Sweep::focus;
  params.camera.sweep_from = 5_mm;
  params.camera.sweep_to = 15_mm;
  params.camera.sweep_views = 3;
  RenderParams eyes;
  eyes.eye = params.camera.eye;
  eyes.eye_separation = 0.1_mm;
  params.from = viewpoints(params.camera, eyes);
  const SeriesViews views = view({hologram_of(green, 7)}, params);
  EXPECT_EQ(views.sweep.images.size(), 3U);
  EXPECT_EQ(views.stereo.images.size(), 2U);
  EXPECT_EQ(views.sweep.white, common_white(view({hologram_of(green, 7)}, params).sweep.images, 0));
  CameraParams left = params.camera;
  left.eye.x = -0.05_mm;
  const PanelHologram one = hologram_of(green, 7);
  EXPECT_EQ(views.stereo.images[0].values, look(show(one.hologram, one.slm, {}), one.slm, 10_mm, {}, left).values);
}

TEST(ViewHolograms, NoHologramIsAnError) {
  Report report;
  EXPECT_THROW(view_holograms({}, params_at({10_mm}), report), Error);
}

class ViewHologramsOnDevices : public StagesOnDevices {};

HOLOTRACE_FOR_ALL_DEVICES(ViewHologramsOnDevices);

// Two pictures of 24 × 16 pixels, and 16 rows for the power that leaves the panel. For the orders of three samples per pixel the
// field of the first hologram comes back.
TEST_P(ViewHologramsOnDevices, KeepTheLightThere) {
  const std::vector<PanelHologram> two{hologram_of(green, 7), hologram_of(green, 5)};
  ViewingParams params = params_at({10_mm, 20_mm});
  const SeriesViews expected = view(two, params);
  params.show = on_device(params.show);
  params.propagation = on_device(params.propagation);
  for (const int subpixels : {1, 3}) {
    params.show.subpixels = subpixels;
    const size_t before = device_.use().bytes_out;
    const SeriesViews views = view(two, params);
    const size_t pictures = 2 * 2 * 4 * 24 * 16, powers = 2 * 4 * 16 * size_t(subpixels);
    EXPECT_EQ(device_.use().bytes_out - before, pictures + powers + (subpixels == 3 ? 8 * 9 * 24 * 16 : 0));
    if (subpixels == 3) continue;
    for (size_t i = 0; i < expected.views.images.size(); ++i)
      for (size_t k = 0; k < expected.views.images[i].values.size(); ++k)
        ASSERT_NEAR(views.views.images[i].values[k], expected.views.images[i].values[k], 1e-4)
            << "floats, of about 1 W/m²";
  }
  // The camera on the processor gets the field.
  params.show.subpixels = 1;
  params.propagation.device = {};
  const size_t before = device_.use().bytes_out;
  view(two, params);
  EXPECT_EQ(device_.use().bytes_out - before, 2U * 8 * 24 * 16);
}

// Waves in; levels and the picture out. Four bytes of each row come back for the energy of the sum and the power that leaves the
// panel, and twelve for the brightness of the hologram.
TEST_P(ViewHologramsOnDevices, LeaveFieldsThereFromTheWavesOn) {
  const Slm slm{.grid = {24, 16, 8_um}};
  SceneLight light;
  light.sources = {{green, {{{20e-6, 0, -12_mm}, 1, 0}, {{0, 30e-6, -10_mm}, 1, 1}}}};
  const EncodeParams encoding = on_device(EncodeParams{.method = Encoding::phase});
  const SynthesizeParams sum = on_device(SynthesizeParams{.method = SynthesisMethod::tiled});
  ViewingParams params = params_at({10_mm});
  params.show = on_device(params.show);
  params.propagation = on_device(params.propagation);
  const auto run = [&] {
    const PlacedField field = placed_fields_of_frame(light, 0, slm.grid, sum).front();
    return view({{encode(field, slm, encoding), slm}}, params).views.images.front();
  };
  run();  // sends transfer functions
  const DeviceUse before = device_.use();
  const Image image = run();
  const DeviceUse after = device_.use();
  constexpr size_t pixels = 24 * 16;
  EXPECT_EQ(after.bytes_out - before.bytes_out, 2 * pixels + 4 * pixels + (4 + 16 + 4) * 16);
  EXPECT_LE(after.bytes_in - before.bytes_in, 4 * pixels + 2 * 48 + 24 * (24 + 16) + 8 * (24 + 16) + 100)
      << "levels, two waves, and tables of rows and columns";
  const Field field = fields_of_frame(light, 0, slm.grid, {.method = SynthesisMethod::tiled}).front();
  const Image expected =
      view({{encode(field, slm, {.method = Encoding::phase}), slm}}, params_at({10_mm})).views.images.front();
  ASSERT_EQ(image.values.size(), expected.values.size());
  // The sums differ by the tolerance of 1e-3, so that a few levels do, by a step of 2π/256.
  for (size_t i = 0; i < image.values.size(); ++i) EXPECT_NEAR(image.values[i], expected.values[i], 0.05);
}

}  // namespace
}  // namespace holotrace::test
