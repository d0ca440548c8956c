#pragma once

#include <memory>
#include <vector>

#include "holotrace/data/params/encode.h"
#include "holotrace/data/slm.h"
#include "holotrace/opencl/device.h"
#include "holotrace/slm/encode/iterate/descent_arrays.h"
#include "holotrace/slm/encode/iterate/device_light.h"

namespace holotrace {

/// The frames of a gradient descent in the memory of an OpenCL device: levels go there once, and come back at the end.
class DeviceFrames : public FrameArrays {
 public:
  /// @param slm, params  must outlive this object
  /// @param frames       their levels are the start
  /// @throws Error       as Device does, here and in all functions
  DeviceFrames(Device& device, const Slm& slm, const EncodeParams& params, const std::vector<Hologram>& frames);

  std::unique_ptr<ColourLight> light_of(const DrivenPanel& panel, double wavelength) override;
  void clear_slopes() override;
  void step(const DriveStep& step) override;
  void write(std::vector<Hologram>& frames) const override;
  std::vector<Array2D<float>> state() override;
  void restore(const std::vector<Array2D<float>>& state) override;

 private:
  DeviceDrive make_drive(const Array2D<float>& start) const;
  template <class Work>
  void each_array_of_state(const Work& work);

  Device& device_;
  const Slm& slm_;
  const EncodeParams& params_;
  std::vector<DeviceFrame> frames_;
  DeviceLightMemory memory_;
};

}  // namespace holotrace
