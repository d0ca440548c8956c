#include "holotrace/slm/panel/panel_field_by_device.h"

#include <algorithm>
#include <complex>
#include <limits>
#include <thread>
#include <utility>
#include <vector>

#include "holotrace/slm/panel/banded_panel.h"
#include "holotrace/wave/shared/cost_model.h"
#include "holotrace/wave/shared/device_rates.h"
#include "holotrace/wave/shared/device_room.h"
#include "holotrace/wave/shared/fastest_device.h"
#include "holotrace/wave/shared/on_chosen_device.h"

namespace holotrace {
namespace {

// Starts of the kernels and waiting for them, on slow drivers [s].
constexpr double seconds_to_start = 1e-3;

// For the memory that there is once all that is kept there for later is dropped.
PanelBands plan_on(const Device& device, const PanelModel& panel) {
  return BandedPanel::plan(panel, possible_room(device), device.info().largest_buffer);
}

double field_bytes(const PanelModel& panel) { return double(panel.head().grid.pixels()) * sizeof(std::complex<float>); }

// The field, fetched column band by column band.
Field field_here(Device& device, const PanelModel& panel, const PanelPattern& pattern) {
  Field field = panel.head();
  field.samples = Array2D<std::complex<float>>(field.grid.ny, field.grid.nx);
  std::vector<std::complex<float>> part;
  BandedPanel(device, panel)
      .leave({pattern.drive, pattern.modulus}, [&](const SampleColumns& columns, DeviceBuffer& u) {
        if (columns.count == field.grid.nx) return device.read(u, field.samples.values.data(), u.bytes());
        part.resize(u.bytes() / sizeof part[0]);
        device.read(u, part.data(), u.bytes());
        for (int j = 0; j < field.grid.ny; ++j)
          std::copy_n(part.data() + size_t(j) * size_t(columns.count), columns.count,
                      field.samples.row(j) + columns.first);
      });
  return field;
}

// The field on the device.
DeviceField field_there(Device& device, const PanelModel& panel, const PanelPattern& pattern) {
  BandedPanel there(device, panel);
  DeviceField field{&device, panel.head(), {}};
  const bool is_whole = plan_on(device, panel).is_whole();
  if (!is_whole) field = make_device_field(device, panel.head(), "the light of a panel");
  there.leave({pattern.drive, pattern.modulus}, [&](const SampleColumns& columns, DeviceBuffer& u) {
    if (is_whole)
      field.samples = std::move(u);
    else
      put(u, {columns.first, columns.first + columns.count, 0, field.head.grid.ny}, field);
  });
  return field;
}

// Whether the field can stay: all of it is computed at once, or it takes half of the free memory at most, and bands of it are
// computed in the rest.
bool can_stay(const Device& device, const PanelModel& panel) {
  return plan_on(device, panel).is_whole() || 2 * field_bytes(panel) <= possible_room(device);
}

// What leave(device) returns on the device of a choice, under its lock. @param returns  whether it fetches the field
template <class Leave>
auto compute_where_chosen(const PanelModel& panel, const PanelPattern& pattern, const DeviceChoice& choice,
                          bool returns, const Observer& observer, const Leave& leave) {
  if (choice.kind != DeviceKind::cpu) panel.check_pattern(pattern.drive, pattern.modulus);
  const auto fastest = [&] {
    const PanelWork work = panel.work();
    const int threads = int(std::max(1U, std::thread::hardware_concurrency()));
    return fastest_device(predict_seconds(work.on_processor, summation_rates(), threads), [&](Device& there) {
      const DeviceRates rates = device_rates(there);
      const PanelBands bands = plan_on(there, panel);
      if (bands.rows == 0) return std::numeric_limits<double>::infinity();
      // Levels are sent, and rows transformed, once for each band of columns.
      const bool is_fetched = returns || !can_stay(there, panel);
      const double transfers = bands.column_bands * work.sent + (is_fetched ? work.fetched : 0);
      return bands.column_bands * work.moved / rates.moved_bytes + transfers / rates.bytes + seconds_to_start;
    });
  };
  return on_chosen_device(choice, observer, fastest, [&](Device& device) {
    const auto lock = device.lock();
    const PanelBands bands = BandedPanel::plan(panel, device.memory_left(), device.info().largest_buffer);
    if (!bands.is_whole()) make_room(device, std::numeric_limits<double>::infinity());
    return leave(device);
  });
}

}  // namespace

std::optional<Field> panel_field_by_device(const PanelModel& panel, const PanelPattern& pattern,
                                           const DeviceChoice& choice, const Observer& observer) {
  return compute_where_chosen(panel, pattern, choice, true, observer,
                              [&](Device& device) { return field_here(device, panel, pattern); });
}

std::optional<PanelField> panel_field_on_device(const PanelModel& panel, const PanelPattern& pattern,
                                                const DeviceChoice& choice, const Observer& observer) {
  return compute_where_chosen(panel, pattern, choice, false, observer, [&](Device& device) {
    const auto with_power = [](auto field) {
      const double here = power(field);
      return PanelField{std::move(field), here};
    };
    return can_stay(device, panel) ? with_power(field_there(device, panel, pattern))
                                   : with_power(field_here(device, panel, pattern));
  });
}

}  // namespace holotrace
