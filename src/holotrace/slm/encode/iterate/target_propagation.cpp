#include "holotrace/slm/encode/iterate/target_propagation.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "holotrace/base/cycles.h"
#include "holotrace/base/error.h"
#include "holotrace/base/fft.h"
#include "holotrace/slm/panel/pixel_kernel.h"
#include "holotrace/wave/propagate/convolve.h"
#include "holotrace/wave/propagate/propagator.h"

namespace holotrace {
namespace {

std::vector<Vec2> places_of(PixelSamples samples) {
  switch (samples) {
    case PixelSamples::middle:
      return {{0, 0}};
    case PixelSamples::diagonal:
      return {{-0.25, -0.25}, {0.25, 0.25}};
    case PixelSamples::four:
      return {{-0.25, -0.25}, {0.25, -0.25}, {-0.25, 0.25}, {0.25, 0.25}};
  }
  return {};
}

Grid finer(Grid grid, int subpixels) {
  grid.nx *= subpixels;
  grid.ny *= subpixels;
  grid.pitch /= subpixels;
  return grid;
}

}  // namespace

TargetPropagation::TargetPropagation(const Slm& slm, double wavelength, double z, const TargetOptics& optics)
    : shifts_(places_of(optics.samples)) {
  const Grid grid = finer(slm.grid, optics.subpixels);
  const double samples = double(shifts_.size()) * optics.subpixels * optics.subpixels;
  const double scale = std::pow(samples, -0.25);  // along each axis: T holds 1/√samples
  const auto passing = [&](double lit) {
    return [=](double f) {
      const double in_pixels = f * optics.subpixels;
      const double dimmed = optics.aperture == PixelAperture::included ? aperture_spectrum(in_pixels, lit) : 1;
      const bool is_inside = optics.stop >= 1 || in_pixels <= optics.stop / 2 * (1 + 1e-9);
      return is_inside ? scale * dimmed : 0;
    };
  };
  there_ = make_propagator<float>(grid, wavelength, z);
  if (optics.aperture == PixelAperture::included || optics.stop < 1 || samples > 1)
    filter_transfer<float>(there_, passing(slm.lit_x()), passing(slm.lit_y()));
}

std::vector<size_t> samples_of(SampleGroup group, size_t count) {
  std::vector<size_t> all(count);
  std::iota(all.begin(), all.end(), size_t(0));
  if (group == SampleGroup::all) return all;
  require(count == 4, "expected four samples per pixel for a group of them, got {}", count);
  if (group == SampleGroup::falling) return {0, 3};
  if (group == SampleGroup::rising) return {1, 2};
  return {size_t(group) - size_t(SampleGroup::first)};
}

std::vector<Vec2> TargetPropagation::shifts_of(SampleGroup group) const {
  std::vector<Vec2> shifts;
  for (const size_t sample : samples_of(group, shifts_.size())) shifts.push_back(shifts_[sample]);
  return shifts;
}

std::vector<Field> TargetPropagation::to_plane(const Field& panel, SampleGroup group) const {
  std::vector<ConvolutionLink<float>> links;
  for (const Vec2& shift : shifts_of(group)) links.push_back({&there_, false, shift.x, shift.y});
  return convolve_to_many(panel, links);
}

Field TargetPropagation::to_panel(const std::vector<Field>& plane, SampleGroup group) const {
  const std::vector<Vec2> shifts = shifts_of(group);
  std::vector<ConvolutionLink<float>> links;
  std::vector<const Field*> fields;
  for (size_t i = 0; i < plane.size(); ++i) {
    links.push_back({&there_, true, -shifts[i].x, -shifts[i].y});
    fields.push_back(&plane[i]);
  }
  return convolve_to_sum(fields, links);
}

namespace {

int transform_length(const Pupil& pupil, double pitch) {
  return fft_good_length(int(std::ceil(2 * pupil.diameter / pitch)) + 2);
}

double distance_to(const Pupil& pupil, double z) { return pupil.centre.z - z; }

// The samples of a window that lie in a pupil, row by row, each with the phase that the transform needs.
class PupilSamples {
 public:
  PupilSamples(const Grid& eye, double wavelength, const Pupil& pupil, double z)
      : length(transform_length(pupil, eye.pitch)), grid_(eye), pupil_(pupil) {
    const double s = distance_to(pupil, z), turns = 1 / (wavelength * s), pitch = eye.pitch;
    scale = float(pitch * pitch / (wavelength * s));
    const auto phases = [&](double centre, double (Grid::*place)(double) const, int count) {
      std::vector<std::complex<double>> values;
      for (int i = 0; i < count; ++i) {
        const double offset = (grid_.*place)(i)-centre;
        values.push_back(cis_cycles(-turns * (offset * offset / 2 + centre * offset)));
      }
      return values;
    };
    along_x_ = phases(pupil.centre.x, &Grid::x, eye.nx);
    along_y_ = phases(pupil.centre.y, &Grid::y, eye.ny);
    first_x_ = nearest((pupil.centre.x - grid_.x(0)) / pitch);
    first_y_ = nearest((grid_.y(0) - pupil.centre.y) / pitch);
  }

