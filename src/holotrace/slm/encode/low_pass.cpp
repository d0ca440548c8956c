#include "holotrace/slm/encode/low_pass.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <memory>
#include <utility>
#include <vector>

#include "holotrace/base/fft.h"
#include "holotrace/base/threads.h"
#include "holotrace/data/params/encode.h"
#include "holotrace/slm/encode/shown_pixels.h"
#include "holotrace/wave/transform/line_transform.h"

namespace holotrace {

SpectralFilter low_pass_stop(const EncodeParams& params, const Grid& grid) {
  const double half = stop_width(params) / (2 * grid.pitch);
  return {0, 0, half, half};
}

Field within_stop(const Field& field, const SpectralFilter& stop, const Observer& observer) {
  const int nx = field.grid.nx, ny = field.grid.ny;
  Field inside = field;
  fft_2d(inside.samples.values.data(), ny, nx, FftDirection::forward);
  const float scale = 1 / float(field.grid.pixels());
  const FrequencyBand x = band_within(nx, field.grid.width(), stop.half_u),
                      y = band_within(ny, field.grid.height(), stop.half_v);
  parallel_for(0, ny, [&](int64_t j) {
    std::complex<float>* u = inside.samples.row(int(j));
    const bool is_row_in = y.holds(signed_frequency(int(j), ny));
    for (int i = 0; i < nx; ++i) u[i] = is_row_in && x.holds(signed_frequency(i, nx)) ? u[i] * scale : 0;
  });
  fft_2d(inside.samples.values.data(), ny, nx, FftDirection::backward);
  const double all = power(field);
  observer.fact("band_power", Fact(all > 0 ? power(inside) / all : 1.0));
  return inside;
}

double normalise_modulus(double clipped_pixels, const Observer& observer, Field& field) {
  double largest = 0, square = 0;
  for (const auto& u : field.samples.values) {
    largest = std::max(largest, double(std::abs(u)));
    square += double(std::norm(u));
  }
  double top = largest;
  if (clipped_pixels > 0 && largest > 0) {
    std::vector<int64_t> counts(modulus_steps + 1);
    for (const auto& u : field.samples.values) ++counts[size_t(std::abs(u) / largest * modulus_steps)];
    top = modulus_to_clip(counts, largest, clipped_pixels * double(field.samples.size()));
  }
  double clipped = 0;
  for (auto& u : field.samples.values) {
    const double modulus = std::abs(u);
    if (modulus > top) clipped += modulus * modulus - top * top;
    u = modulus > 0 ? std::complex<float>(std::complex<double>(u) / std::max(top, modulus)) : 0;
  }
  tell_clipping(top, square > 0 ? clipped / square : 0, observer);
  return top;
}

double modulus_to_clip(const std::vector<int64_t>& counts, double largest, double clipped_pixels) {
  const int steps = int(counts.size()) - 1;
  int step = steps;
  for (; step > 1 && clipped_pixels >= double(counts[size_t(step)]); --step)
    clipped_pixels -= double(counts[size_t(step)]);
  return std::min(largest * (step + 1.0) / steps, largest);
}

void tell_clipping(double modulus, double clipped_part, const Observer& observer) {
  observer.fact("modulus_max", Fact(modulus));
  observer.fact("clipped_part", Fact(clipped_part));
}

namespace {

using Complex = std::complex<float>;

// The part of a field's spectrum that passes a stop, times `unit`. Its rows are transformed first, then its columns, and back
// in the other order: band by band, and as many columns at a time as there are parts. In between, `there` has all of it for one
// part; otherwise `here` has it on the processor. The transforms do not divide by the number of samples.
class PassingSpectrum {
 public:
  PassingSpectrum(const ShownPixels<DeviceSamples>& shown, const SpectralFilter& stop)
      : field_(shown.field),
        moments_(shown.moments),
        device_(*field_.device),
        grid_(field_.head.grid),
        pass_(pass_band(grid_, stop)),
        lines_(device_) {
    if (field_.here) here_ = Array2D<Complex>(grid_.ny, pass_.x.count);
    transform_rows();
  }

  double unit() const { return double(unit_); }

  // The fraction of the field's power within the stop, by Parseval's theorem. The columns are transformed, and back if they are
  // to return.
  double pass_columns(bool return_them);

  // The field within the stop, times unit·(number of samples).
  DeviceSamples to_field();

 private:
  size_t bytes(int rows, int columns) const { return size_t(rows) * size_t(columns) * sizeof(Complex); }
  DeviceBuffer make(int rows, int columns) { return device_.make_buffer(bytes(rows, columns), "a stop"); }
  bool is_whole() const { return field_.there != nullptr; }
  void transform_rows();
  void send_columns(int first, int count, const DeviceBuffer& to);
  void fetch_columns(int first, int count, const DeviceBuffer& from);

