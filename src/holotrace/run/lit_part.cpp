#include "holotrace/run/lit_part.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

#include "holotrace/view/compare.h"
#include "holotrace/view/expose.h"

namespace holotrace {
namespace {

std::string percent(double fraction) { return fmt::format("{:.2g} %", 100 * fraction); }

}  // namespace

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
        percent(lit), percent(least_lit_fraction), of_black));
}

}  // namespace holotrace
