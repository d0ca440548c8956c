#include "holotrace/slm/encode/iterate/device_loops.h"

#include <fmt/format.h>

#include <complex>
#include <cstdint>
#include <vector>

namespace holotrace {
namespace {

constexpr const char* formulas =
#include "kernels/descent_kernel.h.inc"
    ;
constexpr const char* loops =
#include "kernels/descent.cl.inc"
    ;

constexpr int group = 64;

Kernel kernel(const char* name) { return {name, {formulas, loops}, fmt::format("-D GROUP={}", group)}; }

WorkSize over(size_t count) { return {(count + group - 1) / group, 1, group, 1}; }
WorkSize over(const Grid& pixels) { return {size_t(pixels.nx + group - 1) / group, size_t(pixels.ny), group, 1}; }
WorkSize rows_of(const DeviceTarget& target) { return {size_t(target.ny), 1, group, 1}; }

uint64_t floats_in(const DeviceBuffer& buffer) { return buffer.bytes() / sizeof(float); }

}  // namespace

DeviceTarget::DeviceTarget(Device& device, const Array2D<float>& amplitudes, const Array2D<float>& weights)
    : nx(amplitudes.nx), ny(amplitudes.ny) {
  amplitude = device.upload(amplitudes.values, "a target plane");
  if (weights.size() > 0) weight = device.upload(weights.values, "a target plane");
  sums = device.make_buffer(size_t(ny) * sizeof(std::complex<float>), "a target plane");
}

void pixel_means(Device& device, const Grid& pixels, const std::array<DeviceBuffer, 4>& power,
                 const DeviceBuffer& means) {
  device.run(kernel("pixel_means"), over(pixels),
             {int32_t(pixels.nx), int32_t(pixels.ny), power[0], power[1], power[2], power[3], means});
}

void add_power(Device& device, const SampledPower& sampled, const Grid& pixels, const DeviceBuffer& power) {
  device.run(kernel("add_power"), over(pixels),
             {int32_t(pixels.nx), int32_t(sampled.n), sampled.factor, int32_t(sampled.adds), sampled.v, power});
}

void multiply_pixels(Device& device, const Grid& pixels, int n, const DeviceBuffer& factor, const DeviceBuffer& v) {
  device.run(kernel("multiply_pixels"), over(pixels), {int32_t(pixels.nx), int32_t(n), factor, v});
}

void multiply_by_real(Device& device, const DeviceBuffer& factor, const DeviceBuffer& v) {
  const uint64_t count = floats_in(factor);
  device.run(kernel("multiply_by_real"), over(count), {count, factor, v});
}

ModulusSums fit_sums(Device& device, const DeviceTarget& target, const DeviceBuffer& power) {
  const bool has_weight = target.weight.bytes() > 0;
  device.run(kernel("sum_rows"), rows_of(target),
             {int32_t(target.nx), int32_t(has_weight), power, target.amplitude,
              has_weight ? target.weight : target.amplitude, target.sums});
  std::vector<std::complex<float>> rows(static_cast<size_t>(target.ny));
  device.read(target.sums, rows.data(), rows.size() * sizeof rows[0]);
  ModulusSums sums;
  for (const std::complex<float>& row : rows) {
    sums.cross += double(row.real());
    sums.square += double(row.imag());
  }
  return sums;
}

void take_residual(Device& device, const DeviceTarget& target, double scale, const DeviceBuffer& power) {
  const bool has_weight = target.weight.bytes() > 0;
  device.run(kernel("leave_residual"), rows_of(target),
             {int32_t(target.nx), int32_t(has_weight), float(scale), power, target.amplitude,
              has_weight ? target.weight : target.amplitude, target.sums});
}

namespace {

double sum_of_errors(Device& device, const DeviceTarget& target) {
  std::vector<float> rows(static_cast<size_t>(target.ny));
  device.read(target.sums, rows.data(), rows.size() * sizeof rows[0]);
  double sum = 0;
  for (const float row : rows) sum += double(row);
  return sum;
}

}  // namespace

double leave_residual(Device& device, const DeviceTarget& target, double scale, const DeviceBuffer& power) {
  take_residual(device, target, scale, power);
  return sum_of_errors(device, target);
}

double leave_residual_of_asked(Device& device, const DeviceTarget& target, double scale, const DeviceBuffer& asked,
                               const DeviceBuffer& power) {
  const bool has_weight = target.weight.bytes() > 0;
  device.run(kernel("leave_residual_of_asked"), rows_of(target),
             {int32_t(target.nx), int32_t(has_weight), float(scale), power, target.amplitude,
              has_weight ? target.weight : target.amplitude, asked, target.sums});
  return sum_of_errors(device, target);
}

void add_part(Device& device, const DeviceBuffer& from, float factor, bool adds, const DeviceBuffer& to) {
  const uint64_t count = floats_in(to);
  device.run(kernel("add_part"), over(count), {count, factor, int32_t(adds), from, to});
}

void add_and_make_unit_modulus(Device& device, const DeviceBuffer& step, const DeviceBuffer& u) {
  const uint64_t count = floats_in(u) / 2;
  device.run(kernel("add_and_make_unit_modulus"), over(count), {count, step, u});
}

void leave_phases(Device& device, float cycles_per_level, const DeviceBuffer& level, const DeviceBuffer& u) {
  const uint64_t count = floats_in(level);
  device.run(kernel("leave_phases"), over(count), {count, cycles_per_level, level, u});
}

void add_phase_slopes(Device& device, const PhaseSlopes& slopes, const DeviceBuffer& g, const DeviceBuffer& u,
                      const DeviceBuffer& slope) {
  const uint64_t count = floats_in(slope);
  device.run(kernel("add_phase_slopes"), over(count),
             {count, slopes.factor, int32_t(slopes.is_halfway), slopes.halfway, g, u, slope});
}

void clear(Device& device, const DeviceBuffer& values) {
  const uint64_t count = floats_in(values);
  device.run(kernel("clear"), over(count), {count, values});
}

void step_drives(Device& device, const AdamStep& adam, float turn, const DriveStep& step, const DeviceDrive& values) {
  const uint64_t count = floats_in(values.drive);
  device.run(kernel("step_drives"), over(count),
             {count, adam, turn, step.levels, step.hardness, values.slope, values.mean, values.square, values.drive,
              values.rounded});
}

}  // namespace holotrace
