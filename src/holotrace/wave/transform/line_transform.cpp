#include "holotrace/wave/transform/line_transform.h"

#include <fmt/format.h>

#include <algorithm>
#include <complex>
#include <cstdint>
#include <cstdlib>
#include <utility>
#include <vector>

#include "holotrace/base/cycles.h"
#include "holotrace/base/error.h"

namespace holotrace {
namespace {

using Complex = std::complex<float>;

constexpr const char* source =
#include "kernels/line_transform.cl.inc"
    ;

constexpr int samples_of_item = 8, most_passes = 16, column_group = 64, tile = 16;
// Work space for lines in global memory: many lines keep a device busy.
constexpr double most_work = 64e6;

// As line_transform.cl declares them.
struct PlaceOnDevice {
  int32_t stride, offset, step;
};
struct FactorsOnDevice {
  int32_t is_used, start, step, is_mirrored, stride, offset, is_conjugate;
};
struct EndOnDevice {
  int32_t count, shift, stride;
  FactorsOnDevice factors;
};
struct LineJob {
  int32_t length, passes, first;
  float sign;
  int32_t has_second, adds;
  EndOnDevice in, out;
  FactorsOnDevice filter, ramp;
  int32_t radix[most_passes];
};

FactorsOnDevice on_device(const LineFactors& f) {
  return {f.values != nullptr, f.start, f.step, f.start < 0, f.stride, f.offset, f.is_conjugate};
}

EndOnDevice on_device(const LineEnd& end) { return {end.count, end.shift, end.count, on_device(end.factors)}; }

// 8 first: it has the fewest operations.
std::vector<int> factors_of(int length) {
  std::vector<int> factors;
  for (const int factor : {8, 4, 2, 5, 3})
    for (; length % factor == 0; length /= factor) factors.push_back(factor);
  for (int factor = 7; length > 1; factor += 2) {
    if (factor > length / factor) factor = length;
    for (; length % factor == 0; length /= factor) factors.push_back(factor);
  }
  return factors;
}

// The shortest line that a group can hold and that is long enough; 0 if none is.
int held_samples(const Device& device, int length) {
  for (int held = 1024; held <= 4096; held *= 2)
    if (held >= length && size_t(held / samples_of_item) <= device.info().largest_group &&
        double(held) * sizeof(Complex) <= device.info().local_memory)
      return held;
  return 0;
}

}  // namespace

bool is_held_line(const Device& device, int length) {
  const std::vector<int> factors = factors_of(length);
  return held_samples(device, length) > 0 && factors.size() <= size_t(most_passes) &&
         std::all_of(factors.begin(), factors.end(), [](int f) { return f <= 8 && f != 7; });
}

namespace {

// On a device that only counts memory may be used up; then their number does not matter.
int lines_at_once(const Device& device, int length, int lines) {
  if (device.memory_left() <= 0) return std::max(lines, 1);
  const double work = std::min(most_work, device.memory_left() / 2);
  return std::clamp(int(work / 2 / (double(length) * sizeof(Complex))), 1, std::max(lines, 1));
}

Kernel kernel_for(const char* name, int held) {
  return {name, {source}, fmt::format("-D HELD={} -D GROUP={}", held, held / samples_of_item)};
}

size_t tiles_of(int samples) { return size_t((samples + tile - 1) / tile); }

LineJob job_of(const LineTransform& t) {
  LineJob job{};
  job.length = t.length;
  job.sign = t.direction == FftDirection::forward ? -1 : 1;
  job.has_second = t.filter.values != nullptr;
  job.adds = t.adds;
  job.in = on_device(t.in);
  job.out = on_device(t.out);
  job.filter = on_device(t.filter);
  job.ramp = on_device(t.ramp);
  return job;
}

}  // namespace

const DeviceBuffer& LineTransforms::twiddles(int length) {
  const auto known = twiddles_.find(length);
  if (known != twiddles_.end()) return known->second;
  DeviceBuffer factors = device_.upload<Complex>(size_t(length), "the factors of a transform", [&](Complex* to) {
    for (int k = 0; k < length; ++k) to[k] = Complex(cis_cycles(double(k) / length));
  });
  return twiddles_.emplace(length, std::move(factors)).first->second;
}

void LineTransforms::run(const LineTransform& t, int lines, const DeviceBuffer& from, const DeviceBuffer& to) {
  require(t.length >= 1, "expected a transform of at least one sample, got {}", t.length);
  const DeviceBuffer& roots = twiddles(t.length);
  const auto or_none = [&](const LineFactors& f) {
    return f.values ? KernelArgument(*f.values) : KernelArgument::unused(roots);
  };
  const KernelArgument enter = or_none(t.in.factors), ramp = or_none(t.ramp), leave = or_none(t.out.factors);
  const std::vector<int> factors = factors_of(t.length);
  LineJob job = job_of(t);
  // What so many lines read and write.
  const auto entering = [&](int count) {
    return KernelArgument::moving(from, size_t(count) * size_t(t.in.count) * sizeof(Complex));
  };
  const auto leaving = [&](int count) {
    return KernelArgument::moving(to, size_t(count) * size_t(t.out.count) * sizeof(Complex) * (t.adds ? 2 : 1));
  };
  const auto filtering = [&](int count) {
    if (!t.filter.values) return KernelArgument::unused(roots);
    const size_t of_line = size_t(t.length) * sizeof(Complex);
    return KernelArgument::moving(*t.filter.values, of_line * (t.filter.step != 0 ? size_t(count) : 1));
  };
  if (is_held_line(device_, t.length)) {
    const int held = held_samples(device_, t.length);
    job.passes = int(factors.size());
    std::copy(factors.begin(), factors.end(), job.radix);
    device_.run(kernel_for("transform_lines", held), {size_t(lines), 1, size_t(held / samples_of_item), 1},
                {job, roots, entering(lines), enter, filtering(lines), ramp, leave, leaving(lines)});
    return;
  }
  const int most = lines_at_once(device_, t.length, lines);
  const size_t bytes = size_t(most) * size_t(t.length) * sizeof(Complex);
  DeviceBuffer work = device_.make_buffer(bytes, "a transform"), next = device_.make_buffer(bytes, "a transform");
  const auto transform = [&](const WorkSize& size, float sign) {
    int done = 1;
    for (const int factor : factors) {
      device_.run(kernel_for("pass_lines", 1024), size, {t.length, factor, done, sign, roots, work, next});
      std::swap(work, next);
      done *= factor;
    }
  };
  for (job.first = 0; job.first < lines; job.first += most) {
    const auto size_for = [&](int samples) {
      return WorkSize{size_t((samples + column_group - 1) / column_group), size_t(std::min(most, lines - job.first)),
                      size_t(column_group), 1};
    };
    const WorkSize size = size_for(t.length);
    const int count = std::min(most, lines - job.first);
    device_.run(kernel_for("enter_lines", 1024), size, {job, entering(count), enter, work});
    transform(size, job.sign);
    if (job.has_second) {
      device_.run(kernel_for("filter_lines", 1024), size, {job, filtering(count), ramp, KernelArgument::changed(work)});
      transform(size, -job.sign);
    }
    device_.run(kernel_for("leave_lines", 1024), size_for(t.out.count), {job, work, leave, leaving(count)});
  }
  device_.finish();  // before the work space is released
}

void LineTransforms::transpose(int rows, int columns, const DeviceBuffer& from, const DeviceBuffer& to, int matrices) {
  const int step = matrices > 1 ? rows * columns : 0;
  const PlaceOnDevice source{columns, 0, step}, target{rows, 0, step};
  const size_t bytes = size_t(rows) * size_t(columns) * size_t(matrices) * sizeof(Complex);
  device_.run(kernel_for("transpose_lines", 1024),
              {tiles_of(columns), tiles_of(rows), size_t(tile), size_t(tile), size_t(matrices)},
              {rows, columns, source, target, KernelArgument::moving(from, bytes), KernelArgument::moving(to, bytes)});
}

void LineTransforms::transpose(int rows, int columns, const DeviceBuffer& from, const MatrixPlace& source,
                               const DeviceBuffer& to, const MatrixPlace& target) {
  const PlaceOnDevice there{source.stride > 0 ? source.stride : columns, source.offset, 0},
      here{target.stride > 0 ? target.stride : rows, target.offset, 0};
  const size_t bytes = size_t(rows) * size_t(columns) * sizeof(Complex);
  device_.run(kernel_for("transpose_lines", 1024), {tiles_of(columns), tiles_of(rows), size_t(tile), size_t(tile)},
              {rows, columns, there, here, KernelArgument::moving(from, bytes), KernelArgument::moving(to, bytes)});
}

}  // namespace holotrace
