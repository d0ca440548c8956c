#include "holotrace/wave/planes/device_planes.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "holotrace/base/threads.h"
#include "holotrace/wave/tiles/device_tiles.h"

namespace holotrace {
namespace {

constexpr const char* wave_source =
#include "kernels/plane_wave_kernel.h.inc"
    ;
constexpr const char* correction_source =
#include "kernels/plane_correction_kernel.h.inc"
    ;
constexpr const char* plane_source =
#include "kernels/plane_sum.cl.inc"
    ;

constexpr int block = 16, spread_group = int(packet_waves), added = 16;  // as in plane_sum.cl
// Memory for the grids of the tiles of a launch, and its pairs of a wave and a tile, at most: enough to keep a device busy.
// A launch then takes milliseconds on a fast card and tenths of a second on a slow one, whose screen must not freeze.
constexpr double most_bytes = 256e6, most_wave_tiles = 3e7;

// As plane_sum.cl declares them.
struct SpreadJob {
  int32_t first_packet, end_packet, first_wave, first_tile, tiles_across, cells, middle, width, is_first;
  PlaneSlab slab;
};
struct AddJob {
  int32_t slab, first_tile, tiles_across, tile, columns, rows, top, is_corrected;
  float pitch;
};

Kernel plane_kernel(const char* name, int nodes) {
  return {
      name, {tile_factor_source(), wave_source, correction_source, plane_source}, fmt::format("-D NODES={}", nodes)};
}

size_t groups_for(int items, int group) { return size_t((items + group - 1) / group); }

}  // namespace

// Buffers for some tiles and all nodes: grids [line][cell], their lines transformed, the same turned, and the terms
// [column][row], which are the wave, and for a correction also f, g, f·g, f² − g².
struct DevicePlanes::Chunk {
  int tiles;
  DeviceBuffer grids, lines, turned;
  std::array<DeviceBuffer, 5> terms;
};

PacketedWaves::PacketedWaves(const SortedWaves& sorted, const PlanesTables& tables, const Grid& grid,
                             const PixelBox& bounds)
    : sorted(sorted), tiles{grid, bounds, tables.plan.tile, tables.tangent}, waves(sorted.waves.size()) {
  parallel_for(
      0, int64_t(waves.size()),
      [&](int64_t i) { waves[size_t(i)] = device_plane_wave(sorted.waves[size_t(i)], tables.wavelength, tiles); }, {},
      4096);
  for (const Slab& slab : sorted.slabs) {
    slabs.push_back({int(packets.size()), 0});
    for (size_t first = slab.first; first < slab.last; first += packet_waves)
      packets.push_back(packet_of(waves, first, std::min(first + packet_waves, slab.last)));
    slabs.back().end = int(packets.size());
  }
}

DevicePlanes::DevicePlanes(Device& device, const PacketedWaves& waves, const PlanesTables& tables)
    : device_(device), lines_(device), waves_(waves), tables_(tables) {
  const auto lock = device.lock();
  const double wavelength = tables.wavelength;
  const double room = std::max(0.0, std::min(device.memory_left() / 3, device.free_memory()));
  const size_t most = std::max(size_t(room / sizeof(DeviceWave)), packet_waves);
  parts_.push_back({0, 0});
  size_t of_part = 0;
  for (const PlanePacket& packet : waves.packets) {
    const auto count = size_t(packet.end - packet.first);
    if (of_part + count > most) {
      parts_.push_back({parts_.back().end, parts_.back().end});
      of_part = 0;
    }
    of_part += count;
    ++parts_.back().end;
  }
  sent_packets_ = device.upload(waves.packets, "the waves");
  columns_ = device.upload(column_references(waves.tiles, wavelength), "places of tiles");
  rows_ = device.upload(row_references(waves.tiles, wavelength), "places of tiles");
  coefficients_ = device.upload(all_coefficients(tables), "the kernel of a transform");
  moments_ = device.upload(all_moments(tables), "the kernel of a transform");
  frequencies_ = device.upload(frequency_factors(tables), "frequencies");
  chirps_ = device.upload(all_chirps(waves.sorted.slabs, tables), "curvatures");
  corrections_ = device.upload(all_corrections(waves.sorted.slabs, tables), "corrections");
  sent_ = parts_.size();
  if (parts_.size() == 1) send_part(0);
}

double DevicePlanes::tile_bytes() const {
  const double side = tables_.plan.tile, cells = tables_.cells, terms = tables_.plan.is_corrected ? 5 : 1;
  return double(sizeof(std::complex<float>)) * tables_.plan.nodes *
         (cells * cells + 2 * side * cells + terms * side * side);
}

double DevicePlanes::part_bytes() const {
  if (parts_.size() == 1) return 0;
  size_t most = 0;
  for (const Packets& part : parts_)
    most = std::max(most, size_t(waves_.packets[size_t(part.end - 1)].end - waves_.packets[size_t(part.first)].first));
  return double(most * sizeof(DeviceWave));
}

int DevicePlanes::tiles_at_once() const {
  const double cells = tables_.cells, one = double(sizeof(std::complex<float>)) * tables_.plan.nodes * cells * cells;
  const double room = std::min(most_bytes, device_.memory_left() - (sent_ < parts_.size() ? 0 : part_bytes()));
  const double tiles = std::min({room / tile_bytes(), device_.info().largest_buffer / one,
                                 most_wave_tiles / double(std::max<size_t>(waves_.waves.size(), 1))});
  return std::clamp(int(std::min(tiles, 1e6)), 1, waves_.tiles.across() * waves_.tiles.down());
}

void DevicePlanes::send_part(size_t part) {
  if (sent_ == part) return;
  sent_waves_ = DeviceBuffer();  // released before the next is made
  const auto first = size_t(waves_.packets[size_t(parts_[part].first)].first);
  const size_t bytes = (size_t(waves_.packets[size_t(parts_[part].end - 1)].end) - first) * sizeof(DeviceWave);
  sent_waves_ = device_.make_buffer(bytes, "the waves");
  device_.write(sent_waves_, waves_.waves.data() + first, bytes);
  sent_ = part;
}

void DevicePlanes::spread(int slab, int first_tile, const Chunk& chunk) {
  const PlanesTables& t = tables_;
  const Packets& all = waves_.slabs[size_t(slab)];
  const size_t blocks = groups_for(t.cells, block);
  const PlaneSlab on_device = slab_on_device(waves_.sorted.slabs[size_t(slab)], t);
  for (size_t part = 0; part < parts_.size(); ++part) {
    const int first = std::max(parts_[part].first, all.first), end = std::min(parts_[part].end, all.end);
    if (first >= end) continue;
    send_part(part);
    const SpreadJob job{first,
                        end,
                        waves_.packets[size_t(parts_[part].first)].first,
                        first_tile,
                        waves_.tiles.across(),
                        t.cells,
                        t.transform / 2 + PlanesTables::margin,
                        t.plan.width,
                        first == all.first,
                        on_device};
    device_.run(plane_kernel("spread_waves", t.plan.nodes),
                {blocks * blocks, size_t(chunk.tiles), size_t(spread_group), 1},
                {job, sent_waves_, sent_packets_, coefficients_, columns_, rows_, chunk.grids});
    if (parts_.size() > 1) device_.finish();  // before the waves are released
  }
}

// The terms are separable in f and g but for f² − g², a difference of two. So three transforms along the lines, and six
// along the columns, give all five.
void DevicePlanes::transform(const Chunk& chunk) {
  const PlanesTables& t = tables_;
  const int side = t.plan.tile, grids = chunk.tiles * t.plan.nodes;
  enum Factor { none, frequency, square, minus_square };
  const auto along = [&](Factor factor) {
    LineTransform transform{.length = t.transform,
                            .direction = FftDirection::backward,
                            .in = {t.cells, -PlanesTables::margin - t.transform / 2},
                            .out = {side, -side / 2}};
    if (factor != none) transform.in.factors = {.values = &frequencies_, .offset = (factor - 1) * t.cells};
    return transform;
  };
  const auto lines = [&](Factor factor) {
    lines_.run(along(factor), grids * t.cells, chunk.grids, chunk.lines);
    lines_.transpose(t.cells, side, chunk.lines, chunk.turned, grids);
  };
  const auto columns = [&](Factor factor, const DeviceBuffer& term, bool adds = false) {
    LineTransform transform = along(factor);
    transform.adds = adds;
    lines_.run(transform, grids * side, chunk.turned, term);
  };
  const auto& [wave, f, g, cross, difference] = chunk.terms;
  lines(none);
  columns(none, wave);
  if (!t.plan.is_corrected) return;
  columns(frequency, g);
  columns(minus_square, difference);
  lines(frequency);
  columns(none, f);
  columns(frequency, cross);
  lines(square);
  columns(none, difference, true);
}

void DevicePlanes::add(const PixelBox& band, const DeviceBuffer& samples, const Observer& observer,
                       const std::atomic<bool>& is_stopped) {
  const auto lock = device_.lock();
  const PlanesTables& t = tables_;
  const int side = t.plan.tile, across = waves_.tiles.across(), top = band.y0 - waves_.tiles.bounds.y0;
  const int first = top / side * across, end = (band.y1 - waves_.tiles.bounds.y0 + side - 1) / side * across;
  const int at_once = std::min(tiles_at_once(), end - first);
  const auto buffer = [&](double rows, double columns) {
    const double samples_of_grids = double(at_once) * t.plan.nodes * rows * columns;
    return device_.make_buffer(sizeof(std::complex<float>) * size_t(samples_of_grids), "the grids of a transform");
  };
  Chunk chunk{at_once, buffer(t.cells, t.cells), buffer(t.cells, side), buffer(side, t.cells), {}};
  for (size_t i = 0; i < (t.plan.is_corrected ? chunk.terms.size() : 1); ++i) chunk.terms[i] = buffer(side, side);
  const auto term = [&](size_t i) -> const DeviceBuffer& { return chunk.terms[t.plan.is_corrected ? i : 0]; };
  for (int tile = first; tile < end && !is_stopped; tile += at_once) {
    chunk.tiles = std::min(at_once, end - tile);
    for (int slab = 0; slab < int(waves_.slabs.size()); ++slab) {
      spread(slab, tile, chunk);
      transform(chunk);
      const AddJob job{
          slab, tile, across, side, band.x1 - band.x0, band.y1 - band.y0, top, t.plan.is_corrected, float(t.pitch)};
      device_.run(plane_kernel("add_nodes", t.plan.nodes),
                  {groups_for(side, added), groups_for(side, added), size_t(added), size_t(added), size_t(chunk.tiles)},
                  {job, corrections_, chirps_, moments_, term(0), term(1), term(2), term(3), term(4), samples});
    }
    device_.finish();
    observer.progress(double(tile + chunk.tiles - first) / (end - first));
  }
}

DevicePlanesWork device_planes_work(const PlanesPlan& plan, double whole, double tiles) {
  // Counted in plane_sum.cl. For each item of a group and wave: 12 for its place among the cells, 8 per node for 4 cells; for
  // each wave that reaches the block 800, its phase, weights and numbering.
  const double blocks = std::pow((block + plan.width - 1.0) / block, 2);  // that a wave reaches
  const double per_wave = spread_group * (12 + 8.0 * plan.nodes) + 800;
  const double side = plan.tile, cells = 2 * side + 2 * PlanesTables::margin;
  const double lines = cells * cells, turned = side * cells, pixels = side * side;
  const double moved = plan.is_corrected ? 4 * lines + 15 * turned + 12 * pixels : 2 * lines + 4 * turned + 2 * pixels;
  return {whole * blocks * per_wave, tiles * plan.slabs * plan.nodes * double(sizeof(std::complex<float>)) * moved};
}

}  // namespace holotrace
