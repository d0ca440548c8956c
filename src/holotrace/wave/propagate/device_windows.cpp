#include "holotrace/wave/propagate/device_windows.h"

#include "holotrace/wave/propagate/window_sum.h"

namespace holotrace {

DeviceWindows::DeviceWindows(Device& device, const Propagator<float>& plan)
    : device_(device), x_(plan.x), y_(plan.y), lines_(device), to_x_(make_window(plan.x)), to_y_(make_window(plan.y)) {}

DeviceWindows::Window DeviceWindows::make_window(const PropagationAxis& axis) {
  const auto lock = device_.lock();
  const WindowSum<float> host(axis);
  Window window{device_.upload(host.enter(), "the factors of a propagation"),
                {},
                device_.upload(host.leave(), "the factors of a propagation"),
                host.length(),
                host.is_plain()};
  if (!host.is_plain()) window.chirp = device_.upload(host.chirp(), "the factors of a propagation");
  return window;
}

void DeviceWindows::enter(const ColumnBand& band, int rows, const DeviceBuffer& from, const DeviceBuffer& to) {
  lines_.run({x_.padded, FftDirection::forward, {x_.inputs}, {band.count, x_.first + band.first}}, rows, from, to);
}

void DeviceWindows::filter(const ColumnBand& band, const LineFactors& transfer, const DeviceBuffer& from,
                           const DeviceBuffer& bins, const DeviceBuffer& to) {
  lines_.run({y_.padded, FftDirection::forward, {y_.inputs}, {y_.frequencies(), y_.first, transfer}}, band.count, from,
             bins);
  sum(to_y_, y_, {0, 0, y_.frequencies()}, band.count, false, bins, to);
}

void DeviceWindows::leave(const ColumnBand& band, int rows, bool adds, const DeviceBuffer& from,
                          const DeviceBuffer& to) {
  sum(to_x_, x_, band, rows, adds, from, to);
}

void DeviceWindows::sum(const Window& window, const PropagationAxis& axis, const ColumnBand& frequencies, int lines,
                        bool adds, const DeviceBuffer& from, const DeviceBuffer& to) {
  LineTransform t{.length = window.length,
                  .direction = window.is_plain ? FftDirection::backward : FftDirection::forward,
                  .in = {frequencies.count,
                         frequencies.first + (window.is_plain ? axis.first : 0),
                         {.values = &window.enter, .offset = frequencies.first}},
                  .out = {axis.outputs, 0, {.values = &window.leave}},
                  .adds = adds};
  if (!window.is_plain) t.filter = {.values = &window.chirp};
  lines_.run(t, lines, from, to);
}

}  // namespace holotrace
