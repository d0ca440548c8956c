#pragma once

#include <vector>

#include "display/display_module.h"
#include "holotrace/data/panel_image.h"

namespace holotrace {

/// Pictures of one panel as the colours that a monitor output has.
struct MonitorPictures {
  int columns = 0, rows = 0;
  std::vector<std::vector<unsigned>> colours;  ///< 0xRRGGBB of each, [row][column]

  /// @throws Error  for greys of 16 bits
  explicit MonitorPictures(const std::vector<PanelImage>& images);

  /// Makes them those of a job, which must not outlive them.
  void put_into(DisplayJob& job);

 private:
  std::vector<const unsigned*> pointers_;
};

/// Shows the pictures of a job on a monitor until it is over (display/display_module.h).
/// @throws Error  without SDL, a desktop, or a fitting mode of the monitor
DisplayOutcome show_on_monitor(const DisplayJob& job);

}  // namespace holotrace
