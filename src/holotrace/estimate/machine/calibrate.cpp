#include "holotrace/estimate/machine/calibrate.h"

#include <fmt/format.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <complex>
#include <functional>
#include <limits>

#include "holotrace/base/column_fft.h"
#include "holotrace/base/cpu.h"
#include "holotrace/estimate/machine/peak_rate.h"
#include "holotrace/estimate/machine/timed_jobs.h"
#include "holotrace/wave/planes/plane_plan.h"
#include "holotrace/wave/shared/cost_model.h"
#include "holotrace/wave/sum_exact.h"
#include "holotrace/wave/tiles/packed_product.h"
#include "holotrace/wave/tiles/tile_sum.h"

namespace holotrace {
namespace {

constexpr double wavelength = timed_wavelength, pitch = timed_full_hd.pitch;

// The fastest of many runs: other work on the machine can only slow a run down.
TimedWork fastest(const SummationWork& work, const std::function<void()>& run) {
  run();
  double best = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 9; ++i) best = std::min(best, seconds_of(run));
  return {work, best};
}

TimedWork time_exact() {
  const Grid panel{64, 64, pitch};
  const Sources sources = timed_waves(panel, 32, 0.19, 0.21);
  return fastest({.exact_terms = 32.0 * 64 * 64}, [&] { sum_exact(sources, panel); });
}

// Times the sum of waves on a single tile.
TimedWork time_tile(const TilePlan& plan, int count) {
  const Grid panel{plan.shape.columns, plan.shape.rows, pitch};
  const std::vector<PreparedWave> waves = prepare_waves(timed_waves(panel, count, 0.19, 0.21), panel);
  Array2D<std::complex<float>> samples(panel.ny, panel.nx);
  TileWorkspace workspace;
  return fastest(count * double(panel.pixels()) * tile_work(plan), [&] {
    sum_tile(waves, {panel, wavelength}, plan, {0, panel.nx, 0, panel.ny}, workspace, samples);
  });
}

// Times spreading of waves to the grids of a tile; every wave lights the whole tile. The waves fill more than the caches of
// a core, as those of a panel do.
TimedWork time_spreading(int nodes, int width) {
  const PlanesPlan plan{.tile = 120, .width = width, .nodes = nodes};
  const Grid panel{plan.tile, plan.tile, pitch};
  constexpr int count = 1 << 16;
  const SortedWaves waves =
      sort_waves(prepare_waves(timed_waves(panel, count, 0.19, 0.21), panel), plan, wavelength, pitch);
  const PlanesTables tables(plan, wavelength, pitch);
  PlanesWorkspace workspace;
  workspace.grids.assign(tables.grid_size(), 0.0F);
  const SummationWork work{.plane_waves = double(count), .spreads = count * spreads_per_wave(plan)};
  return fastest(work, [&] {
    size_t packet = 0;
    spread_waves(waves.waves, waves.slabs.front(), tables,
                 {{0, panel.nx, 0, panel.ny}, panel.x(plan.tile / 2), panel.y(plan.tile / 2)}, packet, workspace);
  });
}

// Times the transform that grids of tiles of 120 pixels get (plane_transform.h), in cache.
TimedWork time_fft() {
  constexpr int length = 240, blocks = 16;
  const ColumnFft<float> transform(length);
  const AlignedVector<std::complex<float>> lines(transform.work_size(), {1.0F, 0.0F});
  AlignedVector<std::complex<float>> transformed(lines.size()), spare(lines.size());
  return fastest({.fft_operations = blocks * column_block * fft_operations(length)}, [&] {
    for (int block = 0; block < blocks; ++block)
      transform(FftDirection::backward, lines.data(), transformed.data(), spare.data());
  });
}

TimedWork time_samples() {
  constexpr size_t count = 1 << 16;
  AlignedVector<std::complex<float>> a(count, {1.0F, 0.0F});
  const AlignedVector<std::complex<float>> b(count, {0.6F, 0.8F});
  return fastest({.samples = double(count)}, [&] {
    for (size_t i = 0; i < count; ++i)
      a[i] = {a[i].real() * b[i].real() - a[i].imag() * b[i].imag(),
              a[i].real() * b[i].imag() + a[i].imag() * b[i].real()};
  });
}

}  // namespace

std::vector<TimedWork> time_summation() {
  std::vector<TimedWork> timed;
  tbb::task_arena one_thread(1);
  one_thread.execute([&] {
    timed.push_back(time_exact());
    // Tiles of many shapes separate products from factors, and both from the fixed cost of each wave.
    for (const TileShape& tile : {TileShape{128, 120}, {64, 60}, {32, 30}, {32, 12}})
      timed.push_back(time_tile({tile}, 512));
    if (packed_unit() != PackedUnit::none)
      for (const TileShape& tile : {TileShape{128, 120}, {64, 60}, {32, 30}})
        for (const TileProducts products : {TileProducts::bf16, TileProducts::split_bf16})
          timed.push_back(time_tile({tile, products}, 512));
    for (const int width : {4, 5, 8})
      for (const int nodes : {1, 2, 4, 8}) timed.push_back(time_spreading(nodes, width));
    timed.push_back(time_fft());
    timed.push_back(time_samples());
  });
  return timed;
}

SummationRates calibrate_summation() {
  SummationRates rates = fit_rates(time_summation());
  for (const SummationTerm& term : summation_terms) rates.*term.rate = coarse_rate(rates.*term.rate);
  return rates;
}

std::string calibration_key() {
  constexpr int kernels = 2;  // raised when what the rates count changes
  return fmt::format("holotrace {}, kernels {}; {}; {}; {}{}", HOLOTRACE_VERSION, kernels, cpu_name(),
                     tile_sum_instruction_set(), has_avx512_bf16() ? "AVX512_BF16 " : "",
                     enable_amx_bf16() ? "AMX_BF16" : "");
}

}  // namespace holotrace
