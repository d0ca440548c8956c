#include "image_pair.h"

#include <fmt/ranges.h>

#include <filesystem>
#include <optional>
#include <utility>
#include <vector>

#include "holotrace/base/units.h"
#include "holotrace/io/picture/image_file.h"
#include "holotrace/io/report_file.h"
#include "holotrace/view/render_at.h"

namespace holotrace {
namespace {

std::string size_text(const Image& image) { return fmt::format("{} × {}", image.nx, image.ny); }

bool is_same_file(const std::string& a, const std::string& b) {
  std::error_code error;
  return std::filesystem::equivalent(a, b, error) && !error;
}

// The light in which a render is seen, in words.
std::string colour_text(const std::vector<double>& wavelengths) {
  std::vector<std::string> texts;
  for (const double wavelength : wavelengths) texts.push_back(format_length(wavelength));
  return fmt::format("{}", fmt::join(texts, ", "));
}

// Puts a render onto the pixels of a view of the same run. @return whether `render` is the render of `view`
bool place_render(Image& render, const std::string& render_path, const Image& view, const std::string& view_path,
                  Json& facts) {
  const std::optional<RenderOfView> known = render_of_view(view_path);
  if (!known || !(is_same_file(known->path, render_path) || is_same_file(known->radiance, render_path))) return false;
  facts["placed"] = fmt::format("{} ({} pixels) on the {} pixels of {}, each the mean over its area, by report.json",
                                render_path, size_text(render), size_text(view), view_path);
  facts["colours"] = "light of " + colour_text(known->place.wavelengths);
  render = render_at(render, known->place, view.ny, view.nx);
  return true;
}

}  // namespace

void make_channels_equal(Image& a, Image& b, Json& facts) {
  if (a.channels == b.channels) return;
  a = luminance_of(a);
  b = luminance_of(b);
  facts["colours"] = "grey: luminance 0.2126 R + 0.7152 G + 0.0722 B of linear light";
}

ImagePair image_pair(const std::string& reference_path, const std::string& image_path) {
  ImagePair pair{load_image(reference_path), load_image(image_path)};
  Image &reference = pair.reference, &image = pair.image;
  const bool is_placed = place_render(reference, reference_path, image, image_path, pair.facts) ||
                         place_render(image, image_path, reference, reference_path, pair.facts);
  if (!is_placed && (reference.nx != image.nx || reference.ny != image.ny)) {
    const std::string size = size_text(reference);
    reference = on_pixels_of(reference, image);
    pair.facts["placed"] = fmt::format(
        "{} ({} pixels) on the {} pixels of {}, each the mean over its area, as if both "
        "showed one window",
        reference_path, size, size_text(image), image_path);
  }
  make_channels_equal(reference, image, pair.facts);
  pair.rows = reference.ny;
  pair.columns = reference.nx;
  return pair;
}

}  // namespace holotrace
