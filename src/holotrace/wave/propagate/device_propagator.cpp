#include "holotrace/wave/propagate/device_propagator.h"

#include <algorithm>
#include <complex>

#include "holotrace/base/error.h"

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
    : device_(device), plan_(without_transfer(p)), transfer_columns_(p.transfer_columns()) {
  if (p.is_on_lattice()) {
    convolution_.emplace(device, p);
    return;
  }
  const auto lock = device_.lock();
  transfer_ = device_.make_buffer(size_t(p.transfer_rows()) * size_t(p.transfer_columns()) * sizeof(Complex),
                                  "a transfer function");
  device_.write(transfer_, p.transfer.values.data(), transfer_.bytes());
  windows_.emplace(device, p);
}

DevicePropagationCost device_propagation_cost(const Device& device, const Propagator<float>& plan) {
  return device_propagation_cost(device, plan, device.memory());
}

DevicePropagationCost device_propagation_cost(const Device& device, const Propagator<float>& plan, double memory) {
  Device counter(device.info(), memory);
  const auto make = [&](const Grid& grid) { return make_samples(counter, grid.ny, grid.nx); };
  DevicePropagator propagator(counter, plan);
  DevicePropagationCost cost;
  {
    const DeviceBuffer from = make(plan.input), to = make(plan.output);
    cost.fields = double(from.bytes() + to.bytes());
    propagator.run(from, to);
  }
  const DeviceUse use = counter.use();
  cost.kept = double(use.bytes_held);
  cost.work = double(use.most_held) - cost.kept;
  cost.largest = double(use.largest_buffer);
  cost.moved = double(use.bytes_moved);
  return cost;
}

DevicePropagator::Work DevicePropagator::make_work() {
  if (convolution_) return {convolution_->make_work()};
  const PropagationAxis& y = plan_.y;
  const double columns = plan_.x.frequencies();
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
  const PropagationAxis& y = plan_.y;
  const ColumnBand all{0, 0, plan_.x.frequencies()};
  windows_->enter(all, y.inputs, ends.from, work.rows);
  windows_->transpose(y.inputs, all.count, work.rows, work.columns);
  windows_->filter(all, {&transfer_, 0, 1, transfer_columns_}, work.columns, work.bins, work.filtered);
  device_.finish();
  observer.progress(0.5);
  windows_->transpose(all.count, y.outputs, work.filtered, work.rows);
  windows_->leave(all, y.outputs, false, work.rows, ends.to);
}

}  // namespace holotrace
