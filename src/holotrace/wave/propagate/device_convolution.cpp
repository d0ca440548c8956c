#include "holotrace/wave/propagate/device_convolution.h"

#include <algorithm>
#include <complex>
#include <cstdlib>

#include "holotrace/base/error.h"
#include "holotrace/wave/propagate/convolve.h"
#include "holotrace/wave/propagate/window_transform.h"

namespace holotrace {
namespace {

using Complex = std::complex<float>;

LineFactors factors_of(const DeviceBuffer& values, bool is_conjugate = false) {
  LineFactors factors;
  if (values.bytes() > 0) factors.values = &values;
  factors.is_conjugate = is_conjugate;
  return factors;
}

LineFactors conjugate(LineFactors factors) {
  factors.is_conjugate = !factors.is_conjugate;
  return factors;
}

DeviceBuffer upload_factors(Device& device, const std::vector<Complex>& values) {
  return values.empty() ? DeviceBuffer() : device.upload(values, "the factors of a propagation");
}

}  // namespace

DeviceConvolution::DeviceConvolution(Device& device, const Propagator<float>& p, const std::vector<Vec2>& shifts,
                                     TransferFunction transfer)
    : device_(device), along_x_(p.x), along_y_(p.y), lines_(device), transfer_columns_(p.transfer_columns()) {
  require(p.is_on_lattice(), "expected a propagation between windows of one pitch, got two pitches");
  const auto lock = device_.lock();
  if (transfer == TransferFunction::on_device) {
    transfer_ = device_.make_buffer(size_t(p.transfer_rows()) * size_t(p.transfer_columns()) * sizeof(Complex),
                                    "a transfer function");
    device_.write(transfer_, p.transfer.values.data(), transfer_.bytes());
  }
  for (int part = 0; part < p.x.parts; ++part)
    x_.push_back(make_part(p.x, part, 1.0 / (double(p.x.padded) * p.y.padded)));
  for (int part = 0; part < p.y.parts; ++part) y_.push_back(make_part(p.y, part, 1));
  make_ramps(shifts);
}

DeviceConvolution::Part DeviceConvolution::make_part(const PropagationAxis& axis, int part, double scale) const {
  const AxisPart<float> host(axis, part, scale);
  Part made;
  made.enter = upload_factors(device_, host.enter);
  made.leave = upload_factors(device_, host.leave);
  made.columns = host.columns;
  made.shift = (host.first - part) / axis.parts;
  made.first = host.first;
  return made;
}

void DeviceConvolution::make_ramps(const std::vector<Vec2>& shifts) {
  const PropagationAxis &x = along_x_, &y = along_y_;
  for (const Vec2& shift : shifts) {
    for (Part& part : x_)
      part.ramps.push_back(upload_factors(device_, displacement_ramp<float>(x, shift.x, part.columns, [&](int column) {
                                            return part.first + column * x.parts;
                                          })));
    const int length = y.part_length();
    ramps_y_.push_back(upload_factors(device_, displacement_ramp<float>(y, shift.y, y.padded, [&](int slot) {
                                        return signed_frequency(slot / length + slot % length * y.parts, y.padded);
                                      })));
  }
}

LineFactors DeviceConvolution::transfer_of(const ColumnBand& band) const {
  const int first = x_[band.part].first - (along_x_.is_even ? 0 : along_x_.first);
  return {&transfer_, first + band.first * along_x_.parts, along_x_.parts, transfer_columns_, 0};
}

std::vector<int> DeviceConvolution::transfer_rows(const ColumnBand& band) const {
  const LineFactors factors = transfer_of(band);
  std::vector<int> rows;
  for (int i = 0; i < band.count; ++i) rows.push_back(std::abs(factors.start + i * factors.step));
  return rows;
}

LineFactors DeviceConvolution::ramp_y(size_t shift, size_t part_of_y) const {
  LineFactors factors = factors_of(ramps_y_[shift]);
  factors.offset = int(part_of_y) * along_y_.part_length();
  return factors;
}

DeviceConvolution::Work DeviceConvolution::make_work() const {
  Work work;
  grow(work);
  return work;
}

void DeviceConvolution::grow(Work& work) const {
  size_t columns = 1;
  for (const Part& part : x_) columns = std::max(columns, size_t(part.columns));
  const auto make = [&](int rows, DeviceBuffer& buffer) {
    const size_t bytes = size_t(rows) * columns * sizeof(Complex);
    if (buffer.bytes() >= bytes) return;
    buffer = {};  // released before a larger one is made
    buffer = device_.make_buffer(bytes, "a propagation");
  };
  make(std::max(along_y_.inputs, along_y_.outputs), work.rows);
  make(along_y_.inputs, work.columns);
  make(along_y_.outputs, work.filtered);
}

void DeviceConvolution::enter(const ColumnBand& band, int rows, const DeviceBuffer& from, const DeviceBuffer& to) {
  const PropagationAxis& x = along_x_;
  const Part& part = x_[band.part];
  lines_.run({x.part_length(),
              FftDirection::forward,
              {x.inputs, 0, factors_of(part.enter)},
              {band.count, part.shift + band.first}},
             rows, from, to);
}

void DeviceConvolution::filter(const ColumnBand& band, const LineFactors& transfer, const DeviceBuffer& from,
                               const DeviceBuffer& to, size_t shift) {
  const PropagationAxis& y = along_y_;
  for (size_t i = 0; i < y_.size(); ++i) {
    LineFactors of_part = transfer;
    of_part.offset += int(i) * y.part_length();
    lines_.run({y.part_length(),
                FftDirection::forward,
                {y.inputs, 0, factors_of(y_[i].enter)},
                {y.outputs, y.shift, factors_of(y_[i].leave)},
                of_part,
                i > 0,
                ramp_y(shift, i)},
               band.count, from, to);
  }
}

void DeviceConvolution::leave(const ColumnBand& band, int rows, bool adds, const DeviceBuffer& from,
                              const DeviceBuffer& to, size_t shift) {
  const PropagationAxis& x = along_x_;
  const Part& part = x_[band.part];
  LineFactors ramp = factors_of(part.ramps[shift]);
  ramp.offset = band.first;
  lines_.run({x.part_length(),
              FftDirection::backward,
              {band.count, part.shift + band.first, ramp},
              {x.outputs, x.shift, factors_of(part.leave)},
              {},
              adds},
             rows, from, to);
}

void DeviceConvolution::to_many(const DeviceBuffer& from, const std::vector<DisplacedSamples>& to, const Work& work,
                                const Observer& observer) {
  const PropagationAxis& y = along_y_;
  bool is_first = true;
  for (size_t part = 0; part < x_.size(); ++part) {
    const ColumnBand all{part, 0, x_[part].columns};
    if (all.count == 0) continue;
    enter(all, y.inputs, from, work.rows);
    lines_.transpose(y.inputs, all.count, work.rows, work.columns);
    for (const DisplacedSamples& there : to) {
      filter(all, transfer_of(all), work.columns, work.filtered, there.shift);
      lines_.transpose(all.count, y.outputs, work.filtered, work.rows);
      leave(all, y.outputs, !is_first, work.rows, *there.samples, there.shift);
    }
    if (is_first && x_.size() > 1 && observer.on_progress) {
      device_.finish();
      observer.progress(0.5);
    }
    is_first = false;
  }
}

void DeviceConvolution::to_sum(const std::vector<DisplacedSamples>& from, const DeviceBuffer& to, const Work& work) {
  const PropagationAxis &x = along_x_, &y = along_y_;
  bool is_first = true;
  for (size_t p = 0; p < x_.size(); ++p) {
    const Part& part = x_[p];
    if (part.columns == 0) continue;
    const LineFactors transfer = transfer_of({p, 0, part.columns});
    bool adds = false;
    for (const DisplacedSamples& there : from) {
      lines_.run({x.part_length(),
                  FftDirection::forward,
                  {x.outputs, x.shift, factors_of(part.leave, true)},
                  {part.columns, part.shift, factors_of(part.ramps[there.shift], true)}},
                 y.outputs, *there.samples, work.rows);
      lines_.transpose(y.outputs, part.columns, work.rows, work.filtered);
      for (size_t i = 0; i < y_.size(); ++i) {
        LineFactors of_part = transfer;
        of_part.offset += int(i) * y.part_length();
        lines_.run({y.part_length(),
                    FftDirection::forward,
                    {y.outputs, y.shift, factors_of(y_[i].leave, true)},
                    {y.inputs, 0, factors_of(y_[i].enter, true)},
                    conjugate(of_part),
                    adds,
                    conjugate(ramp_y(there.shift, i))},
                   part.columns, work.filtered, work.columns);
        adds = true;
      }
    }
    lines_.transpose(part.columns, y.inputs, work.columns, work.rows);
    lines_.run({x.part_length(),
                FftDirection::backward,
                {part.columns, part.shift},
                {x.inputs, 0, factors_of(part.enter, true)},
                {},
                !is_first},
               y.inputs, work.rows, to);
    is_first = false;
  }
}

DeviceWindows::DeviceWindows(Device& device, const Propagator<float>& plan)
    : device_(device), x_(plan.x), y_(plan.y), lines_(device), to_x_(make_window(plan.x)), to_y_(make_window(plan.y)) {}

DeviceWindows::Window DeviceWindows::make_window(const PropagationAxis& axis) {
  const auto lock = device_.lock();
  const WindowSum<float> host(axis);
  Window window{device_.upload(host.enter(), "the factors of a propagation"),
                {},
                device_.upload(host.leave(), "the factors of a propagation"),
                host.length(),
                host.is_plain()};
  if (!host.is_plain()) window.chirp = device_.upload(host.chirp(), "the factors of a propagation");
  return window;
}

void DeviceWindows::enter(const ColumnBand& band, int rows, const DeviceBuffer& from, const DeviceBuffer& to) {
  lines_.run({x_.padded, FftDirection::forward, {x_.inputs}, {band.count, x_.first + band.first}}, rows, from, to);
}

void DeviceWindows::filter(const ColumnBand& band, const LineFactors& transfer, const DeviceBuffer& from,
                           const DeviceBuffer& bins, const DeviceBuffer& to) {
  lines_.run({y_.padded, FftDirection::forward, {y_.inputs}, {y_.frequencies(), y_.first, transfer}}, band.count, from,
             bins);
  sum(to_y_, y_, {0, 0, y_.frequencies()}, band.count, false, bins, to);
}

void DeviceWindows::leave(const ColumnBand& band, int rows, bool adds, const DeviceBuffer& from,
                          const DeviceBuffer& to) {
  sum(to_x_, x_, band, rows, adds, from, to);
}

void DeviceWindows::sum(const Window& window, const PropagationAxis& axis, const ColumnBand& frequencies, int lines,
                        bool adds, const DeviceBuffer& from, const DeviceBuffer& to) {
  LineTransform t{.length = window.length,
                  .direction = window.is_plain ? FftDirection::backward : FftDirection::forward,
                  .in = {frequencies.count,
                         frequencies.first + (window.is_plain ? axis.first : 0),
                         {.values = &window.enter, .offset = frequencies.first}},
                  .out = {axis.outputs, 0, {.values = &window.leave}},
                  .adds = adds};
  if (!window.is_plain) t.filter = {.values = &window.chirp};
  lines_.run(t, lines, from, to);
}

}  // namespace holotrace
