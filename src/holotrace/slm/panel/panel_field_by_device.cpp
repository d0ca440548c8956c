#include "holotrace/slm/panel/panel_field_by_device.h"

#include <algorithm>
#include <complex>
#include <limits>
#include <utility>
#include <vector>

#include "holotrace/base/array.h"
#include "holotrace/base/error.h"
#include "holotrace/base/units.h"
#include "holotrace/wave/shared/cost_model.h"
#include "holotrace/wave/shared/stage_on_device.h"

namespace holotrace {
namespace {

int part_of(int count, int parts) { return (count + parts - 1) / parts; }

// Rows of an array and the ones beside them; after the last row comes the first.
DeviceBuffer upload_rows(Device& device, const Array2D<float>& values, const PixelRows& rows) {
  const int count = rows.count + 2 * rows.halo;
  return device.upload<float>(size_t(count) * size_t(values.nx), "a panel", [&](float* to) {
    for (int j = 0; j < count; ++j) {
      const int row = ((rows.first - rows.halo + j) % values.ny + values.ny) % values.ny;
      to = std::copy_n(values.row(row), values.nx, to);
    }
  });
}

// Part by part, the light of a panel on a device, in memory that all parts use one after the other.
class PanelParts {
 public:
  PanelParts(Device& device, const PanelModel& model, int parts);

  int columns_at_once() const { return columns_; }
  DeviceBuffer light(const PanelModel::Pattern& pattern, const SampleColumns& columns);

 private:
  void make_memory();
  void leave_rows(const PanelModel::Pattern& pattern, const PixelRows& rows, const SampleColumns& columns);

