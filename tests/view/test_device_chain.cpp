// Holograms shown and seen on OpenCL devices: the picture of the processor, what is transferred, how `auto` chooses, and what
// happens if the device fails.

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <future>

#include "holotrace/slm/panel/panel_field_by_device.h"
#include "holotrace/slm/panel/show.h"
#include "holotrace/view/camera.h"
#include "holotrace/view/device_camera.h"
#include "holotrace/view/diffraction_orders.h"
#include "holotrace/view/pupil_light.h"
#include "holotrace/wave/propagate/propagate_on_device.h"
#include "holotrace/wave/shared/stage_on_device.h"
#include "support/build_paths.h"
#include "support/panels.h"
#include "support/stages_on_devices.h"
#if HOLOTRACE_HAS_OPENCL
#include "support/faulty_api.h"
#endif

namespace holotrace {
namespace {

using namespace literals;

// A hologram of random levels, the light that it is shown in, and the camera in front of it.
struct Chain {
  std::string name;
  Slm slm = make_panel(48, 37, 200, 0.9);
  ShowParams show{};
  PropagateParams propagation{};
  CameraParams camera{};
  double distance = 20_mm;
  std::optional<SpectralFilter> filter{};
  ImageSide image = ImageSide::virtual_image;
  SourcePart source{};

