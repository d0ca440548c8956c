#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "holotrace/base/process_links.h"
#include "holotrace/data/hologram.h"
#include "holotrace/data/params/encode.h"
#include "holotrace/data/slm.h"
#include "holotrace/data/target.h"
#include "holotrace/slm/encode/iterate/descent_arrays.h"
#include "holotrace/slm/encode/iterate/driven_panel.h"
#include "holotrace/slm/encode/iterate/frame_descent.h"

namespace holotrace {

/// The frames of a descent that several processes share, as process 0 sees them: its own, and orders to the others, which
/// optimise_frames_for_first_process obeys.
///
/// **What is exchanged.** For each plane of an update 4 bytes per pixel of the panel come from each other process, its frames'
/// part of the mean irradiance, and 4 go there, the factor of each pixel's error. Process 0 adds the parts in the order of the
/// processes, so that the sum does not depend on timing. Views do the same with the pixels of their pictures. Levels go there
/// once and come back at the end. For a checkpoint the state of each frame comes to process 0.
class SharedFrames : public FrameArrays {
 public:
  /// Own frames in arrays of this process, given those that others have, and how many of the own ones are fixed.
  using MakeArrays = std::function<std::unique_ptr<FrameArrays>(const std::vector<Hologram>& own,
                                                                const OtherFrames& others, size_t fixed)>;

  /// @param links   must outlive it, as this object must its light
  /// @param device  of the other processes: each takes its own of equal ones (devices_of_process)
  /// @throws Error  as the other processes do, here and in all functions
  SharedFrames(ProcessLinks& links, const DescentSetup& setup, const DeviceChoice& device,
               const std::vector<Hologram>& frames, const MakeArrays& make);
  ~SharedFrames() override;

  std::unique_ptr<WavelengthLight> light_of(const DrivenPanel& panel, double wavelength) override;
  void clear_slopes() override;
  void step(const DriveStep& step) override;
  void end_steps() override;
  void write(std::vector<Hologram>& frames) const override;
  std::vector<Array2D<float>> state() override;
  void restore(const std::vector<Array2D<float>>& state) override;

  size_t processes() const { return ranges_.size(); }

  /// Lets the other processes end. Without it they wait for orders.
  void finish();

 private:
  class Exchange;
  class Light;
  void order(const std::string& bytes) const;

  ProcessLinks& links_;
  std::vector<FrameRange> ranges_;
  size_t arrays_of_frame_;
  std::unique_ptr<Exchange> exchange_;
  std::unique_ptr<FrameArrays> own_;
  uint64_t wavelengths_ = 0;
};

/// The work of a process other than process 0: it finds its frames by the orders of one SharedFrames, until it ends.
/// @throws Error  for what goes wrong here: the caller tells process 0
void optimise_frames_for_first_process(ProcessLinks& links);

// Messages between the processes that share the frames of a descent. The first one sends each other one a job, its
// frames, one in a message, and then orders, until the last one. Only the first process knows the targets, the schedule and the loss.

/// What another process must know: the panel with the effects that are on, what optics and arrays depend on, and its frames.
struct FrameJob {
  Slm slm;
  EncodeParams params;
  std::vector<Hologram> frames;  ///< each follows in a message of its own, without its panel
  size_t frames_of_all = 0;
  size_t fixed = 0;  ///< number of `frames`, the first ones, that stay as they are
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
