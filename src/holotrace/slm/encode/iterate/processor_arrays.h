#pragma once

#include <memory>
#include <vector>

#include "holotrace/data/params/encode.h"
#include "holotrace/data/slm.h"
#include "holotrace/slm/encode/iterate/descent_arrays.h"
#include "holotrace/slm/encode/iterate/frame_exchange.h"

namespace holotrace {

/// The levels of a hologram, as a drive.
Drive drive_of(const Hologram& hologram);

/// The frames of a gradient descent in the processor's memory.
class ProcessorFrames : public FrameArrays {
 public:
  /// @param slm, params  must outlive this object
  /// @param frames       their levels are the start
  /// @param others       frames of other processes
  ProcessorFrames(const Slm& slm, const EncodeParams& params, const std::vector<Hologram>& frames,
                  const OtherFrames& others = {});

  std::unique_ptr<WavelengthLight> light_of(const DrivenPanel& panel, double wavelength) override;
  void clear_slopes() override;
  void step(const DriveStep& step) override;
  void end_steps() override;
  void write(std::vector<Hologram>& frames) const override;
  std::vector<Array2D<float>> state() override;
  void restore(const std::vector<Array2D<float>>& state) override;

 private:
  struct Frame {
    Drive drive, mean, square;
  };
  void prepare_steps();
  template <class Work>
  void each_array_of_state(const Work& work);

  const Slm& slm_;
  const EncodeParams& params_;
  OtherFrames others_;
  std::vector<Drive> rounded_, slopes_;  // of each frame
  std::vector<Frame> frames_;            // empty until the first step: frames that are only judged need none
  bool have_steps_ended_ = false;
};

/// @param processes  of this machine that each have so many frames
/// @throws Error     if the memory does not suffice for a descent on the processor
void require_memory_for_descent(size_t planes, const Slm& slm, const EncodeParams& params,
                                const std::vector<Hologram>& frames, int processes = 1);

}  // namespace holotrace
