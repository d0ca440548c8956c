#include "holotrace/slm/panel/device_panel.h"

#include <fmt/format.h>

#include <cmath>
#include <complex>
#include <cstdint>

#include "holotrace/slm/panel/panel_parts.h"

namespace holotrace {
namespace {

using Complex = std::complex<float>;

constexpr const char* source =
#include "kernels/panel.cl.inc"
    ;

constexpr size_t group = 64;

WorkSize over(int nx, int ny) { return {(size_t(nx) + group - 1) / group, size_t(ny), group, 1}; }

template <class Values>
DeviceBuffer upload(Device& device, const Values& values) {
  if (values.empty()) return {};
  DeviceBuffer buffer = device.make_buffer(values.size() * sizeof values[0], "a panel");
  device.write(buffer, values.data(), buffer.bytes());
  return buffer;
}

// A buffer, or if it is empty any other, which the kernel then does not use.
KernelArgument either(const DeviceBuffer& buffer, const DeviceBuffer& other) {
  return buffer.bytes() > 0 ? KernelArgument(buffer) : KernelArgument::unused(other);
}

// An array to whose values the kernel adds, or which it writes.
KernelArgument added_to(const DeviceBuffer& buffer, bool adds) {
  return adds ? KernelArgument::changed(buffer) : KernelArgument(buffer);
}

}  // namespace

// As panel.cl declares them.
struct DevicePanel::Response {
  int32_t nx, knots;
  float cycles_per_level, amplitude_per_level, modulus_per_level;
  int32_t has_amplitude, is_complex, has_stuck, is_halfway;
};
struct DevicePanel::Pixel {
  int32_t nx, ny, n, reach, points, has_amplitude, has_static;
  float gap_re, gap_im;
};

DevicePanel::DevicePanel(Device& device, const PanelModel& model, PanelMaps maps) : device_(device), lines_(device) {
  const PanelModel::Parts& parts = *model.parts_;
  const auto lock = device_.lock();
  is_complex_ = parts.modulation == Modulation::complex;
  has_blur_ = parts.has_crosstalk;
  sizes_ = {.nx = parts.nx(),
            .ny = parts.ny(),
            .n = parts.params.subpixels,
            .expansion = parts.expansion,
            .halo = has_blur_ ? parts.blur.along_y().reach : 0,
            .has_amplitude = parts.response.has_amplitude() || is_complex_};
  const PixelResponse::Table& table = parts.response.table();
  cycles_per_level_ = table.cycles_per_level;
  amplitude_per_level_ = table.amplitude_per_level;
  modulus_per_level_ = 1 / float(parts.levels - 1);
  knots_count_ = int(table.knots.size());
  knots_ = upload(device_, table.knots);
  if (has_blur_) {
    reach_x_ = parts.blur.along_x().reach;
    reach_y_ = parts.blur.along_y().reach;
    taps_x_ = upload(device_, parts.blur.along_x().values);
    taps_y_ = upload(device_, parts.blur.along_y().values);
  }
  projections_ = upload(device_, parts.points.projections);
  weights_x_ = upload(device_, parts.row.weights());
  weights_y_ = upload(device_, parts.column.weights());
  light_x_ = upload(device_, parts.light.along_x);
  light_y_ = upload(device_, parts.light.along_y);
  const Complex whole = parts.gap * float(std::sqrt(parts.params.irradiance));
  gap_re_ = parts.gap.real();
  gap_im_ = parts.gap.imag();
  whole_gap_re_ = whole.real();
  whole_gap_im_ = whole.imag();
  has_light_ = parts.light.samples.size() > 0;
  has_gap_field_ = parts.gap_field.size() > 0;
  has_static_ = parts.static_errors.size() > 0;
  has_stuck_ = !parts.stuck.empty();
  if (maps == PanelMaps::in_bands) return;
  pixels_ = pixel_maps(device_, model, {0, sizes_.ny, 0});
  samples_ = sample_maps(device_, model, {0, sizes_.n * sizes_.nx});
}

void DevicePanel::make(DeviceBuffer& buffer, size_t floats) {
  if (buffer.bytes() >= floats * sizeof(float)) return;
  buffer = {};
  buffer = device_.make_buffer(floats * sizeof(float), "a panel");
}

void DevicePanel::make_memory(Memory& memory, bool has_slopes) {
  const size_t pixels = sizes_.pixels(), n = size_t(sizes_.n);
  const auto make_pixels = [&](Pixels& values) {
    make(values.cycles, pixels);
    if (sizes_.has_amplitude) make(values.amplitudes, pixels);
  };
  make_pixels(memory.pixels);
  if (has_blur_) make_pixels(memory.blurred);
  if (has_slopes) make_pixels(memory.of_pixels);
  if (has_slopes && has_blur_)
    for (Pixels* values : {&memory.of_points, &memory.of_rows}) make_pixels(*values);
  make(memory.terms, 2 * size_t(sizes_.expansion.pairs()) * pixels);
  for (DeviceBuffer* buffer : {&memory.term, &memory.rows, &memory.columns}) make(*buffer, 2 * n * pixels);
  make(memory.turned, 2 * n * n * pixels);
  if (n > 1 || has_slopes) make(memory.spread, 2 * n * n * pixels);
}

DevicePanel::Response DevicePanel::response(const DevicePattern& pattern) const {
  return {.nx = sizes_.nx,
          .knots = knots_count_,
          .cycles_per_level = cycles_per_level_,
          .amplitude_per_level = amplitude_per_level_,
          .modulus_per_level = modulus_per_level_,
          .has_amplitude = sizes_.has_amplitude,
          .is_complex = is_complex_,
          .has_stuck = has_stuck_,
          .is_halfway = pattern.is_halfway};
}

DevicePanel::Pixel DevicePanel::pixel(int rows) const {
  return {.nx = sizes_.nx,
          .ny = rows,
          .n = sizes_.n,
          .reach = has_blur_ ? reach_x_ : -1,
          .points = sizes_.expansion.points,
          .has_amplitude = sizes_.has_amplitude,
          .has_static = has_static_,
          .gap_re = gap_re_,
          .gap_im = gap_im_};
}

Kernel DevicePanel::kernel(const char* name) const {
  return {name, {source}, fmt::format("-D TERMS={}", sizes_.expansion.terms)};
}

// Phases and amplitudes of the pixels of some rows.
void DevicePanel::respond(const DevicePattern& pattern, int rows, const PixelMaps& maps, const Memory& memory) {
  const DeviceBuffer& drive = pattern.drive;
  device_.run(
      kernel("respond"), over(sizes_.nx, rows),
      {response(pattern), drive, pattern.modulus ? KernelArgument(*pattern.modulus) : KernelArgument::unused(drive),
       either(maps.stuck, drive), either(maps.stuck_moduli, drive), either(knots_, drive), memory.pixels.cycles,
       either(memory.pixels.amplitudes, memory.pixels.cycles)});
}

// The light on the panel times the field, row by row; or its conjugate, column by column.
void DevicePanel::illuminate(const DeviceBuffer& u, const SampleColumns& columns, const SampleMaps& maps,
                             bool is_back) {
  if (light_x_.bytes() == 0 && !has_light_) return;
  const int along = is_back ? sizes_.n * sizes_.ny : columns.count,
            lines = is_back ? columns.count : sizes_.n * sizes_.ny;
  device_.run(
      kernel("illuminate"), over(along, lines),
      {int32_t(along), int32_t(lines), int32_t(columns.first), int32_t(has_light_), int32_t(is_back), int32_t(is_back),
       either(light_x_, u), either(light_y_, u), either(maps.light, u), KernelArgument::changed(u)});
}

// With crosstalk: the blur along the columns to a row of the points of all pixels, or its adjoint.
void DevicePanel::blur_columns(const Pixels& from, const Pixels& to, const PixelRows& rows, const Blur& blur) {
  if (!has_blur_) return;
  const int32_t first = blur.cy * (2 * reach_y_ + 1), sign = blur.is_adjoint ? -1 : 1;
  for (DeviceBuffer Pixels::*values : {&Pixels::cycles, &Pixels::amplitudes})
    if (values == &Pixels::cycles || sizes_.has_amplitude)
      device_.run(kernel("blur_columns"), over(sizes_.nx, rows.count),
                  {int32_t(sizes_.nx), int32_t(rows.count + 2 * rows.halo), int32_t(rows.halo), int32_t(reach_y_),
                   first, sign, int32_t(blur.adds), taps_y_, from.*values, added_to(to.*values, blur.adds)});
}

// The spectrum of a line of samples, times the weights of a term, or their conjugates, and back.
LineTransform DevicePanel::along(const DeviceBuffer& weights, int samples, int term, bool is_adjoint, bool adds) const {
  LineTransform line;
  line.length = samples;
  line.in.count = line.out.count = samples;
  line.filter.values = &weights;
  line.filter.offset = term * samples;
  line.filter.is_conjugate = is_adjoint;
  line.adds = adds;
  return line;
}

void DevicePanel::make_terms(const DevicePattern& pattern, const PixelRows& rows, const PixelMaps& maps,
                             const Memory& memory) {
  respond(pattern, rows.count + 2 * rows.halo, maps, memory);
  const Pixels& shown = has_blur_ ? memory.blurred : memory.pixels;
  for (int cy = 0; cy < sizes_.expansion.points; ++cy) {
    blur_columns(memory.pixels, memory.blurred, rows, {cy, false, false});
    device_.run(kernel("add_terms"), over(sizes_.nx, rows.count),
                {pixel(rows.count), int32_t(cy), shown.cycles, either(shown.amplitudes, shown.cycles),
                 either(taps_x_, shown.cycles), projections_, either(maps.static_errors, shown.cycles),
                 added_to(memory.terms, cy > 0)});
  }
  const int width = sizes_.n * sizes_.nx;
  if (sizes_.n > 1) device_.run(kernel("clear_samples"), over(width, rows.count), {int32_t(width), memory.term});
}

void DevicePanel::spread_rows(int q, const PixelRows& rows, const SampleColumns& columns, const Memory& memory,
                              const DeviceBuffer& to) {
  const int terms = sizes_.expansion.terms;
  const size_t of_term = size_t(sizes_.nx) * size_t(rows.count) * sizeof(Complex);
  for (int p = 0; p < terms - q; ++p) {
    const int pair = q * terms - q * (q - 1) / 2 + p;
    device_.run(kernel("take_term"), over(sizes_.nx, rows.count),
                {int32_t(sizes_.nx), int32_t(rows.count), int32_t(sizes_.n), int32_t(pair),
                 KernelArgument::moving(memory.terms, of_term), KernelArgument::moving(memory.term, of_term)});
    LineTransform line = along(weights_x_, sizes_.n * sizes_.nx, p, false, p > 0);
    line.out.count = columns.count;
    line.out.shift = columns.first;
    lines_.run(line, rows.count, memory.term, memory.rows);
  }
  lines_.transpose(rows.count, columns.count, memory.rows, {}, to, {sizes_.ny, rows.first});
}

void DevicePanel::spread_columns(int q, const SampleColumns& columns, const DeviceBuffer& from, const Memory& memory) {
  const int height = sizes_.n * sizes_.ny;
  LineTransform line = along(weights_y_, height, q, false, q > 0);
  if (sizes_.n > 1)
    device_.run(kernel("put_apart"), over(height, columns.count),
                {int32_t(height), int32_t(sizes_.n), from, memory.spread});
  lines_.run(line, columns.count, sizes_.n > 1 ? memory.spread : from, memory.turned);
}

void DevicePanel::finish(const SampleColumns& columns, const SampleMaps& maps, const Memory& memory,
                         const DeviceBuffer& u) {
  const int height = sizes_.n * sizes_.ny;
  lines_.transpose(columns.count, height, memory.turned, u);
  if (gap_re_ != 0 || gap_im_ != 0)
    device_.run(kernel("add_gaps"), over(columns.count, height),
                {int32_t(columns.count), whole_gap_re_, whole_gap_im_, int32_t(has_gap_field_), either(maps.gaps, u),
                 KernelArgument::changed(u)});
  illuminate(u, columns, maps, false);
}

void DevicePanel::leave(const DevicePattern& pattern, const DeviceBuffer& u, Memory& memory) {
  const auto lock = device_.lock();
  make_memory(memory, false);
  const PixelRows rows{0, sizes_.ny, 0};
  const SampleColumns columns{0, sizes_.n * sizes_.nx};
  make_terms(pattern, rows, pixels_, memory);
  for (int q = 0; q < sizes_.expansion.terms; ++q) {
    spread_rows(q, rows, columns, memory, memory.columns);
    spread_columns(q, columns, memory.columns, memory);
  }
  finish(columns, samples_, memory, u);
}

// The slopes by the phases and amplitudes of a point of all pixels, from the terms'; with crosstalk added up over the
// points of a row.
void DevicePanel::add_point_slopes(int cx, int cy, const Memory& memory) {
  const Pixels& shown = has_blur_ ? memory.blurred : memory.pixels;
  const Pixels& to = has_blur_ ? memory.of_points : memory.of_pixels;
  device_.run(kernel("point_slopes"), over(sizes_.nx, sizes_.ny),
              {pixel(sizes_.ny), int32_t(cx), int32_t(cy), shown.cycles, either(shown.amplitudes, shown.cycles),
               either(taps_x_, shown.cycles), projections_, memory.terms, to.cycles, either(to.amplitudes, to.cycles)});
  if (!has_blur_) return;
  for (DeviceBuffer Pixels::*values : {&Pixels::cycles, &Pixels::amplitudes})
    if (values == &Pixels::cycles || sizes_.has_amplitude)
      device_.run(kernel("blur_rows_back"), over(sizes_.nx, sizes_.ny),
                  {pixel(sizes_.ny), int32_t(cx), taps_x_, to.*values, added_to(memory.of_rows.*values, cx > 0)});
}

void DevicePanel::add_pattern_slopes(const DevicePattern& pattern, const DeviceSlopes& to, const Memory& memory) {
  const DeviceBuffer& drive = pattern.drive;
  device_.run(kernel("pattern_slopes"), over(sizes_.nx, sizes_.ny),
              {response(pattern), float(to.factor), drive,
               pattern.modulus ? KernelArgument(*pattern.modulus) : KernelArgument::unused(drive),
               either(pixels_.stuck, drive), either(knots_, drive), memory.of_pixels.cycles,
               either(memory.of_pixels.amplitudes, memory.of_pixels.cycles), KernelArgument::changed(to.drive),
               to.modulus ? KernelArgument::changed(*to.modulus) : KernelArgument::unused(to.drive)});
}

void DevicePanel::add_slopes(const DevicePattern& pattern, const DeviceBuffer& g, const DeviceSlopes& to,
                             Memory& memory) {
  const auto lock = device_.lock();
  make_memory(memory, true);
  respond(pattern, sizes_.ny, pixels_, memory);
  const int n = sizes_.n, width = n * sizes_.nx, height = n * sizes_.ny, terms = sizes_.expansion.terms;
  const PixelRows rows{0, sizes_.ny, 0};
  const size_t of_term = sizes_.pixels() * sizeof(Complex);
  lines_.transpose(height, width, g, memory.turned);
  illuminate(memory.turned, {0, width}, samples_, true);
  for (int q = 0, pair = 0; q < terms; ++q) {
    lines_.run(along(weights_y_, height, q, true, false), width, memory.turned, memory.spread);
    if (n > 1)
      device_.run(kernel("put_together"), over(sizes_.ny, width),
                  {int32_t(sizes_.ny), int32_t(n), memory.spread, memory.columns});
    lines_.transpose(width, sizes_.ny, n > 1 ? memory.columns : memory.spread, memory.rows);
    for (int p = 0; p < terms - q; ++p, ++pair) {
      lines_.run(along(weights_x_, width, p, true, false), sizes_.ny, memory.rows, memory.term);
      device_.run(kernel("put_term"), over(sizes_.nx, sizes_.ny),
                  {int32_t(sizes_.nx), int32_t(sizes_.ny), int32_t(n), int32_t(pair), int32_t(has_static_),
                   either(pixels_.static_errors, memory.term), KernelArgument::moving(memory.term, of_term),
                   KernelArgument::moving(memory.terms, of_term)});
    }
  }
  for (int cy = 0; cy < sizes_.expansion.points; ++cy) {
    blur_columns(memory.pixels, memory.blurred, rows, {cy, false, false});
    for (int cx = 0; cx < sizes_.expansion.points; ++cx) add_point_slopes(cx, cy, memory);
    blur_columns(memory.of_rows, memory.of_pixels, rows, {cy, true, cy > 0});
  }
  add_pattern_slopes(pattern, to, memory);
}

}  // namespace holotrace
