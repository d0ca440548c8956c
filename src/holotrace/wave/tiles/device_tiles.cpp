#include "holotrace/wave/tiles/device_tiles.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "holotrace/base/own_threads.h"
#include "holotrace/base/threads.h"
#include "holotrace/wave/tiles/device_wave.h"

namespace holotrace {
namespace {

constexpr const char* factor_source =
#include "kernels/tile_factor_kernel.h.inc"
    ;
constexpr const char* sum_source =
#include "kernels/tile_sum.cl.inc"
    ;

// From fast to accurate: the neglected phase grows with columns · rows.
constexpr std::array<TileShape, 8> device_shapes{
    {{128, 64}, {64, 64}, {64, 32}, {32, 32}, {32, 16}, {16, 16}, {16, 8}, {16, 4}}};

constexpr int block_columns = 4;
// Enough work items for a device's unit of 32 or 64, and blocks as large as its registers hold.
int block_rows(TileShape shape) { return std::clamp(shape.columns * shape.rows / (block_columns * 32), 1, 8); }

int group_size(TileShape shape) { return shape.columns * shape.rows / (block_columns * block_rows(shape)); }

// Factors of a batch take at most 24 KiB of local memory; every device has 32 KiB, which also holds the waves.
int batch_of(TileShape shape) {
  return std::clamp(24 * 1024 / (3 * int(sizeof(float)) * (shape.columns + shape.rows)) / 8 * 8, 8, 32);
}

// Waves whose sums the kernel keeps in registers, at most.
constexpr size_t most_share = 4096;
// Samples of a launch at most. It then takes milliseconds on a fast card and tenths of a second on a slow one, whose screen
// must not freeze.
constexpr double most_samples = 4e6;
// Groups for each unit of a device that keep it busy: several at once, and few idle at the end.
constexpr size_t groups_per_unit = 8;

// As tile_sum.cl declares it.
struct TileJob {
  int32_t first, end, share, columns, rows, top, is_first;
  float pitch;
};

// Places of tile centres along an axis [wavelengths], for tiles that start every `step` pixels.
template <class Place>
std::vector<FloatPair> tile_centres(int pixels, int step, double wavelength, const Place& place) {
  std::vector<FloatPair> centres;
  for (int at = 0; at < pixels; at += step) centres.push_back(float_pair(place(at + (step - 1) / 2.0) / wavelength));
  return centres;
}

size_t tiles_along(int pixels, int step) { return size_t((pixels + step - 1) / step); }

std::vector<DeviceWave> device_waves(PreparedWaves waves, double wavelength, const PixelBox& bounds) {
  std::vector<DeviceWave> converted(waves.size());
  parallel_for(
      0, int64_t(waves.size()),
      [&](int64_t i) { converted[size_t(i)] = device_wave(waves[size_t(i)], wavelength, bounds); }, {}, 4096);
  return converted;
}

// Fetches a band of samples to the rows of the field.
void fetch(Device& device, const DeviceBuffer& sums, const PixelBox& band, Array2D<std::complex<float>>& samples) {
  const size_t columns = size_t(band.x1 - band.x0), count = size_t(band.pixels());
  constexpr size_t bytes = sizeof(std::complex<float>);
  if (columns == size_t(samples.nx)) return device.read(sums, samples.row(band.y0), count * bytes);
  std::vector<std::complex<float>> rows(count);
  device.read(sums, rows.data(), count * bytes);
  for (int j = band.y0; j < band.y1; ++j)
    std::copy_n(rows.data() + size_t(j - band.y0) * columns, columns, samples.row(j) + band.x0);
}

// How a sum is shared out. Which waves are added up in which order depends on the waves, the bounds and the device, and not
// on its memory: so the bytes do not either.
struct DevicePlan {
  size_t slices = 1, share = 0;  // slices of the waves of a launch, each of `share` waves
  int rows = 0;                  // of a band
  size_t waves = 0;              // that are on the device at once, a multiple of those of a launch

