#include "holotrace/slm/panel/device_panel.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdint>

#include "holotrace/base/error.h"
#include "holotrace/slm/panel/panel_parts.h"

namespace holotrace {
namespace {

using Complex = std::complex<float>;

constexpr const char* source =
#include "kernels/panel.cl.inc"
    ;

constexpr size_t group = 64;

WorkSize over(size_t count) { return {(count + group - 1) / group, 1, group, 1}; }
WorkSize over(int nx, int ny) { return {(size_t(nx) + group - 1) / group, size_t(ny), group, 1}; }

template <class Values>
DeviceBuffer upload(Device& device, const Values& values) {
  if (values.empty()) return {};
  DeviceBuffer buffer = device.make_buffer(values.size() * sizeof values[0], "a panel");
  device.write(buffer, values.data(), buffer.bytes());
  return buffer;
}

// A buffer, or if it is empty any other, which the kernel then does not read.
const DeviceBuffer& either(const DeviceBuffer& buffer, const DeviceBuffer& other) {
  return buffer.bytes() > 0 ? buffer : other;
}

// The levels of the dead pixels, and −1 for all others; nothing if there are none.
std::vector<float> stuck_levels(const std::vector<StuckPixel>& stuck, size_t pixels, double scale) {
  std::vector<float> levels(stuck.empty() ? 0 : pixels, -1);
  for (const StuckPixel& one : stuck) levels[size_t(one.pixel)] = float(one.level * scale);
  return levels;
}

}  // namespace

void check_countable(const Grid& samples) {
  require(
      samples.pixels() < int64_t(1) << 31,
      "expected fewer than 2³¹ samples of the light of a panel on a device, got {} × {}; use fewer subpixels, or the "
      "processor",
      samples.nx, samples.ny);
}

// As panel.cl declares them.
struct DevicePanel::Response {
  int32_t count, knots;
  float cycles_per_level, amplitude_per_level, modulus_per_level;
  int32_t has_amplitude, is_complex, has_stuck, is_halfway;
};
struct DevicePanel::Pixel {
  int32_t nx, ny, n, reach, points, has_amplitude, has_static;
  float gap_re, gap_im;
};

DevicePanel::DevicePanel(Device& device, const PanelModel& model) : device_(device), lines_(device) {
  const PanelModel::Parts& parts = *model.parts_;
  check_countable(parts.out);
  const auto lock = device_.lock();
  sizes_ = {parts.nx(), parts.ny(), parts.params.subpixels, parts.expansion};
  is_complex_ = parts.modulation == Modulation::complex;
  has_amplitude_ = parts.response.has_amplitude() || is_complex_;
  const PixelResponse::Table& table = parts.response.table();
  cycles_per_level_ = table.cycles_per_level;
  amplitude_per_level_ = table.amplitude_per_level;
  modulus_per_level_ = 1 / float(parts.levels - 1);
  knots_count_ = int(table.knots.size());
  knots_ = upload(device_, table.knots);
  const double of_phase = double(parts.levels) / parts.slm.levels,
               of_amplitude = (parts.levels - 1.0) / (parts.slm.levels - 1.0);
  stuck_ = upload(device_, stuck_levels(parts.stuck, sizes_.pixels(),
                                        parts.modulation == Modulation::amplitude ? of_amplitude : of_phase));
  if (is_complex_) stuck_moduli_ = upload(device_, stuck_levels(parts.stuck, sizes_.pixels(), of_amplitude));
  has_blur_ = parts.has_crosstalk;
  if (has_blur_) {
    reach_x_ = parts.blur.along_x().reach;
    reach_y_ = parts.blur.along_y().reach;
    taps_x_ = upload(device_, parts.blur.along_x().values);
    taps_y_ = upload(device_, parts.blur.along_y().values);
  }
  projections_ = upload(device_, parts.points.projections);
  weights_x_ = upload(device_, parts.row.weights());
  weights_y_ = upload(device_, parts.column.weights());
  static_errors_ = upload(device_, parts.static_errors.values);
  gap_field_ = upload(device_, parts.gap_field.values);
  light_x_ = upload(device_, parts.light.along_x);
  light_y_ = upload(device_, parts.light.along_y);
  light_ = upload(device_, parts.light.samples.values);
  const Complex whole = parts.gap * float(std::sqrt(parts.params.irradiance));
  gap_re_ = parts.gap.real();
  gap_im_ = parts.gap.imag();
  whole_gap_re_ = whole.real();
  whole_gap_im_ = whole.imag();
}

void DevicePanel::make(DeviceBuffer& buffer, size_t floats) {
  if (buffer.bytes() >= floats * sizeof(float)) return;
  buffer = {};
  buffer = device_.make_buffer(floats * sizeof(float), "a panel");
}

void DevicePanel::make_memory(Memory& memory) {
  const size_t pixels = sizes_.pixels(), n = size_t(sizes_.n);
  for (Pixels* values : {&memory.pixels, &memory.of_pixels}) {
    make(values->cycles, pixels);
    if (has_amplitude_) make(values->amplitudes, pixels);
  }
  for (Pixels* values : {&memory.blurred, &memory.of_points, &memory.of_rows}) {
    if (!has_blur_) break;
    make(values->cycles, pixels);
    if (has_amplitude_) make(values->amplitudes, pixels);
  }
  make(memory.terms, 2 * size_t(sizes_.expansion.pairs()) * pixels);
  for (DeviceBuffer* buffer : {&memory.term, &memory.rows, &memory.columns}) make(*buffer, 2 * n * pixels);
  for (DeviceBuffer* buffer : {&memory.turned, &memory.spread}) make(*buffer, 2 * n * n * pixels);
}

DevicePanel::Response DevicePanel::response(const DevicePattern& pattern) const {
  return {.count = int32_t(sizes_.pixels()),
          .knots = knots_count_,
          .cycles_per_level = cycles_per_level_,
          .amplitude_per_level = amplitude_per_level_,
          .modulus_per_level = modulus_per_level_,
          .has_amplitude = has_amplitude_,
          .is_complex = is_complex_,
          .has_stuck = stuck_.bytes() > 0,
          .is_halfway = pattern.is_halfway};
}

DevicePanel::Pixel DevicePanel::pixel() const {
  return {.nx = sizes_.nx,
          .ny = sizes_.ny,
          .n = sizes_.n,
          .reach = has_blur_ ? reach_x_ : -1,
          .points = sizes_.expansion.points,
          .has_amplitude = has_amplitude_,
          .has_static = static_errors_.bytes() > 0,
          .gap_re = gap_re_,
          .gap_im = gap_im_};
}

Kernel DevicePanel::kernel(const char* name) const {
  return {name, {source}, fmt::format("-D TERMS={}", sizes_.expansion.terms)};
}

// Phases and amplitudes of all pixels.
void DevicePanel::respond(const DevicePattern& pattern, const Memory& memory) {
  const DeviceBuffer& drive = pattern.drive;
  device_.run(kernel("respond"), over(sizes_.pixels()),
              {response(pattern), drive, pattern.modulus ? *pattern.modulus : drive, either(stuck_, drive),
               either(stuck_moduli_, drive), either(knots_, drive), memory.pixels.cycles,
               either(memory.pixels.amplitudes, memory.pixels.cycles)});
}

// The light on the panel times the field, row by row or column by column.
void DevicePanel::illuminate(const DeviceBuffer& u, bool is_by_columns, bool is_conjugate) {
  if (light_x_.bytes() == 0 && light_.bytes() == 0) return;
  const int width = sizes_.n * sizes_.nx, height = sizes_.n * sizes_.ny;
  device_.run(kernel("illuminate"), over(size_t(width) * size_t(height)),
              {int32_t(width), int32_t(height), int32_t(light_.bytes() > 0), int32_t(is_by_columns),
               int32_t(is_conjugate), either(light_x_, u), either(light_y_, u), either(light_, u), u});
}

// With crosstalk: the blur along the columns to row cy of the points of all pixels, or its adjoint.
void DevicePanel::blur_columns(const Pixels& from, const Pixels& to, int cy, bool is_adjoint, bool adds) {
  if (!has_blur_) return;
  const int32_t first = cy * (2 * reach_y_ + 1), sign = is_adjoint ? -1 : 1;
  for (DeviceBuffer Pixels::*values : {&Pixels::cycles, &Pixels::amplitudes})
    if (values == &Pixels::cycles || has_amplitude_)
      device_.run(kernel("blur_columns"), over(sizes_.nx, sizes_.ny),
                  {int32_t(sizes_.nx), int32_t(sizes_.ny), int32_t(reach_y_), first, sign, int32_t(adds), taps_y_,
                   from.*values, to.*values});
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

void DevicePanel::leave(const DevicePattern& pattern, const DeviceBuffer& u, Memory& memory) {
  const auto lock = device_.lock();
  make_memory(memory);
  respond(pattern, memory);
  const int n = sizes_.n, width = n * sizes_.nx, height = n * sizes_.ny, terms = sizes_.expansion.terms;
  const size_t samples = size_t(width) * size_t(height), in_rows = size_t(width) * size_t(sizes_.ny);
  const Pixels& shown = has_blur_ ? memory.blurred : memory.pixels;
  for (int cy = 0; cy < sizes_.expansion.points; ++cy) {
    blur_columns(memory.pixels, memory.blurred, cy, false, false);
    device_.run(kernel("add_terms"), over(sizes_.nx, sizes_.ny),
                {pixel(), int32_t(cy), shown.cycles, either(shown.amplitudes, shown.cycles),
                 either(taps_x_, shown.cycles), projections_, either(static_errors_, shown.cycles), memory.terms});
  }
  if (n > 1) device_.run(kernel("clear_samples"), over(in_rows), {int32_t(in_rows), memory.term});
  for (int q = 0, pair = 0; q < terms; ++q) {
    for (int p = 0; p < terms - q; ++p, ++pair) {
      device_.run(kernel("take_term"), over(sizes_.pixels()),
                  {int32_t(sizes_.pixels()), int32_t(n), int32_t(pair), memory.terms, memory.term});
      lines_.run(along(weights_x_, width, p, false, p > 0), sizes_.ny, memory.term, memory.rows);
    }
    lines_.transpose(sizes_.ny, width, memory.rows, n > 1 ? memory.columns : memory.spread);
    if (n > 1)
      device_.run(kernel("put_apart"), over(samples), {int32_t(samples), int32_t(n), memory.columns, memory.spread});
    lines_.run(along(weights_y_, height, q, false, q > 0), width, memory.spread, memory.turned);
  }
  lines_.transpose(width, height, memory.turned, u);
  if (gap_re_ != 0 || gap_im_ != 0)
    device_.run(
        kernel("add_gaps"), over(samples),
        {int32_t(samples), whole_gap_re_, whole_gap_im_, int32_t(gap_field_.bytes() > 0), either(gap_field_, u), u});
  illuminate(u, false, false);
}

// The slopes by the phases and amplitudes of a point of all pixels, from the terms'; with crosstalk added up over the
// points of a row.
void DevicePanel::add_point_slopes(int cx, int cy, const Memory& memory) {
  const Pixels& shown = has_blur_ ? memory.blurred : memory.pixels;
  const Pixels& to = has_blur_ ? memory.of_points : memory.of_pixels;
  device_.run(kernel("point_slopes"), over(sizes_.nx, sizes_.ny),
              {pixel(), int32_t(cx), int32_t(cy), shown.cycles, either(shown.amplitudes, shown.cycles),
               either(taps_x_, shown.cycles), projections_, memory.terms, to.cycles, either(to.amplitudes, to.cycles)});
  if (!has_blur_) return;
  for (DeviceBuffer Pixels::*values : {&Pixels::cycles, &Pixels::amplitudes})
    if (values == &Pixels::cycles || has_amplitude_)
      device_.run(kernel("blur_rows_back"), over(sizes_.nx, sizes_.ny),
                  {pixel(), int32_t(cx), taps_x_, to.*values, memory.of_rows.*values});
}

void DevicePanel::add_pattern_slopes(const DevicePattern& pattern, const DeviceSlopes& to, const Memory& memory) {
  const DeviceBuffer& drive = pattern.drive;
  device_.run(
      kernel("pattern_slopes"), over(sizes_.pixels()),
      {response(pattern), float(to.factor), drive, pattern.modulus ? *pattern.modulus : drive, either(stuck_, drive),
       either(knots_, drive), memory.of_pixels.cycles, either(memory.of_pixels.amplitudes, memory.of_pixels.cycles),
       to.drive, to.modulus ? *to.modulus : to.drive});
}

void DevicePanel::add_slopes(const DevicePattern& pattern, const DeviceBuffer& g, const DeviceSlopes& to,
                             Memory& memory) {
  const auto lock = device_.lock();
  make_memory(memory);
  respond(pattern, memory);
  const int n = sizes_.n, width = n * sizes_.nx, height = n * sizes_.ny, terms = sizes_.expansion.terms;
  const size_t in_rows = size_t(width) * size_t(sizes_.ny);
  lines_.transpose(height, width, g, memory.turned);
  illuminate(memory.turned, true, true);
  for (int q = 0, pair = 0; q < terms; ++q) {
    lines_.run(along(weights_y_, height, q, true, false), width, memory.turned, memory.spread);
    if (n > 1)
      device_.run(kernel("put_together"), over(in_rows), {int32_t(in_rows), int32_t(n), memory.spread, memory.columns});
    lines_.transpose(width, sizes_.ny, n > 1 ? memory.columns : memory.spread, memory.rows);
    for (int p = 0; p < terms - q; ++p, ++pair) {
      lines_.run(along(weights_x_, width, p, true, false), sizes_.ny, memory.rows, memory.term);
      device_.run(kernel("put_term"), over(sizes_.pixels()),
                  {int32_t(sizes_.pixels()), int32_t(n), int32_t(pair), int32_t(static_errors_.bytes() > 0),
                   either(static_errors_, memory.term), memory.term, memory.terms});
    }
  }
  for (int cy = 0; cy < sizes_.expansion.points; ++cy) {
    blur_columns(memory.pixels, memory.blurred, cy, false, false);
    for (int cx = 0; cx < sizes_.expansion.points; ++cx) add_point_slopes(cx, cy, memory);
    blur_columns(memory.of_rows, memory.of_pixels, cy, true, cy > 0);
  }
  add_pattern_slopes(pattern, to, memory);
}

}  // namespace holotrace
