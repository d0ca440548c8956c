#include "holotrace/io/run/save_views.h"

#include <filesystem>

#include "holotrace/base/error.h"
#include "holotrace/base/threads.h"
#include "holotrace/io/files/file.h"
#include "holotrace/io/files/output.h"
#include "holotrace/io/picture/animation.h"
#include "holotrace/io/picture/chart_file.h"
#include "holotrace/io/picture/image_file.h"
#include "holotrace/view/stereo.h"

namespace holotrace {
namespace fs = std::filesystem;

namespace {

std::string beside(const std::string& view, const std::string& extension) {
  return fs::path(path_with_suffix(view, "_sweep")).replace_extension(extension).string();
}

std::string animation_path(const std::string& view) {
  return extension_of(view) == ".gif" ? view : beside(view, ".gif");
}

std::string picture_path(const std::string& view, size_t i) {
  return path_with_suffix(view, fmt::format("_sweep_{:02}", i + 1));
}

void save_sweep(const OutputSet& set, const std::string& name, const SeenViews& seen, const Observer& observer) {
  const ViewSeries& sweep = seen.sweep;
  if (sweep.images.empty()) return;
  const std::string view = set.path(name);
  save_animation(animation_path(view), sweep.images, sweep.white, seen.camera.sweep_seconds);
  if (extension_of(view) == ".gif") return;
  const auto save = [&](int64_t i) {
    save_image(picture_path(view, size_t(i)), sweep.images[size_t(i)], sweep.white, seen.camera.bits);
  };
  parallel_for(0, int64_t(sweep.images.size()), save, observer);
  try_save_chart(set, fs::path(beside(view, ".png")).filename().string(), sweep_chart(seen.from, sweep), observer);
}

}  // namespace

std::vector<std::string> sweep_paths(const std::string& view, size_t pictures) {
  std::vector<std::string> paths{animation_path(view)};
  if (extension_of(view) == ".gif") return paths;
  paths.push_back(beside(view, ".png"));
  for (size_t i = 0; i < pictures; ++i) paths.push_back(picture_path(view, i));
  return paths;
}

void save_views(const OutputSet& set, const std::string& name, const SeenViews& seen, const Observer& observer) {
  const bool is_animation = extension_of(name) == ".gif";
  require(!is_animation || !seen.sweep.images.empty(),
          "expected a sweep for the animated file {}, got none; view with a sweep, or name a .png", name);
  const FileRecord before = set.record();
  save_sweep(set, name, seen, observer);
  if (is_animation) return;
  if (!seen.stereo.images.empty()) save_stereo(set, name, seen.stereo.images, seen.stereo.white, seen.camera.bits);
  for (size_t i = seen.views.images.size(); i-- > 0;)
    save_image(set.path(numbered_path(name, i)), seen.views.images[i], seen.views.white, seen.camera.bits,
               i == 0 ? set.record_since(before) : FileRecord());
}

void save_stereo(const OutputSet& set, const std::string& name, const std::vector<Image>& pair, double white, int bits,
                 bool is_anaglyph_plain) {
  const std::string path = set.path(name);
  require(pair.size() == 2, "expected a picture for each of two eyes, got {}", pair.size());
  save_image(path_with_suffix(path, "_left"), pair[0], white, bits);
  save_image(path_with_suffix(path, "_right"), pair[1], white, bits);
  const Image both = anaglyph(pair[0], pair[1]);
  if (is_anaglyph_plain)
    save_image(path, both, white, bits, set.record());
  else
    save_image(path_with_suffix(path, "_anaglyph"), both, white, bits);
}

}  // namespace holotrace