  Device& device_;
  const PanelModel& model_;
  DevicePanel panel_;
  int rows_, columns_, halo_;
  DevicePanel::Memory memory_;
  std::vector<DeviceBuffer> terms_;  // along the columns, of all rows of pixels
};

PanelParts::PanelParts(Device& device, const PanelModel& model, int parts)
    : device_(device), model_(model), panel_(device, model, PanelMaps::in_bands) {
  const DevicePanel::Sizes& sizes = panel_.sizes();
  rows_ = part_of(sizes.ny, parts);
  columns_ = part_of(sizes.n * sizes.nx, parts);
  halo_ = parts > 1 ? sizes.halo : 0;
  make_memory();
}

void PanelParts::make_memory() {
  const DevicePanel::Sizes& sizes = panel_.sizes();
  const size_t rows = size_t(rows_), nx = size_t(sizes.nx), columns = size_t(columns_), ny = size_t(sizes.ny),
               n = size_t(sizes.n);
  const auto make = [&](size_t floats) { return device_.make_buffer(floats * sizeof(float), "a panel"); };
  const auto make_pixels = [&](DevicePanel::Memory::Pixels& values, size_t count) {
    values.cycles = make(count);
    if (sizes.has_amplitude) values.amplitudes = make(count);
  };
  make_pixels(memory_.pixels, (rows + 2 * size_t(halo_)) * nx);
  if (sizes.halo > 0) make_pixels(memory_.blurred, rows * nx);
  memory_.terms = make(2 * size_t(sizes.expansion.pairs()) * rows * nx);
  memory_.term = make(2 * n * rows * nx);
  memory_.rows = make(2 * rows * columns);
  memory_.turned = make(2 * n * ny * columns);
  if (n > 1) memory_.spread = make(2 * n * ny * columns);
  // If all rows are there, the terms are done one after the other.
  for (int q = 0; q < (rows_ < sizes.ny ? sizes.expansion.terms : 1); ++q) terms_.push_back(make(2 * ny * columns));
}

// With the last rows, the terms are complete and go on along the columns.
void PanelParts::leave_rows(const PanelModel::Pattern& pattern, const PixelRows& rows, const SampleColumns& columns) {
  const DeviceBuffer drive = upload_rows(device_, pattern.drive, rows);
  DeviceBuffer modulus;
  if (pattern.modulus) modulus = upload_rows(device_, *pattern.modulus, rows);
  const PixelMaps maps = DevicePanel::pixel_maps(device_, model_, rows);
  panel_.make_terms({drive, pattern.modulus ? &modulus : nullptr}, rows, maps, memory_);
  const bool is_last = rows.first + rows.count == panel_.sizes().ny;
  for (int q = 0; q < panel_.sizes().expansion.terms; ++q) {
    const DeviceBuffer& along = terms_[std::min(size_t(q), terms_.size() - 1)];
    panel_.spread_rows(q, rows, columns, memory_, along);
    if (is_last) panel_.spread_columns(q, columns, along, memory_);
  }
  device_.finish();  // before the rows are released
}

DeviceBuffer PanelParts::light(const PanelModel::Pattern& pattern, const SampleColumns& columns) {
  const DevicePanel::Sizes& sizes = panel_.sizes();
  for (int row = 0; row < sizes.ny; row += rows_)
    leave_rows(pattern, {row, std::min(rows_, sizes.ny - row), halo_}, columns);
  const SampleMaps maps = DevicePanel::sample_maps(device_, model_, columns);
  DeviceBuffer u = device_.make_buffer(
      size_t(sizes.n) * size_t(sizes.ny) * size_t(columns.count) * sizeof(std::complex<float>), "the light of a panel");
  panel_.finish(columns, maps, memory_, u);
  device_.finish();  // before the maps are released
  return u;
}

double field_bytes(const PanelModel& panel) { return double(panel.head().grid.pixels()) * sizeof(std::complex<float>); }

// The field, fetched band by band.
Field field_here(Device& device, const PanelModel& panel, const PanelModel::Pattern& pattern, int parts) {
  Field field = panel.head();
  field.samples = Array2D<std::complex<float>>(field.grid.ny, field.grid.nx);
  each_band_of_light(device, panel, pattern, parts, [&](const SampleColumns& columns, DeviceBuffer& u) {
    if (columns.count == field.grid.nx) {
      device.read(u, field.samples.values.data(), u.bytes());
      return true;
    }
    const auto part = device.fetch<std::complex<float>>(u);
    for (int j = 0; j < field.grid.ny; ++j)
      std::copy_n(part.data() + size_t(j) * size_t(columns.count), columns.count, field.samples.row(j) + columns.first);
    return true;
  });
  return field;
}

// The field on the device, of which a band is taken or copied.
class FieldThere {
 public:
  FieldThere(Device& device, const PanelModel& panel, int parts) : field_{&device, panel.head(), {}} {
    if (parts > 1) field_ = make_device_field(device, panel.head(), "the light of a panel");
  }
  void take(const SampleColumns& columns, DeviceBuffer& u) {
    if (columns.count == field_.head.grid.nx)
      field_.samples = std::move(u);
    else
      put(u, {columns.first, columns.first + columns.count, 0, field_.head.grid.ny}, field_);
  }
  DeviceField& field() { return field_; }