  size_t launch() const { return slices * share; }
};

// `rows_to_do` rows of the bounds are computed, `beside` other light, which needs memory of the device, too.
DevicePlan make_plan(const Device& device, size_t waves, const PixelBox& bounds, TileShape shape, int rows_to_do,
                     const LightOnDevice& beside, int block) {
  DevicePlan plan;
  const size_t tiles =
      tiles_along(bounds.x1 - bounds.x0, shape.columns) * tiles_along(bounds.y1 - bounds.y0, shape.rows);
  const size_t wanted = size_t(device.info().compute_units) * groups_per_unit;
  constexpr size_t least_share = 512, step = 256;  // multiples of every group
  plan.slices = std::clamp<size_t>((wanted + tiles - 1) / tiles, 1, std::max<size_t>(waves / least_share, 1));
  // Even shares in all launches.
  const auto parts_of = [](size_t count, size_t part) { return (count + part - 1) / part; };
  const size_t launches = parts_of(waves, plan.slices * most_share);
  plan.share = parts_of(parts_of(waves, launches * plan.slices), step) * step;
  plan.slices = std::min(plan.slices, parts_of(waves, plan.share));

  constexpr double spare = 1e5;  // for the places of tiles
  const double free = std::min(device.memory_left() - beside.bytes, device.info().largest_buffer) - spare;
  const double columns = bounds.x1 - bounds.x0, rows = rows_to_do;
  const double row_bytes = double(sizeof(std::complex<float>) * plan.slices) * columns;
  const double all_waves = double(sizeof(DeviceWave) * waves);
  const double for_waves = std::max(0.0, std::min(all_waves, std::max(free / 2, free - row_bytes * rows)));
  const double band = std::min((free - for_waves) / row_bytes, most_samples / columns);
  plan.rows = band >= rows ? rows_to_do : rows_of_band(band, shape, block);
  const size_t launch = std::max(plan.launch(), size_t(1));
  plan.waves = std::max(size_t(for_waves) / sizeof(DeviceWave) / launch, size_t(1)) * launch;
  if (all_waves <= for_waves) plan.waves = waves;
  return plan;
}

// Adds up the slices of a band.
void add_slices(Device& device, TileShape shape, const DeviceBuffer& sums, const PixelBox& band, size_t slices) {
  if (slices == 1) return;
  constexpr size_t group = 64;
  const int columns = band.x1 - band.x0, rows = band.y1 - band.y0;
  device.run(tile_kernel(shape, "add_slices"), {tiles_along(columns, int(group)), size_t(rows), group, 1},
             {sums, int32_t(columns), int32_t(rows), int32_t(slices)});
}

// What all devices of a sum share. `take` gets each band of rows, whose sums are on its device.
struct TileSum {
  std::vector<DeviceWave> waves;  // converted once for all devices
  const LitGrid& panel;
  TileShape shape;
  PixelBox bounds;
  std::function<void(Device& device, const PixelBox& band, const DeviceBuffer& sums)> take;
};

// Computes the rows [first_row, end_row) of the bounds, band by band.
void sum_rows(Device& device, const TileSum& sum, int first_row, int end_row, const LightOnDevice& more, int block,
              const Observer& observer, const std::atomic<bool>& is_stopped) {
  const std::vector<DeviceWave>& waves = sum.waves;
  const Grid& grid = sum.panel.grid;
  const double wavelength = sum.panel.wavelength;
  const TileShape shape = sum.shape;
  const PixelBox& bounds = sum.bounds;
  const auto lock = device.lock();
  const int columns = bounds.x1 - bounds.x0;
  const size_t count = std::max<size_t>(waves.size(), 1);  // without waves, a launch sets the samples to 0
  // Bands of whole blocks end with blocks only if the first starts with one.
  const int step = (first_row - bounds.y0) % block == 0 ? block : 1;
  const DevicePlan plan = make_plan(device, count, bounds, shape, end_row - first_row, more, step);
  const DeviceBuffer column_centres =
      device.upload(tile_centres(columns, shape.columns, wavelength, [&](double i) { return grid.x(bounds.x0 + i); }),
                    "places of tiles");
  const Kernel kernel = tile_kernel(shape, "sum_tiles");
  DeviceBuffer on_device;
  const int bands = (end_row - first_row + plan.rows - 1) / plan.rows;
  for (int b = 0; b < bands && !is_stopped; ++b) {
    const int top = first_row + b * plan.rows, rows = std::min(plan.rows, end_row - top);
    const Observer of_band = part_of(observer, b, bands), of_waves = part_of(of_band, 0, more.add ? 2 : 1);
    const DeviceBuffer row_centres = device.upload(
        tile_centres(rows, shape.rows, wavelength, [&](double j) { return grid.y(top + j); }), "places of tiles");
    const PixelBox band{bounds.x0, bounds.x1, top, top + rows};
    const DeviceBuffer sums =
        device.make_buffer(sizeof(std::complex<float>) * size_t(band.pixels()) * plan.slices, "a field");
    for (size_t part = 0; part < count; part += plan.waves) {
      const size_t end = std::min(part + plan.waves, count);
      if (b == 0 || plan.waves < count) {
        on_device = DeviceBuffer();  // released before the next is made
        const size_t bytes = sizeof(DeviceWave) * (std::min(end, waves.size()) - part);
        on_device = device.make_buffer(std::max(bytes, sizeof(DeviceWave)), "the waves");
        if (bytes > 0) device.write(on_device, waves.data() + part, bytes);
      }
      for (size_t first = part; first < end; first += plan.launch()) {
        const size_t last = std::min({first + plan.launch(), end, waves.size()});
        const TileJob job{int32_t(first - part), int32_t(last - part), int32_t(plan.share),           columns, rows,
                          top - bounds.y0,       first == 0,           float(grid.pitch / wavelength)};
        device.run(kernel,
                   {tiles_along(columns, shape.columns), tiles_along(rows, shape.rows),
                    size_t(shape.columns / block_columns), size_t(shape.rows / block_rows(shape)), plan.slices},
                   {on_device, column_centres, row_centres, job, sums});
        device.finish();
        if (is_stopped) return;
        of_waves.progress(double(std::min(first + plan.launch(), end)) / double(count));
      }
    }
    add_slices(device, shape, sums, band, plan.slices);
    if (more.add) more.add(band, sums, part_of(of_band, 1, 2), is_stopped);
    if (is_stopped) return;
    sum.take(device, band, sums);
  }
}

void sum_on_devices(const std::vector<Device*>& devices, const TileSum& sum, const Observer& observer,
                    const MoreLight& more) {
  const PixelBox& bounds = sum.bounds;
  const int share = rows_of_share(bounds.y1 - bounds.y0, devices.size(), sum.shape, more.rows);
  run_together(int(devices.size()), [&](int i, const std::atomic<bool>& is_stopped) {
    const int first = bounds.y0 + i * share, end = std::min(first + share, bounds.y1);
    if (first >= end) return;
    Device& device = *devices[size_t(i)];
    const LightOnDevice light = more.make ? more.make(device) : LightOnDevice();
    // All devices have about the same number of rows, so the progress of one is that of all.
    sum_rows(device, sum, first, end, light, more.rows, i == 0 ? observer : Observer(), is_stopped);
  });
}

}  // namespace

int rows_of_band(double most, TileShape shape, int block) {
  const int both = std::lcm(shape.rows, block), step = most >= both ? both : shape.rows;
  return std::max(int(std::min(most, 1e9)) / step, 1) * step;
}

namespace {

int share_of(int rows, size_t devices, int step) {
  const size_t steps = tiles_along(rows, step);
  return int((steps + devices - 1) / devices) * step;
}

// A share that starts or ends inside a block computes the whole of it.
int rows_computed(int rows, int share, int block) {
  int most = 0;
  for (int first = 0; first < rows; first += share) {
    const int end = std::min(int(tiles_along(std::min(first + share, rows), block)) * block, rows);
    most = std::max(most, end - first / block * block);
  }
  return most;
}

}  // namespace

int rows_of_share(int rows, size_t devices, TileShape shape, int block) {
  const int by_tiles = share_of(rows, devices, shape.rows);
  const int by_both = share_of(rows, devices, std::lcm(shape.rows, block));
  return rows_computed(rows, by_both, block) < rows_computed(rows, by_tiles, block) ? by_both : by_tiles;
}

int rows_computed_by_one(int rows, size_t devices, TileShape shape, int block) {
  return rows_computed(rows, rows_of_share(rows, devices, shape, block), block);
}

const char* tile_factor_source() { return factor_source; }

Kernel tile_kernel(TileShape shape, const char* function) {
  return {function,
          {factor_source, sum_source},
          fmt::format("-D TILE_COLUMNS={} -D TILE_ROWS={} -D BLOCK_ROWS={} -D BATCH={}", shape.columns, shape.rows,
                      block_rows(shape), batch_of(shape))};
}

double transferred_bytes(size_t waves, const PixelBox& bounds) {
  return double(sizeof(DeviceWave)) * double(waves) + double(sizeof(std::complex<float>)) * double(bounds.pixels());
}

double multiply_adds_per_wave_pixel(TileShape shape) {
  // Counted in tile_factor_kernel.h and tile_sum.cl, a division or a root as 4.
  const double factor = 38, wave = 190 + 2.0 * group_size(shape), pixels = double(shape.columns) * shape.rows;
  return 3 + (factor * (shape.columns + shape.rows) + wave) / pixels;
}

TileChoice choose_device_tile(const Device& device, const std::vector<DrawnPixel>& pixels, const SumGoal& goal) {
  TileChoice choice;
  for (const TileShape shape : device_shapes) {
    if (size_t(group_size(shape)) > device.info().largest_group) continue;
    choice.plan = {shape};
    choice.energies = measure_split(pixels, goal.grid, goal.bounds, goal.wavelength, shape);
    const double split = choice.energies.waves > 0 ? std::sqrt(choice.energies.error / choice.energies.waves) : 0;
    choice.error = std::hypot(split, rounding_error(TileProducts::single)) / std::sqrt(goal.coherence);
    choice.meets_tolerance = 1.25 * choice.error <= goal.tolerance;
    if (choice.meets_tolerance) break;
  }
  return choice;
}

void sum_tiles_on_devices(const std::vector<Device*>& devices, PreparedWaves waves, const LitGrid& panel,
                          TileShape shape, const PixelBox& bounds, Array2D<std::complex<float>>& samples,
                          const Observer& observer, const MoreLight& more) {
  const auto take = [&](Device& device, const PixelBox& band, const DeviceBuffer& sums) {
    fetch(device, sums, band, samples);
  };
  sum_on_devices(devices, {device_waves(waves, panel.wavelength, bounds), panel, shape, bounds, take}, observer, more);
}

void sum_tiles_on_device(PreparedWaves waves, TileShape shape, const PixelBox& bounds, DeviceField& field,
                         const Observer& observer, const MoreLight& more) {
  const LitGrid panel{field.head.grid, field.head.wavelength};
  const auto take = [&](Device&, const PixelBox& band, const DeviceBuffer& sums) { put(sums, band, field); };
  sum_on_devices({field.device}, {device_waves(waves, panel.wavelength, bounds), panel, shape, bounds, take}, observer,
                 more);
}

}  // namespace holotrace
