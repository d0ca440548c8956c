#include "holotrace/run/reference_metrics.h"

#include <algorithm>
#include <cmath>

#include "holotrace/view/compare.h"

namespace holotrace {
namespace {

double decibels(double ratio_of_amplitudes) { return 20 * std::log10(ratio_of_amplitudes); }

struct Noise {
  double variance = 0, of_bright = 0;  // over all pixels, and over the bright ones
};

Noise noise_of(const ViewReference& reference, double peak) {
  Noise noise;
  double bright = 0;
  for (size_t i = 0; i < reference.image.values.size(); ++i) {
    const double d = double(reference.first_half.values[i]) - double(reference.image.values[i]);
    noise.variance += d * d;
    if (reference.image.values[i] < peak / 2) continue;
    noise.of_bright += d * d;
    ++bright;
  }
  noise.variance /= double(reference.image.values.size());
  noise.of_bright /= std::max(1.0, bright);
  return noise;
}

void report_quick_metrics(const ViewReference& reference, const Metrics& metrics, const Observer& observer) {
  const double peak = *std::max_element(reference.image.values.begin(), reference.image.values.end());
  const Noise noise = noise_of(reference, peak);
  const double error = metrics.rms_error * metrics.rms_error;
  // A view that is as near to the render as the render to itself: nothing is known beyond half of its error.
  const double corrected = std::max(error - (1 - reference.part) * noise.variance, error / 2);
  observer.fact("psnr_db", decibels(peak / std::sqrt(corrected)));
  observer.fact("psnr_uncertainty_db",
                decibels(1 + 3 * std::sqrt(noise.of_bright) / peak) + 0.1 * decibels(std::sqrt(error / corrected)));
  observer.fact("left_out", std::string("ssim, speckle_contrast and uniformity: they need reference = full"));
}

}  // namespace

void report_metrics(const ViewReference& reference, const Image& view, double efficiency, const Observer& observer) {
  const Image& image = reference.image;
  if (std::none_of(image.values.begin(), image.values.end(), [](float v) { return v > 0; })) {
    observer.fact("why_no_metrics", std::string("the render is dark in the sensor's area"));
    return;
  }
  const Metrics metrics = compare(image, view);
  if (reference.first_half.values.empty()) {
    observer.fact("psnr_db", metrics.psnr);
    observer.fact("ssim", metrics.ssim);
    observer.fact("speckle_contrast", metrics.speckle_contrast);
    observer.fact("uniformity", metrics.uniformity);
  } else {
    report_quick_metrics(reference, metrics, observer);
  }
  observer.fact("bright_fraction", metrics.bright_fraction);
  observer.fact("diffraction_efficiency", metrics.bright_fraction * efficiency);
}

}  // namespace holotrace
