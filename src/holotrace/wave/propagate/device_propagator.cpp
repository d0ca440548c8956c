#include "holotrace/wave/propagate/device_propagator.h"

#include <algorithm>
#include <complex>
#include <utility>

#include "holotrace/base/error.h"
#include "holotrace/wave/propagate/convolve.h"
#include "holotrace/wave/propagate/window_transform.h"

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

DeviceUse forecast_propagation(const Device& device, const Propagator<float>& plan) {
  return forecast_propagation(device, plan, device.memory());
}

DeviceUse forecast_propagation(const Device& device, const Propagator<float>& plan, double memory) {
  Device counter(device.info(), memory);
  DevicePropagator propagator(counter, plan);
  {
    const auto make = [&](const Grid& grid) { return make_samples(counter, grid.ny, grid.nx); };
    const DeviceBuffer from = make(plan.input), to = make(plan.output);
    propagator.run(from, to);
  }
  return counter.use();
}

double bytes_of_fields(const Propagator<float>& plan) {
  return double(sizeof(Complex)) * double(plan.input.pixels() + plan.output.pixels());
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

namespace {

constexpr double sample_bytes = sizeof(Complex);  // of a field on a device

// Columns of each part of the spectrum.
std::vector<int> columns_of_parts(const Propagator<float>& plan) {
  if (!plan.is_on_lattice()) return {plan.x.frequencies()};
  std::vector<int> columns;
  for (int part = 0; part < plan.x.parts; ++part) columns.push_back(part_frequencies(plan.x, part).count);
  return columns;
}

// Whether a transform needs work space, because its lines are too long for local memory.
bool has_long_lines(const Device& device, const Propagator<float>& p) {
  const auto is_long = [&](int length) { return !is_held_line(device, length); };
  for (const PropagationAxis* axis : {&p.x, &p.y})
    if (p.is_on_lattice() ? is_long(axis->part_length())
                          : is_long(axis->padded) || is_long(window_length(*axis).length))
      return true;
  return false;
}

// Rows of `samples` each in these bytes.
int rows_within(double bytes, int samples, int rows) {
  return std::clamp(int(std::min(bytes / (sample_bytes * samples), 1e9)), 1, rows);
}

}  // namespace

// Buffers of a plan: rows of the fields; and of a band its transfer function, its spectrum row by row, and column by column
// before and after the transfer function, with the frequencies of a window of another pitch in between.
struct BandedPropagation::Work {
  DeviceBuffer from, to, transfer, rows, columns, bins, filtered;
};

struct BandedPropagation::Turn {
  const BandedPlan& plan;
  const Work& work;
  ColumnBand band;
  bool is_first, is_last;
};

BandedPlan plan_bands_of_spectrum(const Device& device, const Propagator<float>& p, double memory) {
  const PropagationAxis &x = p.x, &y = p.y;
  const double largest = device.info().largest_buffer;
  const double in = sample_bytes * x.inputs * y.inputs, out = sample_bytes * x.outputs * y.outputs;
  BandedPlan plan;
  plan.has_fields = in + out <= memory / 2 && std::max(in, out) <= largest;
  plan.rows_in = plan.has_fields ? y.inputs : rows_within(std::min(memory / 8, largest), x.inputs, y.inputs);
  plan.rows_out = plan.has_fields ? y.outputs : rows_within(std::min(memory / 8, largest), x.outputs, y.outputs);
  // Memory for bands: less the factors of transforms, and a half if lines are too long for local memory.
  const double factors = 4 * sample_bytes * (double(x.padded) + y.padded);
  const double rows = sample_bytes * (double(plan.rows_in) * x.inputs + double(plan.rows_out) * x.outputs);
  const double share = has_long_lines(device, p) ? 0.5 : 1;
  const double bins = p.is_on_lattice() ? 0 : y.frequencies(), transfer = p.transfer_columns();
  const double most_rows = std::max(plan.rows_in, plan.rows_out);
  const double column = most_rows + y.inputs + bins + y.outputs + transfer;
  const double longest = std::max({most_rows, double(y.inputs), bins, double(y.outputs), transfer});
  const double fits =
      std::min(share * (memory - rows - factors) / (sample_bytes * column), largest / (sample_bytes * longest));
  const std::vector<int> parts = columns_of_parts(p);
  plan.columns =
      std::clamp(int(std::clamp(fits, 1.0, 1e9)), 1, std::max(*std::max_element(parts.begin(), parts.end()), 1));
  for (size_t part = 0; part < parts.size(); ++part)
    for (int first = 0; first < parts[part]; first += plan.columns)
      plan.bands.push_back({part, first, std::min(plan.columns, parts[part] - first)});
  return plan;
}

BandedPropagation::BandedPropagation(Device& device, std::shared_ptr<const Propagator<float>> propagator)
    : device_(device), propagator_(std::move(propagator)), lines_(device) {
  if (propagator_->is_on_lattice())
    convolution_.emplace(device, *propagator_, std::vector<Vec2>{{0, 0}}, TransferFunction::in_bands);
  else
    windows_.emplace(device, *propagator_);
}

BandedPropagation::Work BandedPropagation::make_work(const BandedPlan& plan) {
  const PropagationAxis &x = propagator_->x, &y = propagator_->y;
  const auto make = [&](double samples) {
    return device_.make_buffer(size_t(samples) * sizeof(Complex), "a propagation");
  };
  const double columns = plan.columns;
  return {make(double(plan.rows_in) * x.inputs),
          make(double(plan.rows_out) * x.outputs),
          make(columns * propagator_->transfer_columns()),
          make(columns * std::max(plan.rows_in, plan.rows_out)),
          make(columns * y.inputs),
          make(windows_ ? columns * y.frequencies() : 0),
          make(columns * y.outputs)};
}

// The rows of the transfer function of a band's columns, one after the other.
void BandedPropagation::send_transfer(const Turn& turn) {
  const Array2D<Complex>& all = propagator_->transfer;
  const size_t bytes = size_t(turn.band.count) * size_t(propagator_->transfer_columns()) * sizeof(Complex);
  if (all.size() == 0) return device_.write(turn.work.transfer, nullptr, bytes);
  std::vector<Complex> some;
  some.reserve(size_t(turn.band.count) * size_t(all.nx));
  const auto append = [&](int row) { some.insert(some.end(), all.row(row), all.row(row) + all.nx); };
  if (convolution_)
    for (const int row : convolution_->transfer_rows(turn.band)) append(row);
  else
    for (int i = 0; i < turn.band.count; ++i) append(turn.band.first + i);
  device_.write(turn.work.transfer, some.data(), bytes);
}

void BandedPropagation::enter(const Field* field, const Turn& turn) {
  const auto& [plan, work, band, is_first, is_last] = turn;
  const PropagationAxis &x = propagator_->x, &y = propagator_->y;
  for (int row = 0; row < y.inputs; row += plan.rows_in) {
    const int rows = std::min(plan.rows_in, y.inputs - row);
    if (is_first || !plan.has_fields)
      device_.write(work.from, field ? field->samples.row(row) : nullptr,
                    size_t(rows) * size_t(x.inputs) * sizeof(Complex));
    if (convolution_)
      convolution_->enter(band, rows, work.from, work.rows);
    else
      windows_->enter(band, rows, work.from, work.rows);
    lines_.transpose(rows, band.count, work.rows, {}, work.columns, {y.inputs, row});
  }
}

void BandedPropagation::filter(const Turn& turn) {
  const Work& work = turn.work;
  const LineFactors transfer{&work.transfer, 0, 1, propagator_->transfer_columns(), 0};
  if (convolution_)
    convolution_->filter(turn.band, transfer, work.columns, work.filtered);
  else
    windows_->filter(turn.band, transfer, work.columns, work.bins, work.filtered);
}

void BandedPropagation::leave(const Turn& turn, Field* out) {
  const auto& [plan, work, band, is_first, is_last] = turn;
  const PropagationAxis &x = propagator_->x, &y = propagator_->y;
  for (int row = 0; row < y.outputs; row += plan.rows_out) {
    const int rows = std::min(plan.rows_out, y.outputs - row);
    const size_t bytes = size_t(rows) * size_t(x.outputs) * sizeof(Complex);
    lines_.transpose(band.count, rows, work.filtered, {y.outputs, row}, work.rows, {});
    Complex* const samples = out ? out->samples.row(row) : nullptr;
    if (!is_first && !plan.has_fields) device_.write(work.to, samples, bytes);
    if (convolution_)
      convolution_->leave(band, rows, !is_first, work.rows, work.to);
    else
      windows_->leave(band, rows, !is_first, work.rows, work.to);
    if (is_last || !plan.has_fields) device_.read(work.to, samples, bytes);
  }
}

Field BandedPropagation::operator()(const Field& field, const Observer& observer) {
  check_field(field, *propagator_);
  Field out(propagator_->output, field.wavelength, field.z + propagator_->distance);
  run(&field, &out, observer);
  copy_properties(field, out);
  return out;
}

void BandedPropagation::run(const Field* field, Field* out, const Observer& observer) {
  const auto lock = device_.lock();
  const BandedPlan plan = plan_bands_of_spectrum(device_, *propagator_, device_.memory_left());
  const Work work = make_work(plan);
  const size_t count = plan.bands.size();
  for (size_t b = 0; b < count; ++b) {
    const Turn turn{plan, work, plan.bands[b], b == 0, b + 1 == count};
    send_transfer(turn);
    enter(field, turn);
    filter(turn);
    leave(turn, out);
    device_.finish();
    observer.progress(double(b + 1) / double(count));
  }
}

DeviceUse forecast_banded_propagation(const Device& device, const Propagator<float>& plan, double memory) {
  Device counter(device.info(), memory);
  BandedPropagation(counter, std::make_shared<const Propagator<float>>(plan)).run(nullptr, nullptr);
  return counter.use();
}

}  // namespace holotrace
