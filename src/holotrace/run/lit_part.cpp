#include "holotrace/run/lit_part.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

#include "holotrace/view/compare.h"

namespace holotrace {
namespace {

std::string percent(double fraction) { return fmt::format("{:.2g} %", 100 * fraction); }

}  // namespace

double lit_fraction(const ExposedImage& picture) {
  const Image& image = picture.image;
  const size_t channels = size_t(image.channels), pixels = image.values.size() / channels;
  size_t lit = 0;
  for (size_t i = 0; i < pixels; ++i) {
    const auto first = image.values.begin() + std::ptrdiff_t(i * channels);
    const double brightest = *std::max_element(first, first + std::ptrdiff_t(channels));
    lit += brightest > 0 && brightest >= lit_level * picture.white;
  }
  return pixels > 0 ? double(lit) / double(pixels) : 0;
}

void report_lit_render(const ExposedImage& render, const ExposedImage& view, const Observer& observer) {
  const double of_render = lit_fraction(render), of_view = lit_fraction(view);
  observer.fact("lit_fraction_of_render", of_render);
  const std::vector<float>& values = render.image.values;
  if (std::none_of(values.begin(), values.end(), [](float v) { return v > 0; })) return;
  const double of_black = psnr_of_black(render.image);
  observer.fact("psnr_of_black_db", of_black);
  if (of_render < least_lit_fraction)
    observer.warn(fmt::format(
        "only {} of the render is lit, less than {}; PSNR and SSIM say little about this view: a black one has "
        "{:.1f} dB; bring the scene into the window of the view, make it larger, or light it",
        percent(of_render), percent(least_lit_fraction), of_black));
  else if (of_view < least_lit_fraction)
    observer.warn(fmt::format(
        "only {} of the view is lit, but {} of the render: a few bright pixels outshine the rest, for instance "
        "those of the zero order; let a stop block them, or give the exposure",
        percent(of_view), percent(of_render)));
}

}  // namespace holotrace
