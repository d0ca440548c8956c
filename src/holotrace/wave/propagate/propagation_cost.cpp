#include "holotrace/wave/propagate/propagation_cost.h"

#include <algorithm>
#include <complex>
#include <numeric>
#include <set>
#include <thread>

#include "holotrace/wave/propagate/convolution_parts.h"
#include "holotrace/wave/propagate/window_sum.h"
#include "holotrace/wave/shared/cost_model.h"
#include "holotrace/wave/transform/line_transform.h"

namespace holotrace {
namespace {

constexpr double from_memory = 1.4;

SummationWork convolution_work(const PropagationAxis& x, const PropagationAxis& y) {
  SummationWork work;
  const double rows = double(y.inputs) + y.outputs;
  for (int part = 0; part < x.parts; ++part) {
    const double columns = part_frequencies(x, part).count;
    work.fft_operations +=
        rows * fft_operations(x.part_length()) + 2 * columns * y.parts * fft_operations(y.part_length());
    work.samples += double(y.inputs) * x.inputs + double(y.outputs) * x.outputs + rows * columns +
                    columns * y.parts * (rows + y.part_length());
  }
  return work;
}

double window_operations(const WindowLength& window) {
  return (window.is_plain ? 1 : 2) * fft_operations(window.length);
}

SummationWork window_work(const PropagationAxis& x, const PropagationAxis& y) {
  const double columns = x.frequencies();
  const WindowLength to_x = window_length(x), to_y = window_length(y);
  SummationWork work;
  work.fft_operations = y.inputs * fft_operations(x.padded) + columns * fft_operations(y.padded) +
                        columns * window_operations(to_y) + y.outputs * window_operations(to_x);
  work.samples = y.inputs * (double(x.inputs) + columns) + columns * (2.0 * y.frequencies() + to_y.length + y.outputs) +
                 y.outputs * (columns + to_x.length + x.outputs);
  return work;
}

// Of both axes, and of the lines' transforms, which share those of one length.
double samples_of_factors(const Propagator<float>& plan) {
  double samples = 0;
  std::set<int> lengths;
  for (const PropagationAxis* axis : {&plan.x, &plan.y}) {
    if (plan.is_on_lattice()) {
      samples += double(axis->parts) * (axis->inputs + axis->outputs);
      lengths.insert(axis->part_length());
      continue;
    }
    const WindowLength window = window_length(*axis);
    samples += double(axis->frequencies()) + (window.is_plain ? 0 : window.length) + axis->outputs;
    lengths.insert({axis->padded, window.length});
  }
  return std::accumulate(lengths.begin(), lengths.end(), samples);
}

double moved_samples(const Propagator<float>& plan) {
  const PropagationAxis &x = plan.x, &y = plan.y;
  const double in = double(x.inputs) * y.inputs, out = double(x.outputs) * y.outputs;
  if (!plan.is_on_lattice()) {
    const double columns = x.frequencies(), rows = y.frequencies();
    // Each array is written and read; the transposed ones twice.
    return in + columns * (4.0 * y.inputs + 3.0 * rows + 4.0 * y.outputs) + out;
  }
  const double parts = y.parts, added = 2 * parts - 1;  // a sum is read before each part but the first
  double samples = 0;
  for (int part = 0; part < x.parts; ++part) {
    const double of_column = (3 + parts) * y.inputs + y.padded + (added + 3) * y.outputs;
    samples += in + part_frequencies(x, part).count * of_column + (part == 0 ? out : 2 * out);
  }
  return samples;
}

}  // namespace

int columns_at_once(const Propagator<float>& plan) {
  if (!plan.is_on_lattice()) return plan.x.frequencies();
  int most = 1;
  for (int part = 0; part < plan.x.parts; ++part) most = std::max(most, part_frequencies(plan.x, part).count);
  return most;
}

SummationWork propagation_work(const Propagator<float>& plan) {
  return plan.is_on_lattice() ? convolution_work(plan.x, plan.y) : window_work(plan.x, plan.y);
}

double seconds_to_propagate(const Propagator<float>& plan) {
  const int threads = int(std::max(1U, std::thread::hardware_concurrency()));
  return from_memory * predict_seconds(propagation_work(plan), summation_rates(), threads);
}

double line_work_bytes(const Device& device, const Propagator<float>& plan) {
  const PropagationAxis &x = plan.x, &y = plan.y;
  const int columns = columns_at_once(plan), rows = std::max(y.inputs, y.outputs);
  const auto of = [&](int length, int lines) {
    return line_transform_bytes(device, length, lines) - sample_bytes * length;
  };
  if (plan.is_on_lattice()) return std::max(of(x.part_length(), rows), of(y.part_length(), columns));
  return std::max({of(x.padded, y.inputs), of(y.padded, columns), of(window_length(y).length, columns),
                   of(window_length(x).length, y.outputs)});
}

DevicePropagationCost device_propagation_cost(const Device& device, const Propagator<float>& plan) {
  const PropagationAxis &x = plan.x, &y = plan.y;
  const double columns = columns_at_once(plan);
  const double transfer = double(x.slots()) * (plan.is_on_lattice() ? y.padded : y.frequencies());
  const double spectrum = columns * (double(std::max(y.inputs, y.outputs)) + y.inputs + y.outputs +
                                     (plan.is_on_lattice() ? 0 : y.frequencies()));
  DevicePropagationCost cost;
  cost.fields = sample_bytes * (double(x.inputs) * y.inputs + double(x.outputs) * y.outputs);
  cost.kept = sample_bytes * (transfer + samples_of_factors(plan));
  cost.work = cost.fields + sample_bytes * spectrum + line_work_bytes(device, plan);
  const double rows = std::max(y.inputs, y.outputs), bins = plan.is_on_lattice() ? 0 : y.frequencies();
  cost.largest = sample_bytes * std::max({transfer, double(x.inputs) * y.inputs, double(x.outputs) * y.outputs,
                                          columns * std::max(rows, bins)});
  cost.moved = sample_bytes * moved_samples(plan);
  return cost;
}

}  // namespace holotrace
