#pragma once

#include <array>
#include <functional>
#include <optional>
#include <vector>

#include "holotrace/data/grid.h"
#include "holotrace/opencl/device.h"
#include "holotrace/slm/encode/iterate/descent_arrays.h"
#include "holotrace/slm/encode/iterate/device_loops.h"
#include "holotrace/slm/encode/iterate/driven_panel.h"
#include "holotrace/slm/panel/device_panel.h"
#include "holotrace/wave/propagate/device_convolution.h"

namespace holotrace {

/// A frame of a gradient descent on a device; complex panels have moduli.
struct DeviceFrame {
  DeviceDrive level, modulus;
};

/// The light that leaves a frame's panel, or what comes back to it.
struct DevicePanelLight {
  const DeviceBuffer& samples;
  DevicePanel::Memory& memory;
};

/// A DrivenPanel on a device.
class DeviceDrivenPanel {
 public:
  /// @param panel  must outlive this object
  DeviceDrivenPanel(Device& device, const DrivenPanel& panel);

  /// Memory on a device that the calls below keep for each detail [bytes]: they are run on one that only counts.
  static double bytes_kept(const Device& device, const DrivenPanel& panel);

  /// Writes the light that leaves the panel, for the frame's rounded levels.
  void leave(const DeviceFrame& frame, const PanelDetail& detail, const DevicePanelLight& u);

  /// Adds factor·∂f/∂level to the frame's slopes, given g = ∂f/∂Re u + i·∂f/∂Im u, with the detail of the slopes
  /// (DrivenPanel::add_slope).
  void add_slope(const DeviceFrame& frame, const PanelDetail& detail, const DeviceBuffer& u, const DevicePanelLight& g,
                 double factor);

 private:
  DevicePanel* model(PixelDetail detail);

  Device& device_;
  const DrivenPanel& panel_;
  std::optional<DevicePanel> model_, coarse_, mean_;  // for each PixelDetail
};

/// The mean irradiance of the frames in a plane, and their samples there, on a device.
struct DevicePlaneLight {
  std::vector<DeviceBuffer> samples;
  DeviceBuffer mean;
};

/// Memory of the light of all wavelengths, which are done one after the other.
struct DeviceLightMemory {
  std::vector<DeviceBuffer> u;        ///< light that leaves the panel, of each frame
  DeviceBuffer back;                  ///< what comes back to it
  std::array<DeviceBuffer, 4> power;  ///< at the samples of the pixels, of all frames
  DeviceBuffer pupil;                 ///< light in the plane of a pupil, or of all
  DeviceBuffer received;              ///< light in a plane that other devices have computed
  DevicePanel::Memory panel;
  DeviceConvolution::Work work;
  std::vector<DevicePlaneLight> spare;  ///< light of planes whose gradient is added
};

/// Memory that light takes which is not there yet [bytes]: for each frame that stays on the device, and beside the frames.
struct LightBytes {
  double of_frame = 0, beside = 0;
};

/// The arrays of a frame on the processor, as DeviceDrive has them on a device.
struct KeptFrame {
  Drive rounded, drive, mean, square, slope;
};

/// What an update does with a frame.
enum class FrameUse {
  light,   ///< makes its light: its rounded drive is read
  slopes,  ///< the same, and adds to its slopes
  step     ///< moves its drive
};

/// Bytes of a frame's arrays for each pixel, of panels with one array of levels or two.
inline double bytes_of_drives(size_t arrays) { return 5.0 * sizeof(float) * double(arrays); }

/// Some of the frames of a gradient descent, and one device that computes them.
///
/// The frames stay in the device's memory if all of them fit there with their light. Otherwise they stay in the processor's,
/// and each goes to the device and comes back for each of its uses. What is computed is the same.
class FramesOnDevice {
 public:
  /// @param start   levels of these frames
  /// @param fixed   number of frames, the first ones, that stay as they are
  /// @throws Error  as Device does, here and in all functions
  FramesOnDevice(Device& device, const Grid& pixels, std::vector<Drive> start, size_t fixed = 0);

  Device& device() const { return device_; }
  DeviceLightMemory& memory() { return memory_; }
  size_t frames() const { return kept_.size(); }

  /// The light of some wavelength takes this. It must be told before the frames are first used.
  void needs(const LightBytes& bytes);

  /// Whether frames stay in the processor's memory. The first call, or the first use of a frame, decides it.
  bool are_streamed();

  /// Calls work(m, frame) for all frames, in order, with their arrays on the device; for their light alone also for those that
  /// are fixed.
  void each_frame(FrameUse use, const std::function<void(size_t m, const DeviceFrame& frame)>& work);

  void clear_slopes();
  void step(const DriveStep& step);

  /// The rounded drive of a frame.
  Drive rounded(size_t frame);

  /// Adds the arrays of FrameArrays::state of these frames; and takes them from `state`, from place `next` on.
  void add_state(std::vector<Array2D<float>>& state);
  void restore(const std::vector<Array2D<float>>& state, size_t& next);

 private:
  using KeptArray = Drive KeptFrame::*;
  void place();
  void send(const KeptFrame& kept, KeptArray array, const DeviceFrame& frame) const;
  void fetch(const DeviceFrame& frame, KeptArray array, KeptFrame& kept) const;

  Device& device_;
  const Grid pixels_;
  const size_t fixed_;
  std::vector<KeptFrame> kept_;      // without values while the frames are on the device
  std::vector<DeviceFrame> frames_;  // on the device; the only one for all frames that come and go
  bool is_placed_ = false, are_streamed_ = false;
  LightBytes bytes_;
  DeviceLightMemory memory_;
};

}  // namespace holotrace