 private:
  DeviceField field_;
};

DeviceField field_there(Device& device, const PanelModel& panel, const PanelModel::Pattern& pattern, int parts) {
  FieldThere there(device, panel, parts);
  each_band_of_light(device, panel, pattern, parts, [&](const SampleColumns& columns, DeviceBuffer& u) {
    there.take(columns, u);
    return true;
  });
  return std::move(there.field());
}

// What compute(device, forecast) returns on the device of a choice, under its lock.
template <class Compute>
auto compute_where_chosen(const PanelModel& panel, const PanelModel::Pattern& pattern, const DeviceChoice& choice,
                          bool may_stay, const Observer& observer, const Compute& compute) {
  if (choice.kind != DeviceKind::cpu) panel.check_pattern(pattern.drive, pattern.modulus);
  const auto fastest = [&] {
    return fastest_device(processor_seconds(panel.work()), [&](Device& there) {
      const PanelForecast forecast = forecast_panel(there, panel, pattern, may_stay, possible_room(there));
      if (!forecast.fits) return std::numeric_limits<double>::infinity();
      return predict_seconds(forecast.use, device_rates(there));
    });
  };
  return on_chosen_device(choice, observer, fastest, [&](Device& device) {
    const auto lock = device.lock();
    const auto forecast_now = [&] { return forecast_panel(device, panel, pattern, may_stay, device.memory_left()); };
    PanelForecast forecast = forecast_now();
    if (forecast.parts > 1) {
      make_room(device, std::numeric_limits<double>::infinity());
      forecast = forecast_now();
    }
    require(
        forecast.fits,
        "expected memory for the smallest parts of a panel of {} × {} pixels on the device {}, got {} that are free; "
        "close other programs that use it, or use the device cpu",
        pattern.drive.nx, pattern.drive.ny, device.info().name, format_bytes(std::max(0.0, device.memory_left())));
    return compute(device, forecast);
  });
}

}  // namespace

void each_band_of_light(Device& device, const PanelModel& panel, const PanelModel::Pattern& pattern, int parts,
                        const std::function<bool(const SampleColumns& columns, DeviceBuffer& u)>& take) {
  const auto lock = device.lock();
  PanelParts there(device, panel, parts);
  const int width = panel.head().grid.nx;
  for (int first = 0; first < width; first += there.columns_at_once()) {
    const SampleColumns columns{first, std::min(there.columns_at_once(), width - first)};
    DeviceBuffer u = there.light(pattern, columns);
    const bool goes_on = take(columns, u);
    device.finish();  // before the light is released
    if (!goes_on) return;
  }
}

PanelForecast forecast_panel(const Device& device, const PanelModel& panel, const PanelModel::Pattern& pattern,
                             bool may_stay, double memory) {
  constexpr int enough_parts = 256;  // starting the kernels of more takes far longer than the processor does
  constexpr double usable = 0.9;     // of the memory: the rest is work space for long lines, which take what they get
  const Grid samples = panel.head().grid;
  PanelForecast forecast;
  for (;; forecast.parts += (forecast.parts + 1) / 2) {
    forecast.stays = may_stay && (forecast.parts == 1 || 2 * field_bytes(panel) <= memory);
    Device counter(device.info(), memory);
    const auto fits = [&] {
      forecast.use = counter.use();
      return double(forecast.use.most_held) <= usable * memory &&
             double(forecast.use.largest_buffer) <= device.info().largest_buffer;
    };
    {
      std::optional<FieldThere> there;
      if (forecast.stays) there.emplace(counter, panel, forecast.parts);
      each_band_of_light(counter, panel, pattern, forecast.parts, [&](const SampleColumns& columns, DeviceBuffer& u) {
        if (there)
          there->take(columns, u);
        else
          counter.read(u, nullptr, u.bytes());
        return fits();
      });
      if (there && fits()) power(there->field());
    }
    forecast.fits = fits();
    if (forecast.fits) return forecast;
    if (forecast.parts < std::min(std::max(samples.nx, samples.ny), enough_parts)) continue;
    return forecast.stays ? forecast_panel(device, panel, pattern, false, memory) : forecast;
  }
}

std::optional<Field> panel_field_by_device(const PanelModel& panel, const PanelModel::Pattern& pattern,
                                           const DeviceChoice& choice, const Observer& observer) {
  return compute_where_chosen(panel, pattern, choice, false, observer,
                              [&](Device& device, const PanelForecast& forecast) {
                                return field_here(device, panel, pattern, forecast.parts);
                              });
}

std::optional<PanelField> panel_field_on_device(const PanelModel& panel, const PanelModel::Pattern& pattern,
                                                const DeviceChoice& choice, const Observer& observer) {
  return compute_where_chosen(panel, pattern, choice, true, observer,
                              [&](Device& device, const PanelForecast& forecast) {
                                const auto with_power = [](auto field) {
                                  const double here = power(field);
                                  return PanelField{std::move(field), here};
                                };
                                return forecast.stays ? with_power(field_there(device, panel, pattern, forecast.parts))
                                                      : with_power(field_here(device, panel, pattern, forecast.parts));
                              });
}

}  // namespace holotrace
