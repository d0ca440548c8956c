#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "holotrace/data/hologram.h"
#include "holotrace/data/params/encode.h"
#include "holotrace/data/slm.h"
#include "holotrace/data/target.h"
#include "holotrace/slm/encode/iterate/descent_arrays.h"
#include "holotrace/slm/encode/iterate/driven_panel.h"

// Messages between the processes that share the frames of a descent. The first one sends each other one a job, its
// frames, one in a message, and then orders, until the last one. Only the first process knows the targets, the schedule and the loss.

namespace holotrace {

/// What another process must know: the panel with the effects that are on, what optics and arrays depend on, and its frames.
struct FrameJob {
  Slm slm;
  EncodeParams params;
  std::vector<Hologram> frames;  ///< each follows in a message of its own, without its panel
  size_t frames_of_all = 0;
};

std::string job_message(const FrameJob& job);
/// With as many frames, which are empty.
FrameJob job_from(const std::string& message);

std::string frame_message(Hologram frame);

/// The functions of FrameArrays and WavelengthLight, in another process.
enum class FrameOrder : int32_t {
  light_of,
  add,
  clear_slopes,
  step,
  end_steps,
  leave,
  plane_sums,
  add_gradient,
  view_sums,              ///< the views follow in a message of their own
  add_gradient_of_views,  ///< of the same views
  write,                  ///< levels come back, a message for each array
  state,                  ///< arrays come back, one in a message
  restore,                ///< arrays follow, one in a message
  end
};

/// An order, with the arguments of any of them.
struct FrameOrderMessage {
  FrameOrder order{};
  uint64_t colour = 0, plane = 0;  ///< colours and their planes are numbered as they are added
  double wavelength = 0, z = 0;
  SampleGroup group{};
  bool is_kept = false;
  double scale = 0, factor = 0;
  PanelDetail detail{};
  DriveStep step{};
};

}  // namespace holotrace
