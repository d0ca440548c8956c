#include "holotrace/view/camera.h"
#include "holotrace/view/sensor.h"
#include "holotrace/view/source_image.h"
#include "support/panels.h"

namespace holotrace {
namespace {

TEST(Sensor, APixelIsReadFromAsManySamplesAsItsIrradianceNeeds) {
  // A panel of S = 2.048 mm resolves λz/S = 77.9 µm at 0.3 m; the irradiance has twice that band: 2·pixel/resolved
  // samples, at least 2, and 1 for a pixel of up to a third of it.
  const Slm slm = make_panel(256, 256);
  const double resolved = test_wavelength * 0.3 / slm.grid.width();
  const auto samples_of = [&](double pixel) {
    CameraParams camera;
    camera.pixel = pixel;
    camera.width = camera.height = 8 * pixel;
    return sensor_of({slm.grid, test_wavelength}, slm, -0.3, {}, camera).samples;
  };
  EXPECT_EQ(samples_of(0.33 * resolved), 1);
  EXPECT_EQ(samples_of(0.34 * resolved), 2);
  EXPECT_EQ(samples_of(0.99 * resolved), 2);
  EXPECT_EQ(samples_of(1.01 * resolved), 3);
  EXPECT_EQ(samples_of(2.51 * resolved), 6);
}

TEST(Sensor, MemoryOfAnExtendedSourceCountsAllThatIsThereAtOnce) {
  // For every sample of the sensor's window: the field (8 bytes) and its irradiance (4). The image of the source: 4
  // bytes for each of (2·blur + 1)² samples, two padded spectra (8 each) and the convolved irradiance (4). The pixels.
  // And behind a pupil the field in it.
  const Slm slm = make_panel(64, 64);
  CameraParams camera;
  const SourcePart source{.angle = 0.02};  // 6 mm at 0.3 m: the blur is far larger than the panel
  const double z = 0.3;
  const Sensor sensor = sensor_of({slm.grid, test_wavelength}, slm, -z, {}, camera, z * source.reach());
  const double side = 2.0 * sensor.blur + 1, window = double(sensor.window.columns) * sensor.window.rows;
  EXPECT_GE(sensor.blur * sensor.window.pitch, 3e-3);  // half of it, in samples
  const auto bytes = [&] { return looking_bytes({slm.grid, test_wavelength}, slm, z, {}, camera, source); };
  const double reading = (8 + 4) * window + 4 * side * side + (2 * 8 + 4) * window + 4 * 64 * 64;
  EXPECT_GE(bytes(), reading);
  EXPECT_LT(bytes(), 1.5 * reading);  // transforms have lengths without large prime factors
  const double without = bytes();
  camera.eye = {0, 0, 0.1};
  camera.pupil = 2e-3;
  EXPECT_GE(bytes(), without + 8 * 200 * 200);  // 2 mm of samples of 8 µm are 250
}

TEST(Sensor, MemoryBehindAStopCountsItsMargin) {
  // A stop of half the panel's band spreads light over 1/2h = 2 samples: 32 of these widths are 64 samples beside each
  // edge: 384 samples a side of 8 bytes instead of 256, in the field behind the stop and in the propagation's spectrum.
  const Slm slm = make_panel(256, 256);
  const double half = 1 / (4 * slm.grid.pitch);
  const SpectralFilter stop{.half_u = half, .half_v = half};
  const auto bytes = [&](std::optional<SpectralFilter> filter) {
    return looking_bytes({slm.grid, test_wavelength, ImageSide::virtual_image, filter}, slm, 0.1, {}, {}, {});
  };
  EXPECT_GE(bytes(stop) - bytes({}), 2 * 8.0 * (384 * 384 - 256 * 256));
}

}  // namespace
}  // namespace holotrace
