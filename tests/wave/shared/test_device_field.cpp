// Fields on OpenCL devices: sums of long rows, and places beyond 2³¹ samples.

#include <cmath>
#include <cstdint>
#include <numeric>

#include "holotrace/base/random.h"
#include "holotrace/base/units.h"
#include "holotrace/wave/propagate/propagate_on_device.h"
#include "holotrace/wave/shared/compensated_sum_kernel.h"
#include "holotrace/wave/shared/device_field.h"
#include "holotrace/wave/shared/sample_place_kernel.h"
#include "support/devices.h"

namespace holotrace {
namespace {

constexpr const char* place_source =
#include "kernels/sample_place_kernel.h.inc"
    ;

class DeviceFields : public test::OnEveryDevice {};
HOLOTRACE_FOR_ALL_DEVICES(DeviceFields);

// A million terms: two roundings of a float, 2⁻²⁴ each, and a millionth of a million of them. A plain sum of equal terms is off
// by 1e-3.
TEST(CompensatedSum, IsExactToTwoRoundings) {
  CounterRandom random(3, 0, 0);
  for (const bool is_random : {false, true}) {
    CompensatedSum sum{0, 0};
    double exact = 0;
    for (int i = 0; i < 1'000'000; ++i) {
      const float term = is_random ? float(random.uniform()) : 0.1F;
      sum = with_term(sum, term);
      exact += double(term);
    }
    EXPECT_NEAR(sum.sum, exact, 2.1 * 0x1p-24 * exact) << is_random;
  }
}

// Each term is rounded three times, a sum of one of 64 items twice, and their sums six times: 11 · 2⁻²⁴ = 6.6e-7 at most. Equal
// samples are the worst case for plain sums, whose roundings then have one sign.
TEST_P(DeviceFields, KnowTheEnergyOfLongRowsToOneMillionth) {
  CounterRandom random(1, 0, 0);
  for (const int kind : {0, 1, 2}) {
    Field field({40'000, 3, 1e-6}, 532e-9);
    for (auto& u : field.samples.values) {
      u = {0.7F, 0.3F};
      if (kind == 1) u = {float(random.uniform()), float(random.uniform())};
    }
    if (kind == 2) field.samples.values[0] = 300;  // a bright one, and many that each add less than its rounding
    double sum = 0;
    for (const std::complex<float> u : field.samples.values) sum += std::norm(std::complex<double>(u));
    EXPECT_NEAR(energy(send(device_, field), {0, 40'000, 0, 3}), sum, 7e-7 * sum) << kind;
    EXPECT_NEAR(power(send(device_, field)), sum * 1e-12, 7e-7 * sum * 1e-12) << kind;
  }
}

TEST(SamplePlaces, ArePastTheLastInt) {
  EXPECT_EQ(sample_place(3, 2, 10), 23u);
  EXPECT_EQ(sample_place(5, 65'535, 65'536), (uint64_t(65'535) << 16) + 5);
  EXPECT_EQ(sample_place(INT32_MAX - 1, INT32_MAX - 1, INT32_MAX), uint64_t(INT32_MAX) * INT32_MAX - 1);
}

// The same in the language of devices: kernels of fields with 2³² samples find the last ones.
TEST_P(DeviceFields, HavePlacesPastTheLastInt) {
  constexpr const char* kernel_source =
      "__kernel void places(int first, int columns, __global ulong* to) {"
      "  to[get_global_id(0)] = sample_place(get_global_id(0), first + (int)get_global_id(0), columns);"
      "}";
  const auto lock = device_.lock();
  std::vector<uint64_t> found(8);
  const DeviceBuffer there = device_.make_buffer(found.size() * sizeof(uint64_t), "places");
  device_.run({"places", {place_source, kernel_source}}, {1, 1, found.size(), 1},
              {int32_t(65'528), int32_t(65'536), there});
  device_.read(there, found.data(), there.bytes());
  for (size_t i = 0; i < found.size(); ++i) EXPECT_EQ(found[i], (uint64_t(65'528 + i) << 16) + i);
}

// Work items of 65,537 columns and 70,000 rows: counted in 64 bits, and more than 2³².
TEST(SampleRows, HaveAnItemForEverySample) {
  const WorkSize size = items_of_rows(65'537, 70'000);
  EXPECT_EQ(size.group_x * size.group_y, samples_of_group);
  EXPECT_EQ(size.groups_x, 1025u);
  EXPECT_EQ(size.groups_y, 70'000u);
  EXPECT_GT(size.groups_x * size.group_x * size.groups_y, size_t(65'537) * 70'000 - 1);
  EXPECT_EQ(items_of_rows(64, 2).groups_x, 1u);
  EXPECT_EQ(items_of_rows(0, 2).groups_x, 0u);
}

// Rows that do not fill the last group, each sample once.
// 8 bytes for each sample of the box are read, and as many written.
TEST_P(DeviceFields, CountTheSamplesThatArePut) {
  Device counter(device_.info(), 1e9);
  DeviceField field = make_device_field(counter, Field({50, 40, 8e-6}, 532e-9));
  const DeviceBuffer box = counter.make_buffer(8 * 10 * 6, "a test");
  put(box, {3, 13, 7, 13}, field);
  EXPECT_EQ(counter.use().bytes_moved, 2u * 8 * 10 * 6);
}

TEST_P(DeviceFields, AreClearedAndSquaredSampleBySample) {
  for (const Grid& grid : {Grid{67, 5, 8e-6}, {1, 130, 8e-6}, {128, 1, 8e-6}}) {
    Field field(grid, 532e-9);
    for (size_t i = 0; i < field.samples.size(); ++i) field.samples.values[i] = {float(i + 1), -2};
    const size_t broken = device_.broken_guards();
    device_.guard_buffers(true);
    {
      DeviceField there = send(device_, field);
      const DeviceBuffer squares = irradiance_of(there);
      std::vector<float> irradiance(field.samples.size());
      device_.read(squares, irradiance.data(), squares.bytes());
      for (size_t i = 0; i < irradiance.size(); ++i) EXPECT_EQ(irradiance[i], float(i + 1) * float(i + 1) + 4) << i;
      clear(there);
      for (const std::complex<float> u : fetch(there).samples.values) EXPECT_EQ(u, std::complex<float>());
    }
    device_.guard_buffers(false);
    EXPECT_EQ(device_.broken_guards(), broken);
  }
}

}  // namespace
}  // namespace holotrace
