#include "holotrace/wave/tiles/device_tiles.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

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

std::vector<DeviceWave> device_waves(const std::vector<PreparedWave>& waves, size_t first, size_t end,
                                     double wavelength, const PixelBox& bounds) {
  std::vector<DeviceWave> some(end - first);
  parallel_for(
      0, int64_t(some.size()),
      [&](int64_t i) { some[size_t(i)] = device_wave(waves[first + size_t(i)], wavelength, bounds); }, {}, 4096);
  return some;
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

DevicePlan make_plan(const Device& device, size_t waves, const PixelBox& bounds, TileShape shape) {
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
  const double free = device.free_memory() - spare, columns = bounds.x1 - bounds.x0, rows = bounds.y1 - bounds.y0;
  const double row_bytes = double(sizeof(std::complex<float>) * plan.slices) * columns;
  const double all_waves = double(sizeof(DeviceWave) * waves);
  const double for_waves = std::min(all_waves, std::max(free / 2, free - row_bytes * rows));
  const double band = std::min((free - for_waves) / row_bytes, most_samples / columns);
  plan.rows = band >= rows ? int(rows) : std::max(int(band) / shape.rows, 1) * shape.rows;
  const size_t launch = std::max(plan.launch(), size_t(1));
  plan.waves = std::max(size_t(for_waves) / sizeof(DeviceWave) / launch, size_t(1)) * launch;
  if (all_waves <= for_waves) plan.waves = waves;
  return plan;
}

// Adds up the slices of a band.
void add_slices(Device& device, TileShape shape, const DeviceBuffer& sums, int64_t samples, size_t slices) {
  if (slices == 1) return;
  constexpr size_t group = 64;
  device.run(tile_kernel(shape, "add_slices"), {(size_t(samples) + group - 1) / group, 1, group, 1},
             {sums, int32_t(samples), int32_t(slices)});
}

// Calls take(band, sums) for each band of rows, whose sums are on the device.
template <class Take>
void sum_bands(Device& device, const std::vector<PreparedWave>& waves, const LitGrid& panel, TileShape shape,
               const PixelBox& bounds, const Observer& observer, const Take& take) {
  const auto lock = device.lock();
  const Grid& grid = panel.grid;
  const int columns = bounds.x1 - bounds.x0;
  const DevicePlan plan = make_plan(device, waves.size(), bounds, shape);
  const DeviceBuffer column_centres = device.upload(
      tile_centres(columns, shape.columns, panel.wavelength, [&](double i) { return grid.x(bounds.x0 + i); }),
      "places of tiles");
  const Kernel kernel = tile_kernel(shape, "sum_tiles");
  DeviceBuffer on_device;
  const double work = double(waves.size()) * (bounds.y1 - bounds.y0);
  double done = 0;
  for (int top = bounds.y0; top < bounds.y1; top += plan.rows) {
    const int rows = std::min(plan.rows, bounds.y1 - top);
    const DeviceBuffer row_centres = device.upload(
        tile_centres(rows, shape.rows, panel.wavelength, [&](double j) { return grid.y(top + j); }), "places of tiles");
    const PixelBox band{bounds.x0, bounds.x1, top, top + rows};
    const DeviceBuffer sums =
        device.make_buffer(sizeof(std::complex<float>) * size_t(band.pixels()) * plan.slices, "a field");
    for (size_t part = 0; part < waves.size(); part += plan.waves) {
      const size_t end = std::min(part + plan.waves, waves.size());
      if (top == bounds.y0 || plan.waves < waves.size()) {
        on_device = DeviceBuffer();  // released before the next is made
        on_device = device.upload(device_waves(waves, part, end, panel.wavelength, bounds), "the waves");
      }
      for (size_t first = part; first < end; first += plan.launch()) {
        const size_t last = std::min(first + plan.launch(), end);
        const TileJob job{int32_t(first - part),
                          int32_t(last - part),
                          int32_t(plan.share),
                          columns,
                          rows,
                          top - bounds.y0,
                          first == 0,
                          float(grid.pitch / panel.wavelength)};
        device.run(kernel,
                   {tiles_along(columns, shape.columns), tiles_along(rows, shape.rows),
                    size_t(shape.columns / block_columns), size_t(shape.rows / block_rows(shape)), plan.slices},
                   {on_device, column_centres, row_centres, job, sums});
        device.finish();
        observer.progress((done += double(last - first) * rows) / work);
      }
    }
    add_slices(device, shape, sums, band.pixels(), plan.slices);
    take(band, sums);
  }
}

}  // namespace

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

void sum_tiles_on_device(Device& device, const std::vector<PreparedWave>& waves, const LitGrid& panel, TileShape shape,
                         const PixelBox& bounds, Array2D<std::complex<float>>& samples, const Observer& observer) {
  sum_bands(device, waves, panel, shape, bounds, observer,
            [&](const PixelBox& band, const DeviceBuffer& sums) { fetch(device, sums, band, samples); });
}

void sum_tiles_on_device(const std::vector<PreparedWave>& waves, TileShape shape, const PixelBox& bounds,
                         DeviceField& field, const Observer& observer) {
  sum_bands(*field.device, waves, {field.head.grid, field.head.wavelength}, shape, bounds, observer,
            [&](const PixelBox& band, const DeviceBuffer& sums) { put(sums, band, field); });
}

}  // namespace holotrace
