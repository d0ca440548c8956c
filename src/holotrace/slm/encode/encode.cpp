#include "holotrace/slm/encode/encode.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdint>
#include <optional>
#include <thread>
#include <utility>

#include "holotrace/base/error.h"
#include "holotrace/base/units.h"
#include "holotrace/slm/encode/binary.h"
#include "holotrace/slm/encode/blank_hologram.h"
#include "holotrace/slm/encode/device_levels.h"
#include "holotrace/slm/encode/double_phase.h"
#include "holotrace/slm/encode/error_diffusion.h"
#include "holotrace/slm/encode/iterate/iterations.h"
#include "holotrace/slm/encode/kinoform.h"
#include "holotrace/slm/encode/off_axis.h"
#include "holotrace/slm/encode/phase_levels.h"
#include "holotrace/slm/encode/target.h"
#include "holotrace/slm/panel/checks.h"
#include "holotrace/wave/shared/cost_model.h"
#include "holotrace/wave/shared/device_rates.h"
#include "holotrace/wave/shared/fastest_device.h"
#include "holotrace/wave/shared/on_chosen_device.h"

namespace holotrace {
namespace {

// The encoders that treat each pixel by itself, on the processor or on a device.
template <class AnyField>
void encode_pixels(const ShownPixels<AnyField>& shown, Encoding method, const PhaseLevels& levels,
                   const Observer& observer, Hologram& hologram) {
  if (method == Encoding::phase) return encode_phase(shown, levels, hologram);
  if (method == Encoding::amplitude) return encode_amplitude(shown, observer, hologram);
  encode_complex(shown, levels, observer, hologram);
}

// A hologram of a field that was checked, and the levels of its panel.
struct Begun {
  Hologram hologram;
  PhaseLevels levels;
};

Begun begin_hologram(const Field& head, const Slm& slm, const EncodeParams& params, const Observer& observer) {
  Hologram hologram = blank_hologram(head, slm, params, observer);
  const Slm known = with_effects(slm, params.effects);
  PhaseLevels levels(known, hologram.levels, head.wavelength);
  if (hologram.modulation != Modulation::amplitude) tell_phase_range(known, levels.range(), head.wavelength, observer);
  return {std::move(hologram), std::move(levels)};
}

// Starts of the kernels and waiting for them, on slow drivers [s].
constexpr double seconds_to_start = 1e-3;

// The device that is expected to be the fastest: the field's way there counts, and that of the levels back.
Device* fastest_for_pixels(const PlacedField& field, Encoding method) {
  const double pixels = double(field.head().grid.pixels()), results = method == Encoding::complex ? 2 : 1;
  SummationWork work;
  work.samples = (1 + results) * pixels;
  const int threads = int(std::max(1U, std::thread::hardware_concurrency()));
  const double on_processor = predict_seconds(work, summation_rates(), threads);
  return fastest_device(field.seconds_to_processor() + on_processor, [&](Device& device) {
    const DeviceRates rates = device_rates(device);
    const double moved = (1 + results) * sizeof(std::complex<float>) * pixels;
    return field.seconds_to(device) + moved / rates.moved_bytes + results * sizeof(uint16_t) * pixels / rates.bytes +
           seconds_to_start;
  });
}

// Levels of a field on a device; none if its samples need a look by the processor, because not all of them are finite.
std::optional<Hologram> encode_there(const DeviceField& field, const Begun& begun, const EncodeParams& params,
                                     const Observer& observer) {
  const ModulusMoments moments = modulus_moments(field);
  if (!std::isfinite(moments.square)) return std::nullopt;
  Hologram hologram = begun.hologram;
  encode_pixels(ShownPixels<DeviceField>{field, moments, params.image == ImageSide::real_image}, params.method,
                begun.levels, observer, hologram);
  if (moments.largest == 0) warn_of_dark_field(observer);
  observer.fact("device", field.device->info().name);
  return hologram;
}

// The encoders that use the field on the panel alone.
void encode_directly(const Field& shown, const EncodeParams& params, const PhaseLevels& levels,
                     const Observer& observer, Hologram& hologram) {
  switch (params.method) {
    case Encoding::off_axis:
      return encode_off_axis(shown, params, observer, hologram);
    case Encoding::double_phase:
      return encode_double_phase(shown, levels, params, observer, hologram);
    case Encoding::error_diffusion:
      return encode_error_diffusion(shown, levels, params, observer, hologram);
    case Encoding::binary:
      return encode_binary(shown, levels, params, observer, hologram);
    default:
      fail("expected an encoding without iterations, got \"{}\"", name_of(params.method, encoding_names));
  }
}

}  // namespace

double short_range_efficiency(double range) {
  const double amplitude = range < 1 ? range + std::sin(pi * range) / pi : 1;
  return amplitude * amplitude;
}

Hologram encode(const PlacedField& field, const Slm& slm, const EncodeParams& params, const Observer& observer) {
  const Field& head = field.head();
  check_encode_params(slm, params);
  require_grid_of(slm, head.grid, "field");
  if (aims_at_targets(params.method)) {
    const auto here = field.on_processor(observer);
    Hologram found = encode_targets(targets_of(*here, params), *here, slm, params, observer);
    found.loses_by_cone = true;  // the targets are the field's own light
    return found;
  }
  check_encoding(slm, params, observer);
  const bool is_conjugate = params.image == ImageSide::real_image;
  const auto finished = [&](Hologram hologram) {
    observer.fact("illumination", Fact(hologram.illumination));
    observer.progress(1);
    return hologram;
  };
  check_head_to_show(head, slm, observer);
  Begun begun = begin_hologram(head, slm, params, observer);
  const bool has_table = begun.levels.has_table() && params.method != Encoding::amplitude;
  require(
      !has_table || params.device.kind != DeviceKind::opencl,
      "expected levels of even steps on an OpenCL device, got those of the calibration of \"{}\"; leave calibration "
      "out of [encode] effects, or use the device cpu",
      slm.name);
  if (is_of_single_pixels(params.method) && !has_table) {
    Observer of_faults;  // the device is told if it has encoded
    of_faults.on_warning = observer.on_warning;
    auto there = on_chosen_device(
        params.device, of_faults, [&] { return fastest_for_pixels(field, params.method); },
        [&](Device& device) { return encode_there(*field.on(device, observer), begun, params, observer); });
    if (there && *there) return finished(std::move(**there));
  }
  const auto here = field.on_processor(observer);
  check_samples_to_show(*here, observer);
  if (is_of_single_pixels(params.method))
    encode_pixels(ShownPixels<Field>{*here, modulus_moments(*here), is_conjugate}, params.method, begun.levels,
                  observer, begun.hologram);
  else if (is_conjugate)
    encode_directly(conjugate(*here), params, begun.levels, observer, begun.hologram);
  else
    encode_directly(*here, params, begun.levels, observer, begun.hologram);
  return finished(std::move(begun.hologram));
}

Hologram encode(const Field& field, const Slm& slm, const EncodeParams& params, const Observer& observer) {
  return encode(PlacedField::of(field), slm, params, observer);
}

}  // namespace holotrace
