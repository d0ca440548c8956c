// Transforms of lines on every OpenCL device, against those of the processor in double.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <complex>

#include "holotrace/base/fft.h"
#include "holotrace/base/random.h"
#include "holotrace/wave/transform/line_transform.h"
#include "support/devices.h"

namespace holotrace {
namespace {

using Line = std::vector<std::complex<float>>;

class DeviceTransforms : public test::OnEveryDevice {};

HOLOTRACE_FOR_ALL_DEVICES(DeviceTransforms);

Line drawn(size_t count, uint32_t seed) {
  CounterRandom random(seed, 0, 0);
  Line values(count);
  for (auto& v : values) v = {float(random.uniform() - 0.5), float(random.uniform() - 0.5)};
  return values;
}

// What run does, sample by sample in double; factors of line i start at |start + i·step|·stride + offset.
struct Expected {
  LineTransform t;
  Line enter, filter, leave, ramp{};

  std::complex<double> factor(const Line& values, const LineFactors& f, int line, int at) const {
    if (values.empty()) return 1;
    const std::complex<double> value(values[size_t(std::abs(f.start + line * f.step) * f.stride + f.offset + at)]);
    return f.is_conjugate ? std::conj(value) : value;
  }

  std::vector<std::complex<double>> operator()(const Line& from, int lines, const Line& before) const {
    std::vector<std::complex<double>> out;
    const FftDirection back = t.direction == FftDirection::forward ? FftDirection::backward : FftDirection::forward;
    for (int line = 0; line < lines; ++line) {
      std::vector<std::complex<double>> work(static_cast<size_t>(t.length));
      for (int n = 0; n < t.in.count; ++n)
        work[size_t(wrapped(n + t.in.shift, t.length))] +=
            std::complex<double>(from[size_t(line * t.in.count + n)]) * factor(enter, t.in.factors, line, n);
      Fft<double>(t.length, t.direction)(work.data());
      if (!filter.empty()) {
        for (int i = 0; i < t.length; ++i)
          work[size_t(i)] *= factor(filter, t.filter, line, i) * factor(ramp, t.ramp, line, i);
        Fft<double>(t.length, back)(work.data());
      }
      for (int o = 0; o < t.out.count; ++o)
        out.push_back(work[size_t(wrapped(o + t.out.shift, t.length))] * factor(leave, t.out.factors, line, o) +
                      (t.adds ? std::complex<double>(before[size_t(line * t.out.count + o)]) : 0));
    }
    return out;
  }
};

double error_of(const Line& found, const std::vector<std::complex<double>>& expected) {
  double error = 0, energy = 0;
  for (size_t i = 0; i < found.size(); ++i) {
    error += std::norm(std::complex<double>(found[i]) - expected[i]);
    energy += std::norm(expected[i]);
  }
  return std::sqrt(error / energy);
}

double error_on(Device& device, Expected expected, int lines) {
  const auto lock = device.lock();
  LineTransform& t = expected.t;
  const Line from = drawn(size_t(lines * t.in.count), 1), before = drawn(size_t(lines * t.out.count), 2);
  const auto upload = [&](const Line& values) { return device.upload(values.empty() ? Line(1) : values, "factors"); };
  const DeviceBuffer on_device = device.upload(from, "lines"), to = device.upload(before, "lines"),
                     enter = upload(expected.enter), filter = upload(expected.filter), leave = upload(expected.leave),
                     ramp = upload(expected.ramp);
  if (!expected.enter.empty()) t.in.factors.values = &enter;
  if (!expected.filter.empty()) t.filter.values = &filter;
  if (!expected.leave.empty()) t.out.factors.values = &leave;
  if (!expected.ramp.empty()) t.ramp.values = &ramp;
  LineTransforms(device).run(t, lines, on_device, to);
  Line found(before.size());
  device.read(to, found.data(), to.bytes());
  return error_of(found, expected(from, lines, before));
}

// A float is rounded by 3e-8 (rms); each of up to 12 passes adds a few such errors, in quadrature.
constexpr double rounding = 1e-6;

// Held lines of every group's size and with each factor first, last and repeated; long lines; other factors; primes.
TEST_P(DeviceTransforms, AreThoseOfTheProcessorForLengthsOfAnyFactors) {
  for (const int length : {1,    2,    3,    4,    5,    6,    8,    15, 64, 81,   240,  625, 1000,
                           1024, 1080, 1536, 2048, 3125, 3840, 4096, 7,  97, 1001, 4320, 8192})
    for (const FftDirection direction : {FftDirection::forward, FftDirection::backward})
      EXPECT_LT(error_on(device_, {{length, direction, {length}, {length}}, {}, {}, {}}, 2), rounding) << length;
}

// More samples enter and leave than a period has, at places that wrap around it.
TEST_P(DeviceTransforms, MultiplyAndShiftWhatEntersAndLeaves) {
  constexpr int lines = 7;
  for (const int length : {60, 77}) {  // held, and in global memory
    const LineFactors mirrored{nullptr, -3, 1, 200, 5}, alternate{nullptr, 1, 2, 200, 40};
    Expected expected{{length, FftDirection::forward, {91, -17, {}}, {83, 1000, alternate}, mirrored, true},
                      drawn(91, 3),
                      drawn(4 * 200, 4),
                      drawn(14 * 200, 5)};
    EXPECT_LT(error_on(device_, expected, lines), rounding) << length;
    expected.t.direction = FftDirection::backward;
    expected.t.adds = false;
    EXPECT_LT(error_on(device_, expected, lines), rounding) << length;
    expected.ramp = drawn(200, 6);  // the same for all lines
    expected.t.ramp = {nullptr, 0, 0, 0, 50};
    expected.t.filter.is_conjugate = expected.t.out.factors.is_conjugate = true;
    EXPECT_LT(error_on(device_, expected, lines), rounding) << length;
    expected.t.ramp.is_conjugate = expected.t.in.factors.is_conjugate = true;
    EXPECT_LT(error_on(device_, expected, lines), rounding) << length;
  }
}

TEST_P(DeviceTransforms, TransposeAnyNumberOfRowsAndColumns) {
  for (const auto& [rows, columns, matrices] :
       {std::array{1, 1, 1}, std::array{16, 16, 2}, std::array{37, 50, 3}, std::array{3, 129, 1}}) {
    const Line from = drawn(size_t(rows * columns * matrices), 6);
    const auto lock = device_.lock();
    const DeviceBuffer there = device_.upload(from, "lines"), to = device_.make_buffer(there.bytes(), "lines");
    LineTransforms(device_).transpose(rows, columns, there, to, matrices);
    Line found(from.size());
    device_.read(to, found.data(), to.bytes());
    for (int m = 0; m < matrices; ++m)
      for (int row = 0; row < rows; ++row)
        for (int column = 0; column < columns; ++column)
          ASSERT_EQ(found[size_t((m * columns + column) * rows + row)],
                    from[size_t((m * rows + row) * columns + column)]);
  }
}

TEST_P(DeviceTransforms, WriteNothingPastTheirBuffers) {
  const size_t before = device_.broken_guards();
  device_.guard_buffers(true);
  for (const int length : {75, 77}) error_on(device_, {{length, FftDirection::forward, {50}, {61, 30}}, {}, {}, {}}, 3);
  {
    const DeviceBuffer from = device_.upload(drawn(37 * 50, 6), "lines"),
                       to = device_.make_buffer(from.bytes(), "lines");
    LineTransforms(device_).transpose(37, 50, from, to);
    LineTransforms(device_).transpose(50, 37, from, to);
  }
  device_.guard_buffers(false);
  EXPECT_EQ(device_.broken_guards(), before);
}

}  // namespace
}  // namespace holotrace
