#pragma once

#include <cstdint>
#include <string>

namespace holotrace {

/// Name, frame and cone of light, as waves, a field or a hologram have them. Every stage copies it from its input to its output.
struct Label {
  std::string name{};  ///< name of the path group or light that it shows, "" for all light
  uint32_t frame = 0;  ///< index of the frame, among the holograms that are shown one after the other
  /// Acceptance wavelength: the one whose acceptance cone bounds the light [m], at most its own. If all colours of a job share one cone,
  /// it is the job's shortest wavelength. 0: its own.
  double cone_wavelength = 0;
  bool operator==(const Label&) const = default;
};

}  // namespace holotrace