  const DeviceSamples& field_;
  const ModulusMoments moments_;
  Device& device_;
  const Grid grid_;
  const PassBand pass_;
  const float unit_ = unit_for(moments_.largest);
  LineTransforms lines_;
  DeviceBuffer there_;
  Array2D<Complex> here_;
  std::vector<Complex> columns_;
};

void PassingSpectrum::transform_rows() {
  const DeviceBuffer scales = device_.upload(std::vector<Complex>(size_t(grid_.nx), unit_), "a stop");
  const LineTransform along{grid_.nx, FftDirection::forward, {grid_.nx, 0, {&scales}}, {pass_.x.count, pass_.x.first}};
  each_band(field_, [&](const DeviceField& band, int first) {
    const int rows = band.head.grid.ny;
    DeviceBuffer part = make(rows, pass_.x.count);
    lines_.run(along, rows, band.samples, part);
    if (is_whole())
      there_ = std::move(part);
    else
      device_.read(part, here_.size() > 0 ? here_.row(first) : nullptr, part.bytes());
  });
  device_.finish();  // before the scales are released
}

void PassingSpectrum::send_columns(int first, int count, const DeviceBuffer& to) {
  columns_.resize(size_t(count) * size_t(here_.ny));
  for (int j = 0; j < here_.ny; ++j) std::copy_n(here_.row(j) + first, count, columns_.begin() + int64_t(j) * count);
  device_.write(to, columns_.data(), bytes(grid_.ny, count));
}

void PassingSpectrum::fetch_columns(int first, int count, const DeviceBuffer& from) {
  device_.read(from, columns_.data(), bytes(grid_.ny, count));
  for (int j = 0; j < here_.ny; ++j) std::copy_n(columns_.begin() + int64_t(j) * count, count, here_.row(j) + first);
}

double PassingSpectrum::pass_columns(bool return_them) {
  const int most = field_.columns_at_once(pass_.x.count);
  const LineTransform forward{grid_.ny, FftDirection::forward, {grid_.ny}, {pass_.y.count, pass_.y.first}},
      backward{grid_.ny, FftDirection::backward, {pass_.y.count, pass_.y.first}, {grid_.ny}};
  DeviceField bins{&device_, {}, is_whole() ? std::move(there_) : make(grid_.ny, most)};
  bins.head.grid.nx = pass_.y.count;
  const DeviceBuffer turned = make(grid_.ny, most);
  double inside = 0;
  for (int first = 0; first < pass_.x.count; first += most) {
    const int count = std::min(most, pass_.x.count - first);
    if (!is_whole()) send_columns(first, count, bins.samples);
    lines_.transpose(grid_.ny, count, bins.samples, turned);
    lines_.run(forward, count, turned, bins.samples);
    bins.head.grid.ny = count;
    inside += energy(bins, {0, pass_.y.count, 0, count});
    if (!return_them) continue;
    lines_.run(backward, count, bins.samples, turned);
    lines_.transpose(count, grid_.ny, turned, bins.samples);
    if (!is_whole()) fetch_columns(first, count, bins.samples);
  }
  device_.finish();  // before the work space is released
  if (is_whole()) there_ = std::move(bins.samples);
  columns_ = {};
  const double all = moments_.square * unit() * unit();
  return all > 0 ? inside / (all * double(grid_.pixels())) : 1.0;
}

DeviceSamples PassingSpectrum::to_field() {
  const LineTransform along{grid_.nx, FftDirection::backward, {pass_.x.count, pass_.x.first}, {grid_.nx}};
  if (is_whole()) {
    DeviceField inside = make_device_field(device_, field_.head, "a field within a stop");
    lines_.run(along, grid_.ny, there_, inside.samples);
    device_.finish();  // before the spectrum is released
    return DeviceSamples::whole(std::make_shared<const DeviceField>(std::move(inside)));
  }
  DeviceSamples inside{.device = &device_, .head = field_.head, .parts = field_.parts};
  const auto light = std::make_shared<Field>(field_.head);
  if (field_.here) light->samples = Array2D<Complex>(grid_.ny, grid_.nx);
  for (int first = 0; first < grid_.ny; first += field_.rows_at_once()) {
    const int rows = std::min(field_.rows_at_once(), grid_.ny - first);
    const DeviceBuffer from = make(rows, pass_.x.count), to = make(rows, grid_.nx);
    device_.write(from, field_.here ? here_.row(first) : nullptr, from.bytes());
    lines_.run(along, rows, from, to);
    device_.read(to, field_.here ? light->samples.row(first) : nullptr, to.bytes());
  }
  if (field_.here) inside.here = light;
  return inside;
}

}  // namespace

Scaled<DeviceSamples> within_stop(const ShownPixels<DeviceSamples>& shown, const SpectralFilter& stop,
                                  const Observer& observer) {
  const auto lock = shown.field.device->lock();
  PassingSpectrum spectrum(shown, stop);
  observer.fact("band_power", Fact(spectrum.pass_columns(true)));
  return {spectrum.to_field(), spectrum.unit() * double(shown.field.head.grid.pixels())};
}

double normalise_modulus(double clipped_pixels, const Observer& observer, Scaled<DeviceSamples>& field) {
  const ModulusMoments moments = modulus_moments(field.light);
  double top = moments.largest;
  if (clipped_pixels > 0 && top > 0)
    top = modulus_to_clip(count_moduli(field.light, top, modulus_steps), top,
                          clipped_pixels * double(field.light.head.grid.pixels()));
  const double clipped = clip_moduli(field.light, top);
  tell_clipping(top / field.scale, moments.square > 0 ? clipped / moments.square : 0, observer);
  return top / field.scale;
}

double power_inside(const ShownPixels<DeviceSamples>& shown, const SpectralFilter& filter) {
  const auto lock = shown.field.device->lock();
  return PassingSpectrum(shown, filter).pass_columns(false);
}

}  // namespace holotrace
