#include "monitor.h"

#include <dlfcn.h>

#include "holotrace/base/error.h"
#include "program_module.h"

namespace holotrace {

MonitorPictures::MonitorPictures(const std::vector<PanelImage>& images) {
  for (const PanelImage& image : images) {
    require(
        image.bits == 8,
        "expected holograms of at most 256 levels, because a monitor output has 8 bits, got greys of 16 bits; encode them "
        "again with --levels 256, or save them with -o");
    columns = image.columns;
    rows = image.rows;
    std::vector<unsigned>& picture = colours.emplace_back(size_t(columns) * size_t(rows));
    for (size_t i = 0; i < picture.size(); ++i) {
      const uint16_t* pixel = image.values.data() + i * size_t(image.channels);
      picture[i] = image.channels == 1 ? pixel[0] * 0x10101u : unsigned(pixel[0] << 16 | pixel[1] << 8 | pixel[2]);
    }
  }
}

void MonitorPictures::put_into(DisplayJob& job) {
  pointers_.clear();
  for (const auto& picture : colours) pointers_.push_back(picture.data());
  job.columns = columns;
  job.rows = rows;
  job.pictures = int(pointers_.size());
  job.colours = pointers_.data();
}

DisplayOutcome show_on_monitor(const DisplayJob& job) {
  void* function = load({"display", display_function, RTLD_NOW}, "install SDL 2 (libsdl2-2.0-0)");
  require(function != nullptr,
          "expected holotrace_display.so beside the program, got none; install SDL 2 (libsdl2-dev) and build again");
  DisplayOutcome outcome;
  reinterpret_cast<DisplayFunction>(function)(&job, &outcome);
  require(outcome.problem[0] == '\0', "{}", outcome.problem);
  return outcome;
}

}  // namespace holotrace
