#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>
#include <vector>

#include "holotrace/slm/encode/shown_pixels.h"
#include "holotrace/wave/shared/device_field.h"

namespace holotrace {
namespace {

constexpr const char* place_source =
#include "kernels/sample_place_kernel.h.inc"
    ;
constexpr const char* sum_source =
#include "kernels/compensated_sum_kernel.h.inc"
    ;
constexpr const char* moduli_source =
#include "kernels/moduli.cl.inc"
    ;

constexpr int most_groups = 512;  // that count moduli: each adds its counts to those of all

Kernel kernel_of_moduli(const char* name, int steps = 1) {
  return {
      name, {place_source, sum_source, moduli_source}, fmt::format("-D GROUP={} -D STEPS={}", samples_of_group, steps)};
}

// The largest absolute value of a part of a sample; not finite if one is not.
double largest_part(const DeviceField& field) {
  Device& device = *field.device;
  const Grid& grid = field.head.grid;
  const DeviceBuffer there = device.make_buffer(size_t(grid.ny) * sizeof(uint32_t), "the moments of a field");
  device.run(kernel_of_moduli("row_peaks"), groups_of_rows(grid.ny), {field.samples, int32_t(grid.nx), there});
  const auto rows = device.fetch<float>(there);  // bits have the order of the numbers
  const auto is_less = [](float a, float b) { return std::bit_cast<uint32_t>(a) < std::bit_cast<uint32_t>(b); };
  return rows.empty() ? 0 : double(*std::max_element(rows.begin(), rows.end(), is_less));
}

}  // namespace

float unit_for(double largest) {
  return largest > 0 ? std::ldexp(1.0F, std::clamp(-std::ilogb(largest), -126, 126)) : 1.0F;
}

ModulusMoments modulus_moments(const DeviceField& field) {
  Device& device = *field.device;
  const auto lock = device.lock();
  const Grid& grid = field.head.grid;
  const double part = largest_part(field);
  if (!std::isfinite(part)) return {part, part, part};
  const float unit = unit_for(part);
  const DeviceBuffer there = device.make_buffer(3 * size_t(grid.ny) * sizeof(float), "the moments of a field");
  device.run(kernel_of_moduli("row_moments"), groups_of_rows(grid.ny), {field.samples, int32_t(grid.nx), unit, there});
  const auto rows = device.fetch<float>(there);
  ModulusMoments moments;
  for (size_t row = 0; row < rows.size(); row += 3) {
    moments.largest = std::max(moments.largest, double(rows[row]));
    moments.sum += double(rows[row + 1]);
    moments.square += double(rows[row + 2]);
  }
  moments.largest /= double(unit);
  moments.sum /= double(unit);
  moments.square /= double(unit) * double(unit);
  return moments;
}

std::vector<int64_t> count_moduli(const DeviceField& field, double largest, int steps, int64_t at_once) {
  Device& device = *field.device;
  const auto lock = device.lock();
  const Grid& grid = field.head.grid;
  const std::vector<uint32_t> none(size_t(steps) + 1);
  std::vector<int64_t> counts(none.size());
  const DeviceBuffer there = device.make_buffer(none.size() * sizeof(uint32_t), "the moments of a field");
  const int64_t most_rows = std::max(at_once / std::max(grid.nx, 1), int64_t(1));
  int rows = 0;
  for (int first = 0; first < grid.ny; first += rows) {
    rows = int(std::min(most_rows, int64_t(grid.ny - first)));
    device.write(there, none.data(), there.bytes());
    const int groups = std::min(rows, most_groups);
    device.run(kernel_of_moduli("count_moduli", steps), groups_of_rows(groups),
               {field.samples, int32_t(grid.nx), int32_t(first), int32_t(rows), int32_t(groups), float(steps / largest),
                there});
    const auto some = device.fetch<uint32_t>(there);
    for (size_t step = 0; step < some.size(); ++step) counts[step] += some[step];
  }
  return counts;
}

double clip_moduli(const DeviceField& field, double top) {
  Device& device = *field.device;
  const auto lock = device.lock();
  const Grid& grid = field.head.grid;
  const DeviceBuffer there = device.make_buffer(size_t(grid.ny) * sizeof(float), "the moments of a field");
  device.run(kernel_of_moduli("clip_moduli"), groups_of_rows(grid.ny),
             {KernelArgument::changed(field.samples), int32_t(grid.nx), float(top), there});
  const auto rows = device.fetch<float>(there);
  return std::accumulate(rows.begin(), rows.end(), 0.0);
}

ModulusMoments modulus_moments(const DeviceSamples& field) {
  ModulusMoments all;
  each_band(field, [&](const DeviceField& band, int) {
    const ModulusMoments of_band = modulus_moments(band);
    // std::max(a, b) is a if a is not a number.
    all.largest = std::isfinite(of_band.largest) ? std::max(all.largest, of_band.largest) : of_band.largest;
    all.sum += of_band.sum;
    all.square += of_band.square;
  });
  return all;
}

std::vector<int64_t> count_moduli(const DeviceSamples& field, double largest, int steps) {
  std::vector<int64_t> counts(size_t(steps) + 1);
  each_band(field, [&](const DeviceField& band, int) {
    const std::vector<int64_t> of_band = count_moduli(band, largest, steps);
    for (size_t step = 0; step < counts.size(); ++step) counts[step] += of_band[step];
  });
  return counts;
}

double clip_moduli(DeviceSamples& field, double top) {
  double clipped = 0;
  each_band(field, [&](const DeviceField& band, int) { clipped += clip_moduli(band, top); });
  field.top = top;
  return clipped;
}

}  // namespace holotrace
