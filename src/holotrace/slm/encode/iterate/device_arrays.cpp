#include "holotrace/slm/encode/iterate/device_arrays.h"

#include <algorithm>
#include <utility>

#include "holotrace/slm/encode/iterate/processor_arrays.h"

namespace holotrace {

DeviceFrames::DeviceFrames(Device& device, const Slm& slm, const EncodeParams& params,
                           const std::vector<Hologram>& frames)
    : device_(device), slm_(slm), params_(params) {
  const auto lock = device_.lock();
  for (const Hologram& frame : frames) {
    const Drive start = drive_of(frame);
    frames_.push_back({make_drive(start.level), make_drive(start.modulus)});
  }
}

DeviceDrive DeviceFrames::make_drive(const Array2D<float>& start) const {
  DeviceDrive values;
  if (start.size() == 0) return values;
  for (DeviceBuffer* buffer : {&values.rounded, &values.drive, &values.mean, &values.square, &values.slope})
    *buffer = device_.make_buffer(start.size() * sizeof(float), "the levels of a frame");
  for (const DeviceBuffer* buffer : {&values.rounded, &values.drive})
    device_.write(*buffer, start.values.data(), buffer->bytes());
  for (const DeviceBuffer* buffer : {&values.mean, &values.square, &values.slope}) clear(device_, *buffer);
  return values;
}

std::unique_ptr<ColourLight> DeviceFrames::light_of(const DrivenPanel& panel, double wavelength) {
  return std::make_unique<DeviceLight>(device_, PanelInLight{slm_, params_, panel, wavelength}, frames_, memory_);
}

void DeviceFrames::clear_slopes() {
  const auto lock = device_.lock();
  for (const DeviceFrame& frame : frames_)
    for (const DeviceDrive* values : {&frame.level, &frame.modulus})
      if (values->slope.bytes() > 0) clear(device_, values->slope);
}

void DeviceFrames::step(const DriveStep& step) {
  const auto lock = device_.lock();
  for (const DeviceFrame& frame : frames_) {
    step_drives(device_, step.level, step.turn, step, frame.level);
    if (frame.modulus.drive.bytes() > 0) step_drives(device_, step.modulus, 0, step, frame.modulus);
  }
}

void DeviceFrames::write(std::vector<Hologram>& frames) const {
  const auto lock = device_.lock();
  const auto fetch = [&](const DeviceBuffer& from, Array2D<uint16_t>& to) {
    std::vector<float> levels(to.size());
    device_.read(from, levels.data(), from.bytes());
    std::copy(levels.begin(), levels.end(), to.values.begin());
  };
  std::vector<Hologram> written = frames;  // a device that fails leaves the frames as they were
  for (size_t m = 0; m < frames.size(); ++m) {
    fetch(frames_[m].level.rounded, written[m].level);
    fetch(frames_[m].modulus.rounded, written[m].modulus_level);
  }
  frames = std::move(written);
}

template <class Work>
void DeviceFrames::each_array_of_state(const Work& work) {
  for (const DeviceFrame& frame : frames_)
    for (const DeviceBuffer DeviceDrive::*array :
         {&DeviceDrive::rounded, &DeviceDrive::drive, &DeviceDrive::mean, &DeviceDrive::square})
      for (const DeviceDrive* values : {&frame.level, &frame.modulus})
        if ((values->*array).bytes() > 0) work(values->*array);
}

std::vector<Array2D<float>> DeviceFrames::state() {
  const auto lock = device_.lock();
  std::vector<Array2D<float>> arrays;
  each_array_of_state([&](const DeviceBuffer& buffer) {
    arrays.emplace_back(slm_.grid.ny, slm_.grid.nx);
    device_.read(buffer, arrays.back().values.data(), buffer.bytes());
  });
  return arrays;
}

void DeviceFrames::restore(const std::vector<Array2D<float>>& state) {
  const auto lock = device_.lock();
  size_t next = 0;
  each_array_of_state(
      [&](const DeviceBuffer& buffer) { device_.write(buffer, state[next++].values.data(), buffer.bytes()); });
}

}  // namespace holotrace
