#include "holotrace/run/reference_metrics.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "holotrace/base/units.h"
#include "holotrace/view/camera.h"
#include "holotrace/view/compare.h"
#include "holotrace/view/expose.h"

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

// Standard error of the noise that is taken out of the mean squared error. With e the view less the mean of both halves, and d
// half of their difference, e² − d² has the noise 2·e·d at each pixel, to first order.
double error_of_correction(const ViewReference& reference, const Image& view, double scale) {
  double squares = 0;
  for (size_t i = 0; i < view.values.size(); ++i) {
    const double e = scale * double(view.values[i]) - double(reference.mean.values[i]);
    const double d = double(reference.first_half.values[i]) - double(reference.mean.values[i]);
    squares += 4 * e * e * d * d;
  }
  return (1 - reference.part) * std::sqrt(squares) / double(view.values.size());
}

bool has_light(const Image& image, double threshold) {
  return std::any_of(image.values.begin(), image.values.end(), [&](float v) { return v > 0 && v >= threshold; });
}

// Those of the view against a full reference. Noise of a reference changes the square of the contrast, and the others, in
// proportion to its variance, to first order; a half has twice the variance of the mean.
BrightMetrics bright_metrics(const ViewReference& reference, const Image& view, double threshold) {
  Image second_half = reference.mean;
  for (size_t i = 0; i < second_half.values.size(); ++i)
    second_half.values[i] = 2 * reference.mean.values[i] - reference.first_half.values[i];
  if (!has_light(reference.mean, threshold)) return compare_bright(reference.image, view, threshold);
  const BrightMetrics mean = compare_bright(reference.mean, view, threshold);
  if (!has_light(reference.first_half, threshold) || !has_light(second_half, threshold)) return mean;
  const BrightMetrics first = compare_bright(reference.first_half, view, threshold);
  const BrightMetrics second = compare_bright(second_half, view, threshold);
  const auto of_full = [&](const auto& metric) {
    const double by_noise = (1 - reference.part) * ((metric(first) + metric(second)) / 2 - metric(mean));
    return std::max(metric(mean) - by_noise, metric(mean) / 2);  // nothing is known beyond half of it
  };
  const auto square = [](const BrightMetrics& m) { return m.speckle_contrast * m.speckle_contrast; };
  return {.speckle_contrast = std::sqrt(of_full(square)),
          .bright_fraction = std::min(1.0, of_full([](const BrightMetrics& m) { return m.bright_fraction; })),
          .uniformity = std::min(1.0, of_full([](const BrightMetrics& m) { return m.uniformity; }))};
}

BrightMetrics report_quick_metrics(const ViewReference& reference, const Image& view, const Observer& observer) {
  const ScaledError metrics = scaled_error(reference.mean, view);
  const double peak = *std::max_element(reference.image.values.begin(), reference.image.values.end());
  const Noise noise = noise_of(reference, peak);
  const double error = metrics.rms_error * metrics.rms_error;
  // Of a view that is as near to the truth as the noise lets one tell, no more is known.
  const double unknown = error_of_correction(reference, view, metrics.scale);
  const double corrected = std::max(error - (1 - reference.part) * noise.variance, unknown);
  observer.fact("psnr_db", decibels(peak / std::sqrt(corrected)));
  const double of_peak = uncertainty_of_peak(reference, noise, peak);
  observer.fact("psnr_uncertainty_db", decibels(1 + of_peak) + decibels(std::sqrt(1 + 2 * unknown / corrected)));
  const auto ssim_for = [&](double peak) {
    return structural_similarity(reference.mean, view, metrics.scale, peak, noise.of_values);
  };
  const double ssim = ssim_for(peak);
  observer.fact("ssim", ssim);
  observer.fact("ssim_uncertainty", of_peak == 0 ? 0 : std::abs(ssim_for(peak * (1 + of_peak)) - ssim));
  return bright_metrics(reference, view, CompareParams{}.bright * peak);
}

}  // namespace

