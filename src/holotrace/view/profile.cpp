#include "holotrace/view/profile.h"

#include <fmt/format.h>

#include <utility>

#include "holotrace/view/register/channel.h"

namespace holotrace {

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
