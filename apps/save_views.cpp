#include "save_views.h"

#include <algorithm>
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

// Removes a picture of an earlier call. Holograms, which have a sidecar, stay. @return whether there is a file
bool remove_picture(const std::string& path) {
  if (fs::exists(sidecar_path(path))) return fs::exists(path);
  return fs::remove(path);
}

}  // namespace

std::string path_with_suffix(const std::string& path, const std::string& suffix) {
  const fs::path p(path);
  return (p.parent_path() / (p.stem().string() + suffix + p.extension().string())).string();
}

void remove_sweep(const std::string& view) {
  fs::remove(animation_path(view));
  if (extension_of(view) == ".gif") return;
  remove_picture(beside(view, ".png"));
  for (size_t i = 0; remove_picture(picture_path(view, i)); ++i) continue;
}

std::vector<std::string> sweep_paths(const std::string& view, size_t pictures) {
  std::vector<std::string> paths{animation_path(view)};
  if (extension_of(view) == ".gif") return paths;
  paths.push_back(beside(view, ".png"));
  for (size_t i = 0; i < pictures; ++i) paths.push_back(picture_path(view, i));
  return paths;
}

void remove_views(const std::string& view, size_t i, const std::vector<std::string>& inputs) {
  const auto is_input = [&](const std::string& path) {
    return std::any_of(inputs.begin(), inputs.end(),
                       [&](const std::string& input) { return is_same_file(path, input); });
  };
  for (; fs::exists(numbered_path(view, i)); ++i)
    if (const std::string path = numbered_path(view, i); !is_input(path)) remove_picture(path);
}

bool is_same_file(const std::string& a, const std::string& b) {
  return fs::weakly_canonical(fs::absolute(a)) == fs::weakly_canonical(fs::absolute(b));
}

void save_sweep(const std::string& view, const std::vector<Viewpoint>& from, const ViewSeries& sweep,
                const CameraParams& camera, const Observer& observer) {
  if (sweep.images.empty()) return;
  remove_sweep(view);
  save_animation(animation_path(view), sweep.images, sweep.white, camera.sweep_seconds);
  if (extension_of(view) == ".gif") return;
  const auto save = [&](int64_t i) {
    save_image(picture_path(view, size_t(i)), sweep.images[size_t(i)], sweep.white, camera.bits);
  };
  parallel_for(0, int64_t(sweep.images.size()), save, observer);
  try {
    save_chart(beside(view, ".png"), sweep_chart(from, sweep));
  } catch (const Error& error) {
    observer.warn(error.what());
  }
}

void save_stereo(const std::string& path, const std::vector<Image>& pair, double white, int bits,
                 bool is_anaglyph_plain) {
  require(pair.size() == 2, "expected a picture for each of two eyes, got {}", pair.size());
  save_image(path_with_suffix(path, "_left"), pair[0], white, bits);
  save_image(path_with_suffix(path, "_right"), pair[1], white, bits);
  save_image(is_anaglyph_plain ? path : path_with_suffix(path, "_anaglyph"), anaglyph(pair[0], pair[1]), white, bits);
}

void remove_stereo(const std::string& path) {
  for (const char* suffix : {"_left", "_right", "_anaglyph"}) fs::remove(path_with_suffix(path, suffix));
}

}  // namespace holotrace
