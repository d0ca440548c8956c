#include "holotrace/wave/propagate/propagation_cost.h"

#include <algorithm>
#include <thread>

#include "holotrace/wave/propagate/convolution_parts.h"
#include "holotrace/wave/propagate/window_sum.h"
#include "holotrace/wave/shared/cost_model.h"

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

}  // namespace

SummationWork propagation_work(const Propagator<float>& plan) {
  return plan.is_on_lattice() ? convolution_work(plan.x, plan.y) : window_work(plan.x, plan.y);
}

double seconds_to_propagate(const Propagator<float>& plan) {
  const int threads = int(std::max(1U, std::thread::hardware_concurrency()));
  return from_memory * predict_seconds(propagation_work(plan), summation_rates(), threads);
}

}  // namespace holotrace
