#include "holotrace/wave/synthesize.h"

#include <algorithm>
#include <limits>
#include <optional>
#include <utility>

#include "holotrace/base/error.h"
#include "holotrace/base/machine.h"
#include "holotrace/data/params/parameter.h"
#include "holotrace/opencl/device.h"
#include "holotrace/wave/layers/sum_layers.h"
#include "holotrace/wave/shared/spherical_wave_kernel.h"
#include "holotrace/wave/shared/stage_on_device.h"
#include "holotrace/wave/shared/sum_by_kind.h"
#include "holotrace/wave/sum_exact.h"

namespace holotrace {
namespace {

// Calls visit with the number of pixels that each wave lights; pixels of panel tiles with amplitude 0 do not count.
template <class Visit>
void for_each_wave(const Sources& sources, const Grid& grid, const Visit& visit) {
  const double tangent = acceptance_tangent(sources.acceptance_wavelength(), grid.pitch);
  const int parts = panel_parts(sources);
  for (size_t i = 0; i < sources.waves.size(); ++i) {
    const PixelBox box = lit_box(sources, i, grid, tangent);
    if (sources.tiles.columns == 0) {
      visit(box.pixels());
      continue;
    }
    int64_t pixels = 0;
    for (int part = 0; part < parts; ++part)
      if (amplitude_in(sources, i, part) != 0) pixels += intersect(box, panel_part(sources, grid, part)).pixels();
    visit(pixels);
  }
}

void report_boxes(const Sources& sources, const Grid& grid, const Observer& observer) {
  int64_t missed = 0, sum = 0;
  for_each_wave(sources, grid, [&](int64_t pixels) {
    sum += pixels;
    missed += pixels == 0;
  });
  observer.fact("waves", sources.waves.size());
  observer.fact("waves_pixels", sum);
  if (missed > 0)
    observer.warn(fmt::format(
        "{} of {} waves light no pixel: they are outside the panel's diffraction cone (half angle {}); move them "
        "nearer to the axis or farther from the panel",
        missed, sources.waves.size(),
        format_angle(std::asin(acceptance_sine(sources.acceptance_wavelength(), grid.pitch)))));
}

// The waves with the mean of their two curvatures, on the panel in their middle ray.
Sources as_spherical(Sources sources) {
  for (size_t i = 0; i < sources.waves.size(); ++i) {
    if (!is_astigmatic(sources, i)) continue;
    Source& wave = sources.waves[i];
    const AstigmaticWave astigmatic(wave.origin, sources.second_foci[i]);
    const Vec3 way = normalize(sources.second_foci[i].place - wave.origin), direction = way.z > 0 ? way : -way;
    const double first = -wave.origin.z / direction.z, second = -sources.second_foci[i].place.z / direction.z;
    const Vec3 place = wave.origin + direction * first;
    constexpr double farthest = 100;  // [m]
    const double curvature = (1 / first + 1 / second) / 2;
    const double distance = std::abs(curvature) > 1 / farthest ? 1 / curvature : farthest;
    wave.origin = place - direction * distance;
    wave.phase = float(wave.phase + 2 * pi * cycle_fraction(first - distance, sources.wavelength));
    wave.amplitude = float(wave.amplitude * astigmatic.at(place).modulus / direction.z);
  }
  sources.second_foci.clear();
  return sources;
}

constexpr double infinite = std::numeric_limits<double>::infinity();

bool runs_on_devices(SynthesisMethod method) {
  return method == SynthesisMethod::automatic || method == SynthesisMethod::tiled || method == SynthesisMethod::planes;
}

Approach approach_of(SynthesisMethod method) {
  if (method == SynthesisMethod::tiled) return Approach::tiled;
  return method == SynthesisMethod::planes ? Approach::planes : Approach::cheapest;
}

// What becomes of a field that a device sums.
struct Place {
  bool stays = false;   // there, if that has memory for it
  bool returns = true;  // to the processor, at once or later
};

// The device that is expected to sum the waves faster than the processor and the other devices; none: the processor is. The
// field's return counts.
Device* fastest_device_for(const Sources& sources, const Grid& grid, const SynthesizeParams& params, bool returns) {
  if (!runs_on_devices(params.method)) return nullptr;
  const Approach approach = approach_of(params.method);
  const auto seconds = [&](Device* device) {
    const SumForecast forecast = forecast_sum(sources, grid, params.tolerance, {approach, device, !returns});
    return forecast.method.empty() ? infinite : forecast.seconds;
  };
  const double on_processor = seconds(nullptr) * thread_count() / processor_threads();
  return fastest_device(on_processor, [&](Device& device) { return seconds(&device); });
}

// The devices that sum the waves; none: the processor does, as it does all astigmatic ones.
std::vector<Device*> devices_for(const Sources& sources, const Grid& grid, const SynthesizeParams& params,
                                 bool returns) {
  if (params.device.kind == DeviceKind::cpu || has_astigmatic(sources)) return {};
  if (params.device.kind == DeviceKind::automatic) {
    Device* const device = fastest_device_for(sources, grid, params, returns);
    return device ? std::vector<Device*>{device} : std::vector<Device*>();
  }
  require(runs_on_devices(params.method),
          "expected the method auto, tiled or planes on an OpenCL device, got {}; use one of them, or the device cpu",
          method_name(params.method));
  if (params.device.kind == DeviceKind::all) return open_equal_devices(0);
  return {&open_device(params.device.number)};
}

// By the method that the parameters name, which is one that sums waves.
SummedField sum_waves(const Sources& sources, const Grid& grid, const SynthesizeParams& params,
                      const std::vector<Device*>& devices, bool stays, const Observer& observer) {
  const auto exact = [&]() -> SummedField {
    observer.fact("method", std::string("exact"));
    return {convert<float>(sum_exact(sources, grid, observer))};
  };
  switch (params.method) {
    case SynthesisMethod::exact:
      return exact();
    case SynthesisMethod::tiled:
    case SynthesisMethod::planes:
      return sum_within(sources, grid, params.tolerance, {approach_of(params.method), devices, stays}, observer);
    case SynthesisMethod::layers:
      observer.fact("method", std::string("layers"));
      return {sum_layers(sources, grid, params, observer)};
    case SynthesisMethod::triangles:
      throw Error("expected a method that sums waves, got triangles, which need surfaces; give a scene or a mesh");
    case SynthesisMethod::automatic:
      break;
  }
  double reachable = 0;
  std::optional<SummedField> field =
      try_sum(sources, grid, params.tolerance, {approach_of(params.method), devices, stays}, reachable, observer);
  if (!field) {
    observer.fact("why", fmt::format("the other methods reach {:.1e} at best, the tolerance is {:.1e}", reachable,
                                     params.tolerance));
    return exact();
  }
  observer.fact("why", fmt::format("the fastest that is expected to meet the tolerance of {:.1e}", params.tolerance));
  return std::move(*field);
}

// On the chosen device; if the device `auto` fails, on the processor.
SummedField sum_where_chosen(const Sources& sources, const Grid& grid, const SynthesizeParams& params, Place place,
                             const Observer& observer) {
  check_grid(grid);
  check_sources(sources);
  require(!sources.waves.empty(), "expected at least one source, got none; is the scene lit and in view?");
  check_ranges(params);
  const std::vector<Device*> devices = devices_for(sources, grid, params, place.returns);
  report_boxes(sources, grid, observer);
  if (devices.empty() || params.device.kind != DeviceKind::automatic)
    return sum_waves(sources, grid, params, devices, place.stays, observer);
  try {
    return sum_waves(sources, grid, params, devices, place.stays, observer);
  } catch (const Error& error) {
    warn_of_takeover(observer, error.what());
    return sum_waves(sources, grid, params, {}, place.stays, observer);
  }
}

}  // namespace

std::string method_name(SynthesisMethod method) {
  switch (method) {
    case SynthesisMethod::exact:
      return "exact";
    case SynthesisMethod::tiled:
      return "tiled";
    case SynthesisMethod::planes:
      return "planes";
    case SynthesisMethod::layers:
      return "layers";
    case SynthesisMethod::triangles:
      return "triangles";
    case SynthesisMethod::automatic:
      break;
  }
  return "auto";
}

DeviceChoice chosen_device(const Sources& sources, const Grid& grid, const SynthesizeParams& params) {
  if (params.device.kind != DeviceKind::automatic) return params.device;
  const auto [behind, mirrored, astigmatic] = kinds_of(sources);  // the last go to no device
  const Sources& larger = behind.waves.size() >= mirrored.waves.size() ? behind : mirrored;
  const Device* device = larger.waves.empty() ? nullptr : fastest_device_for(larger, grid, params, true);
  return device ? DeviceChoice{DeviceKind::opencl, device->info().number} : DeviceChoice{};
}

SumForecast forecast_synthesis(const Sources& sources, const Grid& grid, const SynthesizeParams& params) {
  const auto [behind, mirrored, astigmatic] = kinds_of(sources);
  SumForecast all;
  bool is_within = true;
  const auto add = [&](const Sources& kind) {
    if (kind.waves.empty()) return;
    const SumForecast one = forecast_sum(kind, grid, params.tolerance, approach_of(params.method));
    is_within = is_within && !one.method.empty();
    all.seconds += one.seconds;
    if (all.method != "planes") all.method = one.method;
  };
  add(behind);
  add(mirrored);
  for (const Sources& group : astigmatic) add(group);
  return is_within ? all : SumForecast{};
}

int64_t waves_pixels(const Sources& sources, const Grid& grid) {
  int64_t sum = 0;
  for_each_wave(sources, grid, [&](int64_t pixels) { sum += pixels; });
  return sum;
}

Field synthesize(const Sources& sources, const Grid& grid, const SynthesizeParams& params, const Observer& observer) {
  check_sources(sources);
  if (params.method == SynthesisMethod::layers && has_astigmatic(sources)) {
    observer.warn(
        "the method layers shows astigmatic waves of curved mirrors and glass as spherical ones; use auto for both focal lines");
    return synthesize(as_spherical(sources), grid, params, observer);
  }
  const auto sum = [&](const Sources& kind, const Observer& of_kind) {
    return sum_where_chosen(kind, grid, params, {}, of_kind).field;
  };
  if (params.method == SynthesisMethod::layers) return sum(sources, observer);  // near waves hide those on both sides
  return sum_by_kind(sources, observer, sum);
}

PlacedField synthesize_placed(std::shared_ptr<const Sources> sources, const Grid& grid, const SynthesizeParams& params,
                              const Observer& observer, bool returns) {
  if (!are_from_behind(*sources)) return PlacedField(synthesize(*sources, grid, params, observer));
  SummedField sum = sum_where_chosen(*sources, grid, params, {true, returns}, observer);
  (sum.there ? sum.there->head : sum.field).label = sources->label;
  if (!sum.there) return PlacedField(std::move(sum.field));
  if (params.device.kind != DeviceKind::automatic) return PlacedField(std::move(*sum.there));
  const auto again = [sources, grid, params](const Observer& o) {
    SynthesizeParams on_processor = params;
    on_processor.device = {};
    return synthesize(*sources, grid, on_processor, o);
  };
  return PlacedField(std::move(*sum.there), again);
}

}  // namespace holotrace
