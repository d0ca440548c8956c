#include "holotrace/view/comparison_plots.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "holotrace/base/error.h"
#include "holotrace/view/register/channel.h"

namespace holotrace {
namespace {

using Colour = std::array<double, 3>;  // linear light of the sRGB codes in the header

constexpr Colour equal{0.2159, 0.2159, 0.2159}, brighter{0.6654, 0.1119, 0}, darker{0, 0.1683, 0.4452};

}  // namespace

DifferenceImage difference_image(const Image& reference, const Image& image, double scale, double range) {
  require(reference.nx == image.nx && reference.ny == image.ny && reference.channels == image.channels,
          "expected an image of {} × {} pixels and {} channel(s), as its reference, got {} × {} and {}", reference.nx,
          reference.ny, reference.channels, image.nx, image.ny, image.channels);
  require(std::isfinite(range) && range >= 0, "expected a difference at full colour above 0, got {}", range);
  const size_t channels = size_t(image.channels);
  std::vector<double> difference(size_t(image.nx) * size_t(image.ny));
  double largest = 0;
  for (size_t i = 0; i < difference.size(); ++i) {
    for (size_t c = 0; c < channels; ++c)
      difference[i] += (scale * double(image.values[i * channels + c]) - double(reference.values[i * channels + c])) /
                       double(channels);
    largest = std::max(largest, std::abs(difference[i]));
  }
  DifferenceImage out{Image(image.ny, image.nx, 3), range > 0 ? range : largest};
  for (size_t i = 0; i < difference.size(); ++i) {
    const double part = out.range > 0 ? std::clamp(difference[i] / out.range, -1.0, 1.0) : 0;
    const Colour& full = part > 0 ? brighter : darker;
    for (size_t c = 0; c < 3; ++c)
      out.image.values[3 * i + c] = float(equal[c] + std::abs(part) * (full[c] - equal[c]));
  }
  return out;
}

Chart profile_chart(const Image& reference, const Image& image, double scale, const PartOfPicture& part) {
  const int row = reference.ny / 2;
  const double pitch = reference.pitch;
  Chart chart;
  chart.title = fmt::format("Row {} of {}", part.first_row + row + 1, part.rows);
  chart.x_label = pitch > 0 ? "x [mm]" : "x [pixels]";
  chart.y_label = "brightness, linear [unit of the reference]";
  const Channel of_reference = mean_of_channels(reference), of_image = mean_of_channels(image);
  Series shown{"reference", {}, {}}, compared{fmt::format("{:.4g} × image", scale), {}, {}};
  for (int column = 0; column < of_reference.nx; ++column) {
    const double x = (part.first_column + column - (part.columns - 1) / 2.0) * (pitch > 0 ? pitch * 1e3 : 1);
    shown.x.push_back(x);
    shown.y.push_back(of_reference(row, column));
    compared.x.push_back(x);
    compared.y.push_back(scale * of_image(row, column));
  }
  chart.series = {std::move(shown), std::move(compared)};
  return chart;
}

}  // namespace holotrace
