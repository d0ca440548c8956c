#include "holotrace/denoise/denoise.h"

#include <algorithm>
#include <cmath>
#include <exception>
#include <memory>
#include <string>
#include <vector>

#include "holotrace/base/error.h"
#include "holotrace/base/machine.h"
#include "holotrace/base/threads.h"
#include "holotrace/denoise/oidn.h"

namespace holotrace {
namespace {

size_t pixels_of(const Image& image) { return size_t(image.nx) * size_t(image.ny); }

void check_picture(const Image& picture) {
  require(picture.nx > 0 && picture.ny > 0 && (picture.channels == 1 || picture.channels == 3) &&
              picture.values.size() == pixels_of(picture) * size_t(picture.channels),
          "expected a picture of 1 or 3 channels to denoise, got {} x {} pixels and {} channel(s)", picture.nx,
          picture.ny, picture.channels);
  for (const float value : picture.values)
    require(std::isfinite(value) && value >= 0,
            "expected finite light of 0 or more in a picture to denoise, got {}; set such pixels to 0", value);
}

void check_guide(const Image& guide, const Image& picture, const char* name) {
  require(guide.nx == picture.nx && guide.ny == picture.ny && guide.channels == 3 &&
              guide.values.size() == 3 * pixels_of(picture),
          "expected {} on the picture's {} x {} pixels, in three channels, got {} x {} and {}", name, picture.nx,
          picture.ny, guide.nx, guide.ny, guide.channels);
  for (const float value : guide.values)
    require(std::isfinite(value), "expected finite {}, got {}; set such pixels to 0", name, value);
}

/// Pixels of a picture: columns [left, right) and rows [top, bottom).
struct Part {
  int left = 0, top = 0, right = 0, bottom = 0;

  int columns() const { return right - left; }
  int rows() const { return bottom - top; }
};

// The smallest part with all of the light, and a margin.
Part lit_part(const Image& image) {
  constexpr int margin = 16;
  Part part{image.nx, image.ny, 0, 0};
  for (int row = 0; row < image.ny; ++row)
    for (int column = 0; column < image.nx; ++column) {
      const float* pixel = &image(row, column, 0);
      if (std::all_of(pixel, pixel + image.channels, [](float value) { return value == 0; })) continue;
      part = {std::min(part.left, column), std::min(part.top, row), std::max(part.right, column + 1),
              std::max(part.bottom, row + 1)};
    }
  if (part.right == 0) return {};
  return {std::max(0, part.left - margin), std::max(0, part.top - margin), std::min(image.nx, part.right + margin),
          std::min(image.ny, part.bottom + margin)};
}

// Passes progress on. What an observer throws waits here until the library has returned.
struct Progress {
  const Observer& observer;
  std::exception_ptr thrown{};

  static bool goes_on(void* user, double fraction) {
    auto& progress = *static_cast<Progress*>(user);
    try {
      if (!progress.thrown) progress.observer.progress(fraction);
    } catch (...) {
      progress.thrown = std::current_exception();
    }
    return !progress.thrown;
  }
};

/// The library's device for processors, and its networks.
class Networks {
 public:
  Networks(const Part& part, DenoiseQuality quality)
      : oidn_(open_oidn().functions),
        device_(oidn_.oidnNewDevice(Oidn::cpu), oidn_.oidnReleaseDevice),
        part_(part),
        quality_(quality == DenoiseQuality::fast ? Oidn::fast : Oidn::high) {
    oidn_.oidnSetDeviceInt(device_.get(), "numThreads", thread_count());
    oidn_.oidnSetDeviceBool(device_.get(), "setAffinity", false);  // the threads have other work, too
    oidn_.oidnCommitDevice(device_.get());
  }

  struct Input {
    const char* name;  // "color", "albedo" or "normal"
    const Image& image;
  };

  // The first input without noise, in the part of the picture; outside of it as it is.
  Image run(const std::vector<Input>& inputs, const Observer& observer) const {
    Image output = inputs.front().image;
    const std::unique_ptr<OidnFilter, decltype(oidn_.oidnReleaseFilter)> filter(
        oidn_.oidnNewFilter(device_.get(), "RT"), oidn_.oidnReleaseFilter);
    for (const Input& input : inputs) set_image(filter.get(), input.name, input.image);
    set_image(filter.get(), "output", output);
    const bool is_light = std::string(inputs.front().name) == "color";
    oidn_.oidnSetFilterBool(filter.get(), "hdr", is_light);
    oidn_.oidnSetFilterBool(filter.get(), "cleanAux", is_light && inputs.size() > 1);
    oidn_.oidnSetFilterInt(filter.get(), "quality", quality_);
    // [MB] Larger pictures are denoised in parts that overlap. Fast ones are for many planes, beside a hologram's arrays.
    oidn_.oidnSetFilterInt(filter.get(), "maxMemoryMB", quality_ == Oidn::fast ? 400 : 1200);
    Progress progress{observer};
    oidn_.oidnSetFilterProgressMonitorFunction(filter.get(), &Progress::goes_on, &progress);
    oidn_.oidnCommitFilter(filter.get());
    oidn_.oidnExecuteFilter(filter.get());
    if (progress.thrown) std::rethrow_exception(progress.thrown);
    const char* message = nullptr;
    const int error = oidn_.oidnGetDeviceError(device_.get(), &message);
    require(error == Oidn::none,
            "expected Open Image Denoise to denoise a picture of {} x {} pixels, got \"{}\"; {}use denoise = none",
            output.nx, output.ny, message ? message : "", error == Oidn::out_of_memory ? "free memory, or " : "");
    return output;
  }

