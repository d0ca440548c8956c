#include "holotrace/run/reference_metrics.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "holotrace/view/compare.h"
#include "holotrace/view/structural_similarity.h"

namespace holotrace {
namespace {

double decibels(double ratio_of_amplitudes) { return 20 * std::log10(ratio_of_amplitudes); }

struct Noise {
  double variance = 0, of_bright = 0;  // over all pixels, and over those that may be the maximum instead
  std::vector<float> of_values;        // its values, beyond those of a full reference
};

Noise noise_of(const ViewReference& reference, double peak) {
  Noise noise;
  noise.of_values.reserve(reference.image.values.size());
  double bright = 0;
  for (size_t i = 0; i < reference.mean.values.size(); ++i) {
    const double d = double(reference.first_half.values[i]) - double(reference.mean.values[i]);
    noise.variance += d * d;
    noise.of_values.push_back(float(std::sqrt(1 - reference.part) * d));
    if (reference.image.values[i] != reference.mean.values[i] || reference.image.values[i] < peak / 2) continue;
    noise.of_bright += d * d;
    ++bright;
  }
  noise.variance /= double(reference.image.values.size());
  noise.of_bright /= std::max(1.0, bright);
  return noise;
}

// Possible error of the maximum, relative to it: three times the noise of pixels that have few paths, if one of them is so
// near to the maximum.
double uncertainty_of_peak(const ViewReference& reference, const Noise& noise, double peak) {
  const double reach = 3 * std::sqrt(noise.of_bright);
  for (size_t i = 0; i < reference.image.values.size(); ++i)
    if (reference.image.values[i] >= peak - reach && reference.image.values[i] == reference.mean.values[i])
      return reach / peak;
  return 0;
}

void report_quick_metrics(const ViewReference& reference, const Image& view, const Observer& observer) {
  const Metrics metrics = compare(reference.mean, view);
  const double peak = *std::max_element(reference.image.values.begin(), reference.image.values.end());
  const Noise noise = noise_of(reference, peak);
  const double error = metrics.rms_error * metrics.rms_error;
  // A view that is as near to the render as the render to itself: nothing is known beyond half of its error.
  const double corrected = std::max(error - (1 - reference.part) * noise.variance, error / 2);
  observer.fact("psnr_db", decibels(peak / std::sqrt(corrected)));
  const double of_peak = uncertainty_of_peak(reference, noise, peak);
  observer.fact("psnr_uncertainty_db", decibels(1 + of_peak) + 0.1 * decibels(std::sqrt(error / corrected)));
  if (of_peak == 0)
    observer.fact("ssim", structural_similarity(reference.mean, view, metrics.scale, peak, noise.of_values));
  observer.fact("left_out", fmt::format("{}speckle_contrast and uniformity: they need reference = full",
                                        of_peak == 0 ? "" : "ssim, "));
}

}  // namespace

void report_metrics(const ViewReference& reference, const Image& view, double efficiency, const Observer& observer) {
  const bool is_quick = !reference.first_half.values.empty();
  const Image &image = reference.image, &compared = is_quick ? reference.mean : image;
  if (std::none_of(compared.values.begin(), compared.values.end(), [](float v) { return v > 0; })) {
    observer.fact("why_no_metrics", std::string("the render is dark in the sensor's area"));
    return;
  }
  const Metrics metrics = compare(image, view);
  if (!is_quick) {
    observer.fact("psnr_db", metrics.psnr);
    observer.fact("ssim", metrics.ssim);
    observer.fact("speckle_contrast", metrics.speckle_contrast);
    observer.fact("uniformity", metrics.uniformity);
  } else {
    report_quick_metrics(reference, view, observer);
  }
  observer.fact("bright_fraction", metrics.bright_fraction);
  observer.fact("diffraction_efficiency", metrics.bright_fraction * efficiency);
}

}  // namespace holotrace