  Hologram hologram() const {
    CounterRandom random(1, 0, 0);
    Hologram hologram = make_hologram(slm, slm.modulation, [](int) { return 0; });
    for (uint16_t& level : hologram.level.values) level = uint16_t(slm.levels * random.uniform());
    hologram.image = image;
    hologram.filter = filter;
    return hologram;
  }
};

// Every way of light through a camera: with and without stop, pupil, lens and blur; pixels of one sample and of several.
std::vector<Chain> chains() {
  Chain plain{"plain"}, pixels{"pixels"}, binned{"binned"}, points{"points"}, stop{"stop"}, pupil{"pupil"},
      both{"stop and pupil"}, lens{"lens"}, panel{"on the panel"}, near{"eye in the plane in focus"},
      shifted{"on the panel, beside it"}, source{"extended source"}, periodic{"periodic"}, dark{"beside the light"};
  pixels.camera.pixel = 5_um;
  pixels.camera.width = pixels.camera.height = 0.3_mm;
  binned.camera.binning = 3;
  points.camera.sampling = PixelSampling::point;
  for (Chain* one : {&stop, &both, &periodic}) one->filter = SpectralFilter{1.1e4, -0.7e4, 2e4, 3e4};
  periodic.propagation.is_periodic = true;
  for (Chain* one : {&pupil, &both, &lens, &near, &dark}) {
    one->camera.pupil = 0.4_mm;
    one->camera.eye = {20_um, 10_um, 10_mm};
  }
  stop.show.subpixels = pupil.show.subpixels = 3;
  lens.camera.focal_length = 12_mm;
  near.image = ImageSide::real_image;
  near.distance = near.camera.eye.z;
  panel.distance = shifted.distance = 0;
  panel.camera.sampling = shifted.camera.sampling = PixelSampling::point;
  shifted.camera.width = 0.2_mm;
  shifted.camera.centre_x = 0.16_mm;
  source.source.angle = 1e-3;
  dark.camera.eye.x = 30_mm;
  return {plain, pixels, binned, points, stop, pupil, both, lens, panel, near, shifted, source, periodic, dark};
}

class DeviceChains : public test::StagesOnDevices {
 protected:
  static PlacedField shown(const Chain& chain, const Observer& observer = {}) {
    return show_light(chain.hologram(), chain.slm, chain.show, {.wavelength = test_wavelength}, observer).field;
  }
  static Image seen(const PlacedField& light, const Chain& chain, const Observer& observer = {}) {
    return look(light, chain.slm, chain.distance, chain.propagation, chain.camera, observer, chain.source);
  }
  static Image picture(const Chain& chain, const Observer& observer = {}) {
    return seen(shown(chain, observer), chain, observer);
  }
  Chain there(Chain chain) const {
    chain.show = on_device(chain.show);
    chain.propagation = on_device(chain.propagation);
    return chain;
  }
  static Chain automatic_everywhere(Chain chain) {
    chain.show = automatic(chain.show);
    chain.propagation = automatic(chain.propagation);
    return chain;
  }
  // Of the picture's largest value.
  static double difference(const Image& a, const Image& b) {
    double most = 0, largest = 0;
    for (size_t i = 0; i < b.values.size(); ++i) {
      most = std::max(most, std::abs(double(a.values[i]) - b.values[i]));
      largest = std::max(largest, double(b.values[i]));
    }
    return largest > 0 ? most / largest : most;
  }
  bool uses_device(const PlacedField& light, const Chain& chain) const {
    const size_t before = device_.use().kernels;
    seen(light, chain);
    return device_.use().kernels > before;
  }
};

HOLOTRACE_FOR_ALL_DEVICES(DeviceChains);

// The panel and each of two propagations are within 2e-6 of the norm. Single samples differ by about that of the rms
// amplitude; the largest are some times as bright.
constexpr double rounding = 2e-5;

TEST_P(DeviceChains, ShowThePicturesOfTheProcessor) {
  for (const Chain& chain : chains()) {
    Heard expected, heard;
    const Image here = picture(chain, expected.observer()), image = picture(there(chain), heard.observer());
    ASSERT_EQ(image.values.size(), here.values.size()) << chain.name;
    EXPECT_LT(difference(image, here), rounding) << chain.name;
    EXPECT_EQ(image.pitch, here.pitch) << chain.name;
    EXPECT_EQ(image.centre_x, here.centre_x) << chain.name;
    EXPECT_EQ(heard.warnings, expected.warnings) << chain.name;
    EXPECT_EQ(std::get<std::string>(heard.facts.at("device")), device_.info().name) << chain.name;
    if (expected.facts.count("filter_power")) {
      EXPECT_NEAR(heard.number("filter_power"), expected.number("filter_power"), 1e-5) << chain.name;
    }
    const auto [least, most] = std::minmax_element(here.values.begin(), here.values.end());
    if (chain.name == "beside the light")
      EXPECT_EQ(*most, 0) << "it tests the way without light";
    else
      EXPECT_GT(*most, 1.5 * *least) << chain.name << ": a picture";
  }
}

// Values with a rim that no pixel needs, and bright places, beside which an integral below 0 is set to 0.
TEST_P(DeviceChains, IntegrateOverPixelsAsTheProcessor) {
  Array2D<float> values(41, 67);
  CounterRandom random(3, 0, 0);
  for (float& value : values.values) value = random.uniform() < 0.02 ? 100.0F : float(random.uniform());
  const DeviceBuffer there = device_.upload(values.values, "a test");
  for (const int n : {1, 2, 3})
    for (const auto& [rim, is_integrated] : {std::pair{0, false}, {3, false}, {2, true}, {5, true}}) {
      const Image here = mean_over_pixels(values, n, rim, is_integrated);
      const Image image =
          mean_over_pixels(device_, there, values.nx, pixel_sums(values.ny, values.nx, n, rim, is_integrated));
      ASSERT_EQ(image.nx, here.nx);
      ASSERT_EQ(image.ny, here.ny);
      // Two sums of up to 7 floats of up to 100.
      for (size_t i = 0; i < here.values.size(); ++i) ASSERT_NEAR(image.values[i], here.values[i], 1e-4) << n << rim;
      if (n == 1 && is_integrated) {
        EXPECT_GT(std::count(image.values.begin(), image.values.end(), 0.0F), 5) << "below 0";
      }
    }
}

TEST_P(DeviceChains, GiveTheSameBytesForTheSameInput) {
  for (const Chain& chain : chains()) EXPECT_EQ(picture(there(chain)).values, picture(there(chain)).values);
}

// Levels in, the picture out: the second time, when the transfer functions are there. Beside them small tables: projections
// and weights of the panel (4 + 16 bytes per row and column), twiddle factors of its lines, carriers and the band of the
// stop, spans of the pupil, weights of the pixels. Per row of a field 4 bytes come back, for the powers that are reported.
TEST_P(DeviceChains, TransferLevelsAndThePictureOnly) {
  for (const Chain& chain : chains()) {
    if (chain.name == "beside the light") continue;
    picture(there(chain));
    const DeviceUse before = device_.use();
    const Image image = picture(there(chain));
    const DeviceUse after = device_.use();
    const Grid panel = chain.slm.grid;
    const int n = chain.show.subpixels, margin = chain.filter && !chain.propagation.is_periodic ? n * panel.nx / 4 : 0;
    const size_t rows = size_t(n * panel.ny), lines = rows + size_t(n * panel.nx);
    const size_t facts = 4 * (rows + (chain.filter ? 2 * rows + 2 * size_t(margin) : 0));
    if (chain.source.angle == 0) {
      EXPECT_EQ(after.bytes_out - before.bytes_out, 4 * image.values.size() + facts) << chain.name;
    } else {
      EXPECT_GT(after.bytes_out - before.bytes_out, 4 * image.values.size() + facts) << "for the blur";
    }
    const size_t in = after.bytes_in - before.bytes_in, levels = 4 * size_t(panel.pixels());
    EXPECT_GE(in, levels) << chain.name;
    EXPECT_LE(in, levels + 24 * lines + (chain.filter ? 32 * (lines + 4 * size_t(margin)) : 0) + 8 * 64 + 100)
        << chain.name;
  }
}

TEST_P(DeviceChains, SendAndFetchLightOnce) {
  Chain chain;
  const size_t bytes = 8 * size_t(chain.slm.grid.pixels());
  const Chain device = there(chain);
  const PlacedField here = shown(chain);
  seen(here, device);  // sends the transfer function, too
  const size_t before = device_.use().bytes_in;
  seen(here, device);
  EXPECT_LT(device_.use().bytes_in - before, 100u) << "weights of the pixels";
  const PlacedField light = shown(device);
  const size_t fetched = device_.use().bytes_out;
  const std::shared_ptr<const Field> field = light.on_processor();
  EXPECT_EQ(device_.use().bytes_out - fetched, bytes);
  EXPECT_EQ(light.on_processor(), field);
  EXPECT_EQ(device_.use().bytes_out - fetched, bytes);
  EXPECT_LT(difference(seen(light, chain), picture(chain)), rounding) << "the processor sees what the device shows";
}

// The device is slower than the processor by the time that it takes to send the field, but for light that is there.
TEST_P(DeviceChains, AreChosenByWhereTheLightIs) {
  Chain chain;
  for (const bool has_pupil : {false, true}) {
    chain.camera.pupil = has_pupil ? 0.4_mm : 0;
    chain.camera.eye.z = has_pupil ? 10_mm : 0;
    const PlacedField here = shown(chain), light = shown(there(chain));
    seen(here, there(chain));  // the transfer functions are on the device
    test::set_processor_rates({.samples = 2e4});
    const double seconds = has_pupil ? PropagationForecast(chain.slm.grid, test_wavelength, 10_mm, {}).on_processor()
                                     : PropagationForecast(chain.slm.grid, test_wavelength, -20_mm, {}).on_processor();
    // Of the bytes that are transferred: 8 per sample of the field, 4 per pixel of the picture.
    const int number = device_.info().number;
    const double bytes = 10.0 * double(chain.slm.grid.pixels()) / (4 * seconds);
    set_device_rates([=](Device& device) {
      return device.info().number == number ? DeviceRates{0, bytes, 1e15} : DeviceRates();
    });
    const PlacedField fresh = shown(chain);
    EXPECT_FALSE(uses_device(fresh, automatic_everywhere(chain))) << has_pupil;
    EXPECT_TRUE(uses_device(light, automatic_everywhere(chain))) << has_pupil;
    set_device_rates({});
    EXPECT_FALSE(uses_device(light, automatic_everywhere(chain))) << "not measured";
    set_summation_rates({});
  }
}

// The levels are sent in either case; the field is fetched only if the processor takes it.
TEST_P(DeviceChains, ShowOnADeviceThatIsFasterWithoutFetchingTheField) {
  Chain chain;
  chain.show.subpixels = 3;
  const PanelModel panel(chain.slm, chain.show, Modulation::phase, chain.slm.levels, 0,
                         {.wavelength = test_wavelength});
  make_device_fast(1e15);
  const double seconds = processor_seconds(panel.work());
  const Array2D<float> drive(chain.slm.grid.ny, chain.slm.grid.nx);
  const DeviceUse use = forecast_panel(device_, panel, {drive}, false, 1e9).use;
  const double bytes = double(use.bytes_in + use.bytes_out / 2) / seconds;
  const int number = device_.info().number;
  set_device_rates([=](Device& device) {
    return device.info().number == number ? DeviceRates{0, bytes, 1e15} : DeviceRates();
  });
  const auto kernels_of = [&](const auto& work) {
    const size_t before = device_.use().kernels;
    work();
    return device_.use().kernels - before;
  };
  const ShowParams params = automatic(chain.show);
  const IlluminationState state{.wavelength = test_wavelength};
  EXPECT_EQ(kernels_of([&] { show_state(chain.hologram(), chain.slm, params, state); }), 0u);
  EXPECT_GT(kernels_of([&] { show_light(chain.hologram(), chain.slm, params, state); }), 0u);
}

TEST_P(DeviceChains, WriteNothingPastTheirBuffers) {
  const size_t before = device_.broken_guards();
  device_.guard_buffers(true);
  for (const Chain& chain : chains()) picture(there(chain));
  drop_device_propagators();
  device_.guard_buffers(false);
  EXPECT_EQ(device_.broken_guards(), before);
}

TEST_P(DeviceChains, RefuseWhatTheProcessorRefuses) {
  Chain chain;
  chain.filter = SpectralFilter{1e6, 0, 1e3, 1e3};
  make_device_fast(1e15);
  const std::string error = error_of([&] { picture(chain); });
  EXPECT_NE(error.find("expected a pass band"), std::string::npos) << error;
  Heard heard;
  EXPECT_EQ(error_of([&] { picture(automatic_everywhere(chain), heard.observer()); }), error);
  EXPECT_EQ(heard.warnings, std::vector<std::string>{}) << "no fault of the device";
  chain.filter.reset();
  chain.camera.pupil = 1_um;
  chain.camera.eye = {3_um, 0, 10_mm};
  const std::string none = error_of([&] { picture(chain); });
  EXPECT_NE(none.find("expected a pupil that holds a sample"), std::string::npos) << none;
  EXPECT_EQ(error_of([&] { picture(automatic_everywhere(chain), heard.observer()); }), none);
  EXPECT_EQ(heard.warnings, std::vector<std::string>{});
}

// Propagators that are kept make room for a stop and for the sensor.
TEST_P(DeviceChains, SayThatMemoryIsShort) {
  Chain chain;
  chain.filter = SpectralFilter{0, 0, 2e4, 2e4};
  const PlacedField light = shown(there(chain));
  device_.limit_memory((double(device_.use().bytes_held) + 2e3) / 0.8);
  const std::string error = error_of([&] { seen(light, there(chain)); });
  EXPECT_NE(error.find("of memory for "), std::string::npos) << error;
  EXPECT_NE(error.find(" on the device " + device_.info().name), std::string::npos) << error;
  make_device_fast(1e15);
  Heard heard;
  EXPECT_LT(difference(seen(light, automatic_everywhere(chain), heard.observer()), picture(chain)), rounding);
  ASSERT_EQ(heard.warnings.size(), 2u) << "the stop, and the way to the sensor";
  EXPECT_EQ(heard.warnings[0], "the device auto: the processor took over, because " + error);
  EXPECT_EQ(heard.facts.count("device"), 0u);
}

TEST_P(DeviceChains, MakeRoomForAStop) {
  Chain chain;
  seen(shown(chain), there(chain));
  const size_t kept = device_.use().bytes_held;
  ASSERT_GT(kept, 0u);
  chain.filter = SpectralFilter{0, 0, 2e4, 2e4};
  chain = there(chain);
  const PlacedField light = shown(chain);
  const Grid& grid = light.head().grid;
  const DeviceUse stop =
      forecast_order_stop(device_, grid, *chain.filter, order_stop_margin(*chain.filter, light.head().grid));
  device_.limit_memory((double(device_.use().bytes_held) - double(kept) + double(stop.most_released()) + 8) / 0.8);
  EXPECT_EQ(error_of([&] { light_in_pupil(light, chain.slm, chain.propagation, chain.camera); }), "no error");
  EXPECT_LE(device_.use().bytes_held, 8 * size_t(grid.pixels())) << "only the shown light is left";
}

TEST_P(DeviceChains, MakeRoomForLightThatIsSent) {
  Chain chain;
  const PlacedField light = shown(chain);
  seen(light, there(chain));  // keeps a transfer function, and the light
  const PlacedField other = shown(chain);
  const size_t kept = device_.use().bytes_held - 8 * size_t(light.head().grid.pixels());
  ASSERT_GT(kept, 8 * size_t(light.head().grid.pixels()));
  device_.limit_memory((double(device_.use().bytes_held) + 100) / 0.8);
  EXPECT_EQ(error_of([&] { other.on(device_); }), "no error");
}

TEST_P(DeviceChains, MakeRoomForAPanel) {
  Chain chain;
  const double pixels = double(chain.slm.grid.pixels());
  seen(shown(chain), there(chain));
  ASSERT_GT(device_.use().bytes_held, 8 * size_t(pixels));
  chain = there(chain);
  // 56 bytes per pixel for one term and n = 1, of 0.9 of the memory, and for each row and column 20 and twiddle factors.
  device_.limit_memory((56 / 0.9 * pixels + 28 * (48 + 37) + 1000) / 0.8);
  EXPECT_EQ(error_of([&] { shown(chain); }), "no error");
  EXPECT_EQ(device_.use().bytes_held, 0u) << "transfer functions made room";
}

TEST_P(DeviceChains, MakeRoomForAWindowOfTheSameLight) {
  Chain chain = there(chains()[10]);
  ASSERT_EQ(chain.name, "on the panel, beside it");
  const PlacedField light = shown(chain);
  Chain far = chain;
  far.distance = 20_mm;
  seen(light, far);
  PropagateParams window = chain.propagation;
  window.columns = 70;
  window.rows = 71;
  const auto there = light.on(device_);
  device_.limit_memory((double(device_.use().bytes_held) + 100) / 0.8);
  ASSERT_GT(device_.use().bytes_held, light.on(device_)->samples.bytes() + 8 * 70 * 71);
  EXPECT_EQ(error_of([&] { propagate(*there, 0, window); }), "no error");
}

// Another thread, whose work is on the device, holds its lock: until it is done, nobody knows what memory is left.
TEST_P(DeviceChains, MakeRoomUnderTheDevicesLock) {
  Chain chain;
  seen(shown(chain), there(chain));
  const size_t kept = device_.use().bytes_held;
  ASSERT_GT(kept, 0u);
  for (const double bytes : {0.0, 1e18}) {
    std::future<void> room;
    {
      const auto lock = device_.lock();
      room = std::async(std::launch::async, [&] { make_room(device_, bytes); });
      EXPECT_EQ(room.wait_for(std::chrono::milliseconds(300)), std::future_status::timeout);
      EXPECT_EQ(device_.use().bytes_held, kept);
    }
    room.get();
    EXPECT_EQ((device_.use().bytes_held < kept), (bytes > 0));
  }
}

// The rates of a device are measured when they are first needed. The picture is that of the processor.
TEST_P(DeviceChains, GiveWayIfADeviceFailsWhenItIsMeasured) {
  Chain chain = chains()[6];
  ASSERT_EQ(chain.name, "stop and pupil");
  const PlacedField light = shown(there(chain));
  const Image expected = seen(light, chain);
  make_device_fast(1e15);
  set_device_rates([](Device&) -> DeviceRates { throw Error("the device stopped"); });
  const PlacedField again = shown(there(chain));
  EXPECT_EQ(seen(again, automatic_everywhere(chain)).values, expected.values);
}

// The viewer keeps the light in the pupil on the processor. The device is fast enough to get the shown light, but not for the
// light's return, which has more samples: those of the window behind a stop.
TEST_P(DeviceChains, CountTheReturnOfLightThatIsNeededOnTheProcessor) {
  Chain chain;
  chain.filter = SpectralFilter{0, 0, 2e4, 2e4};
  const PlacedField light = shown(chain);
  make_device_fast(1e15);
  const int margin = order_stop_margin(*chain.filter, light.head().grid);
  const double seconds = processor_seconds(order_stop_cost(light.head().grid, *chain.filter, margin).work);
  const double bytes = 1.5 * 8 * double(light.head().grid.pixels()) / seconds;
  const int number = device_.info().number;
  set_device_rates([=](Device& device) {
    return device.info().number == number ? DeviceRates{0, bytes, 1e15} : DeviceRates();
  });
  const auto uses = [&](bool returns) {
    const size_t before = device_.use().kernels;
    light_in_pupil(PlacedField(light.on_processor()), chain.slm, automatic(chain.propagation), chain.camera, {},
                   returns);
    return device_.use().kernels > before;
  };
  EXPECT_TRUE(uses(false));
  EXPECT_FALSE(uses(true));
}

#if HOLOTRACE_HAS_OPENCL
// Calls of the driver fail one after the other: memory, transfers and kernels, of the panel, the stop, propagations and the
// sensor. A named device says so in one sentence. `auto` gives the picture of the processor, with warnings; also if light that
// is on the device can no longer be fetched.
TEST_P(DeviceChains, ReleaseTheirMemoryAndGiveWayAfterAnyFault) {
  const Chain chain = chains()[6];
  ASSERT_EQ(chain.name, "stop and pupil");
  make_device_fast(1e15);
  picture(there(chain));  // compiles the kernels
  const Image expected = picture(chain);
  struct DropAtEnd {
    ~DropAtEnd() { drop_device_propagators(); }
  };
  drop_device_propagators();
  const auto on_named = [&] {
    const DropAtEnd drop;
    picture(there(chain));
  };
  const int faults = test::fail_every(5, on_named, [&](const std::string& error) {
    const DropAtEnd drop;
    Heard heard;
    EXPECT_LT(difference(picture(automatic_everywhere(chain), heard.observer()), expected), rounding);
    EXPECT_EQ(heard.warnings, std::vector{test::warning_after(error)});
  });
  EXPECT_GT(faults, 20);
}

TEST_P(DeviceChains, ShowTheLightAgainIfItsDeviceIsLost) {
  Chain chain;
  make_device_fast(1e15);
  const PlacedField named = shown(there(chain)), light = shown(automatic_everywhere(chain));
  const Image expected = picture(chain);
  test::FaultyApi api;
  api.failing = 0;
  EXPECT_NE(error_of([&] { named.on_processor(); }), "no error");
  api.calls = 0;
  Heard heard;
  EXPECT_EQ(look(PlacedField(light.on_processor(heard.observer())), chain.slm, chain.distance, {}, {}).values,
            expected.values);
  ASSERT_EQ(heard.warnings.size(), 1u);
  EXPECT_EQ(heard.warnings[0].find("the device auto: the processor took over, because the device "), 0u);
  EXPECT_GT(light.seconds_to(device_), 0) << "what was on the device is given up";
}

TEST_P(DeviceChains, PassThePupilAgainIfTheirDeviceIsLost) {
  Chain chain = automatic_everywhere(chains()[5]);
  make_device_fast(1e15);
  const PlacedField light(show(chain.hologram(), chain.slm, {}));
  const PlacedField passed = light_in_pupil(light, chain.slm, chain.propagation, chain.camera);
  const PlacedField expected = light_in_pupil(light, chain.slm, {}, chain.camera);
  test::FaultyApi api;
  api.failing = 0;
  Heard heard;
  EXPECT_EQ(passed.on_processor(heard.observer())->samples.values, expected.on_processor()->samples.values);
  EXPECT_EQ(heard.warnings.size(), 1u);
}
#endif

}  // namespace
}  // namespace holotrace
