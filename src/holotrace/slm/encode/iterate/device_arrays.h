#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "holotrace/data/params/encode.h"
#include "holotrace/data/slm.h"
#include "holotrace/opencl/device.h"
#include "holotrace/slm/encode/iterate/descent_arrays.h"
#include "holotrace/slm/encode/iterate/frames_on_device.h"

namespace holotrace {

/// The frames of a gradient descent on one or several OpenCL devices, each of which has a share of them: levels go there
/// once, and come back at the end.
class DeviceFrames : public FrameArrays {
 public:
  /// @param devices      those after as many as there are frames have nothing to do
  /// @param slm, params  must outlive this object
  /// @param frames       their levels are the start
  /// @param others       frames of other processes
  /// @param fixed        number of frames, the first ones, that stay as they are
  /// @throws Error       as Device does, here and in all functions
  DeviceFrames(const std::vector<Device*>& devices, const Slm& slm, const EncodeParams& params,
               const std::vector<Hologram>& frames, const OtherFrames& others = {}, size_t fixed = 0);

  std::unique_ptr<WavelengthLight> light_of(const DrivenPanel& panel, double wavelength) override;
  void clear_slopes() override;
  void step(const DriveStep& step) override;
  void write(std::vector<Hologram>& frames) const override;
  std::vector<Array2D<float>> state() override;
  void restore(const std::vector<Array2D<float>>& state) override;

  /// The devices' shares, in the order of the frames.
  const std::vector<std::unique_ptr<FramesOnDevice>>& shares() const { return shares_; }

 private:
  const Slm& slm_;
  const EncodeParams& params_;
  OtherFrames others_;
  std::vector<std::unique_ptr<FramesOnDevice>> shares_;
};

/// Calls work(i) for all shares i at once, each with its device locked.
void on_all_shares(const std::vector<std::unique_ptr<FramesOnDevice>>& shares,
                   const std::function<void(size_t i)>& work);

}  // namespace holotrace