  // Calls work(row, column, place in the transform, phase) for each sample.
  template <class Work>
  void each(const Work& work) const {
    const double radius = pupil_.diameter / 2;
    const int reach = int(std::ceil(radius / grid_.pitch)) + 1;
    for (int j = std::max(0, first_y_ - reach); j <= std::min(grid_.ny - 1, first_y_ + reach); ++j)
      for (int i = std::max(0, first_x_ - reach); i <= std::min(grid_.nx - 1, first_x_ + reach); ++i) {
        if (std::hypot(grid_.x(i) - pupil_.centre.x, grid_.y(j) - pupil_.centre.y) > radius) continue;
        const size_t at =
            size_t(wrapped(j - first_y_, length)) * size_t(length) + size_t(wrapped(i - first_x_, length));
        work(j, i, at, std::complex<float>(along_x_[size_t(i)] * along_y_[size_t(j)]));
      }
  }

  PupilWindow window() const {
    const size_t places = size_t(length);
    PupilWindow window{.length = length,
                       .first_x = first_x_,
                       .first_y = first_y_,
                       .scale = scale,
                       .along_x = std::vector<std::complex<float>>(places),
                       .along_y = std::vector<std::complex<float>>(places),
                       .spans = std::vector<std::array<int32_t, 2>>(places)};
    each([&](int j, int i, size_t at, std::complex<float>) {
      const size_t row = at / places, column = at % places;
      window.along_x[column] = std::complex<float>(along_x_[size_t(i)]);
      window.along_y[row] = std::complex<float>(along_y_[size_t(j)]);
      std::array<int32_t, 2>& span = window.spans[row];
      if (span[0] == span[1]) span = {i, i};
      span[1] = i + 1;
    });
    return window;
  }

  int length;
  float scale;

 private:
  static int nearest(double place) { return int(std::lround(place)); }

