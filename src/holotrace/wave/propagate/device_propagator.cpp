#include "holotrace/wave/propagate/device_propagator.h"

#include <algorithm>
#include <complex>

#include "holotrace/base/error.h"
#include "holotrace/wave/propagate/window_sum.h"

namespace holotrace {
namespace {

using Complex = std::complex<float>;

DeviceBuffer make_samples(Device& device, double rows, double columns) {
  return device.make_buffer(size_t(rows * columns) * sizeof(Complex), "a propagation");
}

// Everything about a propagator but its large table.
Propagator<float> without_transfer(const Propagator<float>& p) {
  return {p.input, p.output, p.wavelength, p.distance, p.method, p.x, p.y, p.padded_nx, p.padded_ny, {}};
}

}  // namespace

// Buffers of a propagation: those of a convolution; or the spectrum row by row, and column by column before and after the
// transfer function.
struct DevicePropagator::Work {
  DeviceConvolution::Work of_convolution{};
  DeviceBuffer rows{}, columns{}, bins{}, filtered{};
};

DevicePropagator::DevicePropagator(Device& device, const Propagator<float>& p)
    : device_(device), plan_(without_transfer(p)), lines_(device), transfer_columns_(p.transfer.nx) {
  if (p.is_on_lattice()) {
    convolution_.emplace(device, p);
    return;
  }
  const auto lock = device_.lock();
  transfer_ = device_.make_buffer(p.transfer.size() * sizeof(Complex), "a transfer function");
  device_.write(transfer_, p.transfer.values.data(), transfer_.bytes());
  to_x_.push_back(make_window(p.x));
  to_y_.push_back(make_window(p.y));
}

DevicePropagator::Window DevicePropagator::make_window(const PropagationAxis& axis) {
  const WindowSum<float> host(axis);
  Window window{device_.upload(host.enter(), "the factors of a propagation"),
                {},
                device_.upload(host.leave(), "the factors of a propagation"),
                host.length(),
                host.is_plain()};
  if (!host.is_plain()) window.chirp = device_.upload(host.chirp(), "the factors of a propagation");
  return window;
}

DevicePropagator::Work DevicePropagator::make_work() {
  if (convolution_) return {convolution_->make_work()};
  const PropagationAxis& y = plan_.y;
  const double columns = columns_at_once(plan_);
  return {{},
          make_samples(device_, std::max(y.inputs, y.outputs), columns),
          make_samples(device_, y.inputs, columns),
          make_samples(device_, y.frequencies(), columns),
          make_samples(device_, y.outputs, columns)};
}

DeviceField DevicePropagator::operator()(const DeviceField& field, const Observer& observer) {
  check_field(field.head, plan_);
  require(field.device == &device_, "expected a field on the device {}, got one on {}", device_.info().name,
          field.device->info().name);
  const auto lock = device_.lock();
  DeviceField there =
      make_device_field(device_, head_on(field.head, plan_.output, field.head.z + plan_.distance), "a propagation");
  run({field.samples, there.samples}, make_work(), observer);
  observer.progress(1);
  return there;
}

Field DevicePropagator::operator()(const Field& field, const Observer& observer) {
  check_field(field, plan_);
  const auto lock = device_.lock();
  return fetch((*this)(send(device_, field, "a propagation"), observer));
}

void DevicePropagator::run(const DeviceBuffer& from, const DeviceBuffer& to, const Observer& observer) {
  const auto lock = device_.lock();
  run({from, to}, make_work(), observer);
}

void DevicePropagator::run(const Ends& ends, const Work& work, const Observer& observer) {
  if (convolution_)
    convolution_->to_many(ends.from, {{0, &ends.to}}, work.of_convolution, observer);
  else
    transform_to_window(ends, work, observer);
  device_.finish();
}

void DevicePropagator::transform_to_window(const Ends& ends, const Work& work, const Observer& observer) {
  const PropagationAxis &x = plan_.x, &y = plan_.y;
  const int columns = x.frequencies();
  lines_.run({x.padded, FftDirection::forward, {x.inputs}, {columns, x.first}}, y.inputs, ends.from, work.rows);
  lines_.transpose(y.inputs, columns, work.rows, work.columns);
  lines_.run(
      {y.padded, FftDirection::forward, {y.inputs}, {y.frequencies(), y.first, {&transfer_, 0, 1, transfer_columns_}}},
      columns, work.columns, work.bins);
  device_.finish();
  observer.progress(0.5);
  sum_window(to_y_.front(), y, columns, work.bins, work.filtered);
  lines_.transpose(columns, y.outputs, work.filtered, work.rows);
  sum_window(to_x_.front(), x, y.outputs, work.rows, ends.to);
}

void DevicePropagator::sum_window(const Window& window, const PropagationAxis& axis, int lines,
                                  const DeviceBuffer& from, const DeviceBuffer& to) {
  const LineEnd out{axis.outputs, 0, {&window.leave}};
  const int count = axis.frequencies();
  if (window.is_plain)
    lines_.run({window.length, FftDirection::backward, {count, axis.first, {&window.enter}}, out}, lines, from, to);
  else
    lines_.run({window.length, FftDirection::forward, {count, 0, {&window.enter}}, out, {&window.chirp}}, lines, from,
               to);
}

}  // namespace holotrace