void report_metrics(const ViewReference& reference, const Image& view, double efficiency, const Observer& observer) {
  const bool is_quick = !reference.first_half.values.empty();
  if (!has_light(reference.image, 0) || (is_quick && !has_light(reference.mean, 0))) {
    observer.fact("why_no_metrics",
                  std::string(is_quick ? "the quick render has no light in the sensor's area; use reference = full"
                                       : "the render is dark in the sensor's area"));
    return;
  }
  BrightMetrics bright;
  if (is_quick) {
    bright = report_quick_metrics(reference, view, observer);
  } else {
    const Metrics metrics = compare(reference.image, view);
    observer.fact("psnr_db", metrics.psnr);
    observer.fact("ssim", metrics.ssim);
    bright = metrics;
  }
  observer.fact("speckle_contrast", bright.speckle_contrast);
  observer.fact("uniformity", bright.uniformity);
  observer.fact("bright_fraction", bright.bright_fraction);
  observer.fact("diffraction_efficiency", bright.bright_fraction * efficiency);
}

namespace {

constexpr double bright = 0.1;       // of the largest value: where there is light to compare, as in view/compare.h
constexpr double most_darkened = 2;  // one photographic stop

// Radiance over irradiance in the bright regions of all views; 0 if it is unknown.
double light_ratio(const std::vector<Image>& views, const std::vector<ViewReference>& references) {
  float peak = 0;
  for (const ViewReference& reference : references)
    for (const float value : reference.image.values) peak = std::max(peak, value);
  double of_references = 0, of_views = 0;
  for (size_t d = 0; d < references.size(); ++d)
    for (size_t i = 0; i < references[d].image.values.size(); ++i) {
      if (references[d].image.values[i] < bright * double(peak)) continue;
      of_references += references[d].image.values[i];
      of_views += views[d].values[i];
    }
  return peak > 0 && of_views > 0 ? of_references / of_views : 0;
}

}  // namespace

CommonExposure common_exposure(const std::vector<Image>& views, const std::vector<ViewReference>& references,
                               const std::vector<Image>& renders, double exposure) {
  const CommonExposure alone{common_white(views, exposure), renders.empty() ? 1 : common_white(renders, 0)};
  const double ratio = light_ratio(views, references);
  if (ratio == 0) return alone;
  if (exposure > 0) return {exposure, ratio * exposure};
  const double view_white = std::max(alone.view_white, alone.render_white / ratio);
  return {view_white, std::min(ratio * view_white, most_darkened * alone.render_white)};
}

double lit_fraction(const Image& image) {
  if (image.values.empty()) return 0;
  const double least = lit_level * exposure_white(image, 0);
  const size_t channels = size_t(image.channels), pixels = image.values.size() / channels;
  size_t lit = 0;
  for (size_t i = 0; i < pixels; ++i) {
    const auto first = image.values.begin() + std::ptrdiff_t(i * channels);
    lit += double(*std::max_element(first, first + std::ptrdiff_t(channels))) >= least;
  }
  return double(lit) / double(pixels);
}

void report_lit_render(const Image& render, const Observer& observer) {
  const double lit = lit_fraction(render);
  observer.fact("lit_fraction_of_render", lit);
  if (lit == 0) return;
  const double of_black = psnr_of_black(render);
  observer.fact("psnr_of_black_db", of_black);
  if (lit < least_lit_fraction)
    observer.warn(fmt::format(
        "only {} of the render is lit, less than {}, so PSNR and SSIM say little: a black view would have {:.1f} dB; "
        "judge the view by eye, or make the scene larger, light it, or move it into the window",
        format_percent(lit), format_percent(least_lit_fraction), of_black));
}

void warn_of_dots(const Image& view, const Image& render, size_t waves, const Observer& observer) {
  const double lit = lit_fraction(view), wanted = lit_fraction(render);
  if (wanted < least_surface || lit >= least_lit_by_waves * wanted) return;
  observer.warn(fmt::format(
      "the view shows dots: {} of it is lit, and {} of the render; {} waves are too few for {} × {} pixels; trace more "
      "(columns and rows, or samples, in [trace]), or let run optimise the holograms (--quality draft)",
      format_percent(lit), format_percent(wanted), waves, view.nx, view.ny));
}

}  // namespace holotrace