 private:
  void set_image(Oidn::Filter filter, const char* name, const Image& image) const {
    const size_t pixel = sizeof(float) * size_t(image.channels), row = pixel * size_t(image.nx);
    oidn_.oidnSetSharedFilterImage(filter, name, const_cast<float*>(image.values.data()),
                                   image.channels == 1 ? Oidn::one_float : Oidn::rgb, size_t(part_.columns()),
                                   size_t(part_.rows()), row * size_t(part_.top) + pixel * size_t(part_.left), pixel,
                                   row);
  }

  Oidn oidn_;
  std::unique_ptr<OidnDevice, decltype(Oidn::oidnReleaseDevice)> device_;
  Part part_;
  int quality_;
};

/// Light of one channel around each pixel of a part, row by row: sums over the pixels of a square, weighted by a tent along each
/// side.
std::vector<double> light_around(const Image& image, const Part& part, int channel) {
  constexpr int radius = 8;  // of each of two boxes that make the tent
  const int columns = part.columns(), rows = part.rows();
  std::vector<double> light(size_t(columns) * size_t(rows)), before(light.size());
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column)
      light[size_t(row) * size_t(columns) + size_t(column)] = image(part.top + row, part.left + column, channel);
  // Replaces each of `count` runs of `width` values by the sum over the runs around it.
  const auto sum_boxes = [&](double* values, const double* given, int count, int width) {
    std::vector<double> sum(size_t(width), 0);
    const auto add = [&](int run, double sign) {
      if (run < 0 || run >= count) return;
      const double* from = given + size_t(run) * size_t(width);
      for (int i = 0; i < width; ++i) sum[size_t(i)] += sign * from[i];
    };
    for (int run = 0; run < radius; ++run) add(run, 1);
    for (int run = 0; run < count; ++run) {
      add(run + radius, 1);
      add(run - radius - 1, -1);
      std::copy(sum.begin(), sum.end(), values + size_t(run) * size_t(width));
    }
  };
  for (int pass = 0; pass < 2; ++pass) {
    before = light;
    sum_boxes(light.data(), before.data(), rows, columns);
    before = light;
    for (int row = 0; row < rows; ++row)
      sum_boxes(&light[size_t(row) * size_t(columns)], &before[size_t(row) * size_t(columns)], columns, 1);
  }
  return light;
}

// Gives each neighbourhood the light that it had.
void keep_means(const Image& noisy, const Part& part, Image& denoised) {
  constexpr double least = 0.8, most = 1.25;  // one very bright pixel does not brighten its neighbourhood
  parallel_for(0, noisy.channels, [&](int64_t channel) {
    const std::vector<double> wanted = light_around(noisy, part, int(channel));
    const std::vector<double> found = light_around(denoised, part, int(channel));
    for (int row = part.top; row < part.bottom; ++row)
      for (int column = part.left; column < part.right; ++column) {
        const size_t i = size_t(row - part.top) * size_t(part.columns()) + size_t(column - part.left);
        if (found[i] > 0) denoised(row, column, int(channel)) *= float(std::clamp(wanted[i] / found[i], least, most));
      }
  });
}

// Of a grey picture, one channel, or of one channel a grey picture.
Image with_channels(const Image& image, int channels) {
  Image other(image.ny, image.nx, channels);
  other.pitch = image.pitch;
  other.centre_x = image.centre_x;
  other.centre_y = image.centre_y;
  for (size_t i = 0; i < other.values.size(); ++i)
    other.values[i] = image.values[i / size_t(channels) * size_t(image.channels)];
  return other;
}

}  // namespace

bool is_grey(const Image& image) {
  if (image.channels != 3) return false;
  for (size_t i = 0; i < image.values.size(); i += 3)
    if (image.values[i] != image.values[i + 1] || image.values[i] != image.values[i + 2]) return false;
  return true;
}

Image denoise(const Image& radiance, const DenoiseGuides& guides, DenoiseQuality quality, const Observer& observer) {
  check_picture(radiance);
  if (is_grey(radiance)) return with_channels(denoise(with_channels(radiance, 1), guides, quality, observer), 3);
  const bool is_guided = !guides.albedo.values.empty() || !guides.normals.values.empty();
  if (is_guided) {
    check_guide(guides.albedo, radiance, "albedo");
    check_guide(guides.normals, radiance, "normals");
  }
  constexpr int fewest = 16;  // the network halves the picture four times
  const Part part = lit_part(radiance);
  const Networks networks(part, quality);
  if (part.columns() < fewest || part.rows() < fewest) return radiance;
  Image denoised;
  if (is_guided) {
    const Image albedo = networks.run({{"albedo", guides.albedo}}, part_of(observer, 0, 3));
    const Image normals = networks.run({{"normal", guides.normals}}, part_of(observer, 1, 3));
    denoised = networks.run({{"color", radiance}, {"albedo", albedo}, {"normal", normals}}, part_of(observer, 2, 3));
  } else {
    denoised = networks.run({{"color", radiance}}, observer);
  }
  for (float& value : denoised.values) value = std::max(0.0F, value);
  keep_means(radiance, part, denoised);
  return denoised;
}

}  // namespace holotrace