  const Grid& grid_;
  const Pupil& pupil_;
  std::vector<std::complex<double>> along_x_, along_y_;
  int first_x_ = 0, first_y_ = 0;
};

// Calls work(row, column, place in the transform) for the samples of a picture. Rows go down, as in the pupil.
template <class Work>
void each_of_picture(const Grid& picture, int length, const Work& work) {
  for (int j = 0; j < picture.ny; ++j)
    for (int i = 0; i < picture.nx; ++i)
      work(j, i,
           size_t(wrapped(j - picture.ny / 2, length)) * size_t(length) + size_t(wrapped(i - picture.nx / 2, length)));
}

}  // namespace

PupilPropagation::PupilPropagation(const Slm& slm, double wavelength, const Grid& window, double z,
                                   const TargetOptics& optics) {
  require(optics.subpixels == 1,
          "expected one sample per pixel for views through pupils, got {} per axis; give "
          "subpixels = 1",
          optics.subpixels);
  PropagateParams to_window;
  to_window.columns = window.nx;
  to_window.rows = window.ny;
  to_window.centre_x = window.centre_x;
  to_window.centre_y = window.centre_y;
  there_ = make_propagator<float>(slm.grid, wavelength, z, to_window);
  const auto passing = [&](double lit) {
    return [=](double f) {
      const double dimmed = optics.aperture == PixelAperture::included ? aperture_spectrum(f, lit) : 1;
      return optics.stop >= 1 || f <= optics.stop / 2 * (1 + 1e-9) ? dimmed : 0;
    };
  };
  filter_transfer<float>(there_, passing(slm.lit_x()), passing(slm.lit_y()));
  back_ = adjoint_of(there_);
}

const PupilPropagation& PupilPropagations::to(const Slm& slm, double wavelength, const ViewTargets& views,
                                              const TargetOptics& optics) {
  const double z = views.pupils.front().centre.z;
  for (const PupilPropagation& made : made_)
    if (made.there().output == views.window && made.there().distance == z) return made;
  return made_.emplace_back(slm, wavelength, views.window, z, optics);
}

Field PupilPropagation::to_eye(const Field& panel) const { return convolve(panel, there_, {}); }

Field PupilPropagation::to_panel(const Field& eye) const { return convolve(eye, back_, {}); }

Grid pupil_window_grid(const Grid& panel, const PlanePart& part) {
  const auto samples = [&](double low, double high) { return int(std::ceil((high - low) / panel.pitch)) + 1; };
  const int nx = samples(part.low.x, part.high.x), ny = samples(part.low.y, part.high.y);
  // The middle that is nearest to that of the part, so that samples are some steps from those of the panel.
  const auto middle = [&](double wanted, int count, double panel_centre, int panel_count) {
    const double offset = ((count - panel_count) % 2 == 0 ? 0 : 0.5) * panel.pitch;
    return panel_centre + offset + std::round((wanted - panel_centre - offset) / panel.pitch) * panel.pitch;
  };
  return {nx, ny, panel.pitch, middle((part.low.x + part.high.x) / 2, nx, panel.centre_x, panel.nx),
          middle((part.low.y + part.high.y) / 2, ny, panel.centre_y, panel.ny)};
}

Grid picture_grid(const Grid& panel, double width, double height, const Pupil& pupil, double wavelength, double z) {
  const int length = transform_length(pupil, panel.pitch);
  const double pitch = wavelength * distance_to(pupil, z) / (length * panel.pitch);
  const auto odd = [&](double side) { return 2 * int(side / (2 * pitch)) + 1; };
  return {odd(width), odd(height), pitch};
}

PupilWindow pupil_window(const Grid& eye, double wavelength, const Pupil& pupil, double z) {
  return PupilSamples(eye, wavelength, pupil, z).window();
}

Array2D<std::complex<float>> take_picture(const Field& eye, const Pupil& pupil, double z, const Grid& picture) {
  const PupilSamples samples(eye.grid, eye.wavelength, pupil, z);
  const size_t length = size_t(samples.length);
  Array2D<std::complex<float>> light(samples.length, samples.length);
  samples.each([&](int j, int i, size_t at, std::complex<float> phase) {
    light.values[at] = eye.samples(j, i) * phase * samples.scale;
  });
  fft_2d(light.values.data(), int(length), int(length), FftDirection::backward);
  Array2D<std::complex<float>> taken(picture.ny, picture.nx);
  each_of_picture(picture, samples.length, [&](int j, int i, size_t at) { taken(j, i) = light.values[at]; });
  return taken;
}

void add_picture_adjoint(const Array2D<std::complex<float>>& light, const Pupil& pupil, double z, const Grid& picture,
                         Field& eye) {
  const PupilSamples samples(eye.grid, eye.wavelength, pupil, z);
  Array2D<std::complex<float>> wide(samples.length, samples.length);
  each_of_picture(picture, samples.length, [&](int j, int i, size_t at) { wide.values[at] += light(j, i); });
  fft_2d(wide.values.data(), samples.length, samples.length, FftDirection::forward);
  samples.each([&](int j, int i, size_t at, std::complex<float> phase) {
    eye.samples(j, i) += wide.values[at] * std::conj(phase) * samples.scale;
  });
}

}  // namespace holotrace
