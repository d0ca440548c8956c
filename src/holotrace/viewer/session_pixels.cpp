// The pixels of a session for the page: values of the view, a hologram, and files.

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <numbers>

#include "holotrace/base/error.h"
#include "holotrace/io/files/temporary_folder.h"
#include "holotrace/io/picture/image_file.h"
#include "holotrace/slm/panel/show.h"
#include "holotrace/viewer/json_text.h"
#include "holotrace/viewer/session.h"

namespace holotrace {

namespace {
using Json = nlohmann::ordered_json;
}

std::string Session::values(const ViewState& state, int column, int row, int columns, int rows) {
  const std::lock_guard lock(mutex_);
  const TakenView view = *take(state, {});
  const Image& image = view.image;
  constexpr int most = 64;
  require(column >= 0 && row >= 0 && columns >= 1 && rows >= 1 && columns <= most && rows <= most &&
              column <= image.nx - columns && row <= image.ny - rows,
          "expected a window of at most {} × {} pixels inside the view of {} × {}, got {} × {} at {}, {}", most, most,
          image.nx, image.ny, columns, rows, column, row);
  Json lines = Json::array();
  for (int j = row; j < row + rows; ++j) {
    Json line = Json::array();
    for (int i = column; i < column + columns; ++i)
      for (int c = 0; c < image.channels; ++c) line.push_back(image(j, i, c));
    lines.push_back(line);
  }
  return text_of({{"channels", image.channels}, {"white", view.white}, {"rows", lines}});
}

BytePicture Session::panel(size_t number, PanelQuantity quantity, const ViewState& state) {
  const std::lock_guard lock(mutex_);
  require(number < contents_->items.size(), "expected a hologram number below {}, got {}", contents_->items.size(),
          number);
  const ViewedItem& item = contents_->items[number];
  if (quantity == PanelQuantity::level && !item.field) {
    const Hologram& h = item.hologram;
    BytePicture picture{h.grid.nx, h.grid.ny, 1, {}};
    for (const uint16_t level : h.level.values)
      picture.values.push_back(uint8_t(std::lround(level * 255.0 / (h.levels - 1))));
    return picture;
  }
  const double samples = double(item.slm.grid.pixels()) * state.show.subpixels * state.show.subpixels;
  require(item.field || samples <= most_sensor_pixels,
          "expected at most {:.0f} million samples of the panel here, got {:.0f}; use fewer subpixels",
          most_sensor_pixels / 1e6, samples / 1e6);
  const double wavelength = wavelengths_of(item, state.show).front();
  ShowParams show = state.show;
  if (!item.hologram.colours.empty()) show.wavelength = wavelength;
  const Field shown = item.field ? *item.field : holotrace::show(item.hologram, item.slm, show);
  BytePicture picture{shown.grid.nx, shown.grid.ny, 1, {}};
  double square = 0;
  for (const auto& u : shown.samples.values) square += std::norm(std::complex<double>(u));
  const double white = 2 * std::sqrt(square / double(shown.samples.size()));  // twice the rms amplitude
  for (const auto& u : shown.samples.values) {
    const double cycles = std::arg(u) / (2 * std::numbers::pi);
    const double value = quantity == PanelQuantity::phase ? cycles - std::floor(cycles)
                         : white > 0                      ? std::min(1.0, double(std::abs(u)) / white)
                                                          : 0;
    picture.values.push_back(uint8_t(std::min(255.0, value * 256)));
  }
  return picture;
}

std::string Session::file(const ViewState& state, const std::string& extension) {
  const std::lock_guard lock(mutex_);
  ViewState still = state;
  still.is_draft = false;
  const TakenView view = *take(still, {});
  const TemporaryFolder folder("holotrace_view");
  const std::string path = folder.path() + "/view" + extension;
  save_image(path, view.image, view.white, state.camera.bits);
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

}  // namespace holotrace
