#include "holotrace/slm/encode/encode_on_device.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "holotrace/base/error.h"
#include "holotrace/base/units.h"
#include "holotrace/slm/encode/blank_hologram.h"
#include "holotrace/slm/encode/device_levels.h"
#include "holotrace/wave/shared/cost_model.h"
#include "holotrace/wave/shared/stage_on_device.h"

namespace holotrace {
namespace {

double bytes_of(const Field& head) { return double(head.grid.pixels()) * sizeof(std::complex<float>); }

// Levels that are found on a device, or on one that only counts; none if a sample is not finite.
std::optional<Hologram> encode_there(const DeviceSamples& field, Hologram hologram, const PhaseLevels& levels,
                                     const EncodeParams& params, const Observer& observer) {
  const ModulusMoments moments = modulus_moments(field);
  if (!std::isfinite(moments.largest)) return std::nullopt;
  std::vector<std::pair<std::string, Fact>> facts;  // told when no device can fail any more
  Observer listener = observer;
  listener.on_fact = [&](const std::string& name, const Fact& value) { facts.emplace_back(name, value); };
  encode_anywhere(ShownPixels<DeviceSamples>{field, moments, params.image == ImageSide::real_image}, params, levels,
                  listener, hologram);
  if (observer.on_fact)
    for (const auto& [name, value] : facts) observer.on_fact(name, value);
  if (moments.largest == 0) warn_of_dark_field(hologram.wavelength, observer);
  observer.fact("device", field.device->info().name);
  return hologram;
}

// What the processor does: it reads the field for its moments, and once for each of the levels.
SummationWork work_of_processor(const EncodeParams& params, const Field& head) {
  const double pixels = double(head.grid.pixels()), nx = head.grid.nx, ny = head.grid.ny;
  const bool is_limited = params.method == Encoding::double_phase;
  SummationWork work;
  work.samples = (params.method == Encoding::complex ? 3 : 2) * pixels;
  if (!stop_of(params, head.grid, head.wavelength)) return work;
  work.samples += (is_limited ? 4 : 2) * pixels;  // the stop, moduli, levels; irradiances
  work.fft_operations = (is_limited ? 2 : 1) * (ny * fft_operations(nx) + nx * fft_operations(ny));
  return work;
}

// Memory of a device for the field and its encoder, once all that is kept there for later is dropped.
double room_for(const Device& device, const PlacedField& field) {
  return possible_room(device) + (field.is_on(device) ? bytes_of(field.head()) : 0);
}

// A hologram of that size without levels, for devices that only count.
Hologram without_levels(const Hologram& blank) {
  Hologram counted;
  counted.grid = blank.grid;
  counted.levels = blank.levels;
  counted.wavelength = blank.wavelength;
  counted.modulation = blank.modulation;
  counted.encoder = blank.encoder;
  counted.level.nx = blank.grid.nx;
  counted.level.ny = blank.grid.ny;
  return counted;
}

}  // namespace

EncodeForecast forecast_encoding(const Device& device, const Field& head, const Hologram& blank,
                                 const PhaseLevels& levels, const EncodeParams& params, double memory) {
  EncodeForecast forecast;
  const int most_parts = std::max(head.grid.nx, head.grid.ny);
  for (;; forecast.parts *= 2) {
    Device counter(device.info(), memory);
    DeviceSamples field{.device = &counter, .head = head, .parts = forecast.parts};
    if (forecast.parts == 1) field.there = std::make_shared<const DeviceField>(make_device_field(counter, head));
    encode_there(field, without_levels(blank), levels, params, {});
    forecast.use = counter.use();
    forecast.fits =
        double(forecast.use.most_held) <= memory && double(forecast.use.largest_buffer) <= device.info().largest_buffer;
    if (forecast.fits || forecast.parts >= most_parts) return forecast;
  }
}

std::optional<Hologram> encode_on(Device& device, const PlacedField& field, const Hologram& blank,
                                  const PhaseLevels& levels, const EncodeParams& params, const Observer& observer) {
  const Field& head = field.head();
  EncodeForecast forecast = forecast_encoding(device, head, blank, levels, params, room_for(device, field));
  if (forecast.parts == 1 && forecast.fits) {
    const auto there = field.on(device, observer);
    const auto lock = device.lock();
    make_room(device, double(forecast.use.most_held) - bytes_of(head));
    return encode_there(DeviceSamples::whole(there), blank, levels, params, observer);
  }
  const auto here = field.only_on_processor(observer);
  const auto lock = device.lock();
  make_room(device, device.memory());
  const double left = std::max(0.0, device.memory_left());
  forecast = forecast_encoding(device, head, blank, levels, params, left);  // others may have used the device until now
  require(
      forecast.fits,
      "expected {} of memory for bands of a field of {} × {} samples on the device {}, got {}; use a smaller panel, or "
      "the device cpu",
      format_bytes(double(forecast.use.most_held)), head.grid.nx, head.grid.ny, device.info().name, format_bytes(left));
  const DeviceSamples samples = forecast.parts == 1
                                    ? DeviceSamples::whole(std::make_shared<const DeviceField>(send(device, *here)))
                                    : DeviceSamples::in_parts(device, here, forecast.parts);
  return encode_there(samples, blank, levels, params, observer);
}

Device* fastest_to_encode(const PlacedField& field, const Hologram& blank, const PhaseLevels& levels,
                          const EncodeParams& params) {
  const double on_processor = processor_seconds(work_of_processor(params, field.head()));
  return fastest_device(field.seconds_to_processor() + on_processor, [&](Device& device) {
    const EncodeForecast forecast =
        forecast_encoding(device, field.head(), blank, levels, params, room_for(device, field));
    if (!forecast.fits) return std::numeric_limits<double>::infinity();
    const double way = forecast.parts == 1 ? field.seconds_to(device) : field.seconds_to_processor();
    return way + predict_seconds(forecast.use, device_rates(device));
  });
}

}  // namespace holotrace
