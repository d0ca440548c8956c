#include "holotrace/slm/encode/iterate/frames_on_device.h"

#include <algorithm>
#include <utility>

#include "holotrace/base/cycles.h"
#include "holotrace/base/units.h"
#include "holotrace/slm/encode/iterate/device_loops.h"

namespace holotrace {
namespace {

const DeviceBuffer* moduli_of(const DeviceFrame& frame, const DeviceBuffer DeviceDrive::*values) {
  return (frame.modulus.*values).bytes() > 0 ? &(frame.modulus.*values) : nullptr;
}

DevicePattern pattern_of(const DeviceFrame& frame, bool is_halfway) {
  return {frame.level.rounded, moduli_of(frame, &DeviceDrive::rounded), is_halfway};
}

}  // namespace

DeviceDrivenPanel::DeviceDrivenPanel(Device& device, const DrivenPanel& panel) : device_(device), panel_(panel) {
  if (const PanelModel* model = panel.model(PixelDetail::as_shown)) model_.emplace(device, *model);
  if (!panel.has_crosstalk()) return;
  coarse_.emplace(device, *panel.model(PixelDetail::coarse));
  mean_.emplace(device, *panel.model(PixelDetail::mean));
}

double DeviceDrivenPanel::bytes_kept(const Device& device, const DrivenPanel& panel) {
  const PanelModel* const shown = panel.model(PixelDetail::as_shown);
  if (!shown) return 0;
  Device counter(device.info(), device.memory());
  DeviceDrivenPanel counted(counter, panel);
  const auto floats = [&](double count) { return counter.make_buffer(size_t(count) * sizeof(float), "a panel"); };
  const Field head = shown->head();
  const double samples = double(head.grid.pixels());  // at least as many as pixels
  DeviceFrame frame;
  for (DeviceDrive* values : {&frame.level, &frame.modulus}) {
    values->rounded = floats(samples);
    values->slope = floats(samples);
  }
  const DeviceBuffer u = floats(2 * samples);
  const size_t before = counter.use().bytes_held;
  DevicePanel::Memory memory;
  for (const PixelDetail detail : {PixelDetail::as_shown, PixelDetail::coarse, PixelDetail::mean}) {
    counted.leave(frame, {.light = detail, .slopes = detail}, {u, memory});
    counted.add_slope(frame, {.light = detail, .slopes = detail}, u, {u, memory}, 1);
  }
  return double(counter.use().bytes_held - before);
}

DevicePanel* DeviceDrivenPanel::model(PixelDetail detail) {
  if (panel_.has_crosstalk() && detail != PixelDetail::as_shown)
    return detail == PixelDetail::coarse ? &*coarse_ : &*mean_;
  return model_ ? &*model_ : nullptr;
}

void DeviceDrivenPanel::leave(const DeviceFrame& frame, const PanelDetail& detail, const DevicePanelLight& u) {
  if (DevicePanel* const there = model(detail.light))
    return there->leave(pattern_of(frame, false), u.samples, u.memory);
  leave_phases(device_, float(panel_.cycles_per_level()), frame.level.rounded, u.samples);
}

void DeviceDrivenPanel::add_slope(const DeviceFrame& frame, const PanelDetail& detail, const DeviceBuffer& u,
                                  const DevicePanelLight& g, double factor) {
  const bool is_halfway = panel_.takes_middle(detail);
  if (DevicePanel* const there = model(detail.slopes)) {
    const DeviceSlopes to{frame.level.slope, moduli_of(frame, &DeviceDrive::slope), factor};
    return there->add_slopes(pattern_of(frame, is_halfway), g.samples, to, g.memory);
  }
  const double cycles = panel_.cycles_per_level();
  add_phase_slopes(device_, {float(factor * 2 * pi * cycles), is_halfway, std::complex<float>(cis_cycles(cycles / 2))},
                   g.samples, u, frame.level.slope);
}

namespace {

using KeptArray = Drive KeptFrame::*;
using KeptArrays = std::vector<KeptArray>;

const KeptArrays of_state{&KeptFrame::rounded, &KeptFrame::drive, &KeptFrame::mean, &KeptFrame::square};

// What goes to the device for a use, and what comes back.
KeptArrays sent_for(FrameUse use) {
  switch (use) {
    case FrameUse::light:
      return {&KeptFrame::rounded};
    case FrameUse::slopes:
      return {&KeptFrame::rounded, &KeptFrame::slope};
    case FrameUse::step:
      return {&KeptFrame::drive, &KeptFrame::mean, &KeptFrame::square, &KeptFrame::slope};
  }
  return {};
}

KeptArrays changed_by(FrameUse use) {
  if (use == FrameUse::light) return {};
  return use == FrameUse::slopes ? KeptArrays{&KeptFrame::slope} : of_state;
}

const DeviceBuffer& on_device(const DeviceDrive& values, KeptArray array) {
  if (array == &KeptFrame::rounded) return values.rounded;
  if (array == &KeptFrame::drive) return values.drive;
  if (array == &KeptFrame::mean) return values.mean;
  return array == &KeptFrame::square ? values.square : values.slope;
}

DeviceDrive make_drive(Device& device, size_t values) {
  DeviceDrive made;
  if (values == 0) return made;
  for (DeviceBuffer* buffer : {&made.rounded, &made.drive, &made.mean, &made.square, &made.slope})
    *buffer = device.make_buffer(values * sizeof(float), "the levels of a frame");
  return made;
}

}  // namespace

FramesOnDevice::FramesOnDevice(Device& device, const Grid& pixels, std::vector<Drive> start, size_t fixed)
    : device_(device), pixels_(pixels), fixed_(fixed) {
  for (Drive& levels : start) kept_.push_back({levels, levels, {}, {}, {}});
}

void FramesOnDevice::needs(const LightBytes& bytes) {
  bytes_.of_frame = std::max(bytes_.of_frame, bytes.of_frame);
  bytes_.beside = std::max(bytes_.beside, bytes.beside);
}

bool FramesOnDevice::are_streamed() {
  place();
  return are_streamed_;
}

void FramesOnDevice::place() {
  if (is_placed_) return;
  const size_t levels = kept_.front().drive.level.size(), moduli = kept_.front().drive.modulus.size();
  const double of_frame = double(pixels_.pixels()) * bytes_of_drives(moduli > 0 ? 2 : 1) + bytes_.of_frame;
  are_streamed_ = double(frames()) * of_frame + bytes_.beside > device_.memory_left();
  for (size_t m = 0; m < (are_streamed_ ? 1 : frames()); ++m)
    frames_.push_back({make_drive(device_, levels), make_drive(device_, moduli)});
  for (size_t m = 0; m < frames(); ++m) {
    KeptFrame& kept = kept_[m];
    if (are_streamed_) {
      for (Drive* array : {&kept.mean, &kept.square, &kept.slope}) *array = Drive::like(kept.drive);
      continue;
    }
    for (const KeptArray array : {&KeptFrame::rounded, &KeptFrame::drive}) send(kept, array, frames_[m]);
    for (const DeviceDrive* values : {&frames_[m].level, &frames_[m].modulus})
      for (const DeviceBuffer* array : {&values->mean, &values->square, &values->slope})
        if (array->bytes() > 0) clear(device_, *array);
    kept = {};
  }
  is_placed_ = true;
}

void FramesOnDevice::send(const KeptFrame& kept, KeptArray array, const DeviceFrame& frame) const {
  const Drive& from = kept.*array;
  device_.write(on_device(frame.level, array), from.level.values.data(), from.level.size() * sizeof(float));
  device_.write(on_device(frame.modulus, array), from.modulus.values.data(), from.modulus.size() * sizeof(float));
}

void FramesOnDevice::fetch(const DeviceFrame& frame, KeptArray array, KeptFrame& kept) const {
  const auto take = [&](const DeviceBuffer& from, Array2D<float>& to) {
    if (from.bytes() > 0 && to.size() == 0) to = Array2D<float>(pixels_.ny, pixels_.nx);
    device_.read(from, to.values.data(), from.bytes());
  };
  take(on_device(frame.level, array), (kept.*array).level);
  take(on_device(frame.modulus, array), (kept.*array).modulus);
}

void FramesOnDevice::each_frame(FrameUse use, const std::function<void(size_t m, const DeviceFrame& frame)>& work) {
  place();
  for (size_t m = use == FrameUse::light ? 0 : fixed_; m < frames(); ++m) {
    if (!are_streamed_) {
      work(m, frames_[m]);
      continue;
    }
    const DeviceFrame& there = frames_.front();
    for (const KeptArray array : sent_for(use)) send(kept_[m], array, there);
    work(m, there);
    for (const KeptArray array : changed_by(use)) fetch(there, array, kept_[m]);
  }
}

void FramesOnDevice::clear_slopes() {
  place();
  if (are_streamed_) {
    for (KeptFrame& kept : kept_) kept.slope = Drive::like(kept.drive);
    return;
  }
  for (const DeviceFrame& frame : frames_)
    for (const DeviceDrive* values : {&frame.level, &frame.modulus})
      if (values->slope.bytes() > 0) clear(device_, values->slope);
}

void FramesOnDevice::step(const DriveStep& step) {
  each_frame(FrameUse::step, [&](size_t, const DeviceFrame& frame) {
    step_drives(device_, step.level, step.levels_per_cycle, step, frame.level);
    if (frame.modulus.drive.bytes() > 0) step_drives(device_, step.modulus, 0, step, frame.modulus);
  });
}

Drive FramesOnDevice::rounded(size_t frame) {
  place();
  if (are_streamed_) return kept_[frame].rounded;
  KeptFrame found;
  fetch(frames_[frame], &KeptFrame::rounded, found);
  return found.rounded;
}

void FramesOnDevice::add_state(std::vector<Array2D<float>>& state) {
  place();
  for (size_t m = 0; m < frames(); ++m)
    for (const KeptArray array : of_state) {
      KeptFrame found;
      if (!are_streamed_) fetch(frames_[m], array, found);
      each_array(are_streamed_ ? kept_[m].*array : found.*array,
                 [&](const Array2D<float>& values) { state.push_back(values); });
    }
}

void FramesOnDevice::restore(const std::vector<Array2D<float>>& state, size_t& next) {
  place();
  for (size_t m = 0; m < frames(); ++m)
    for (const KeptArray array : of_state) {
      KeptFrame restored;
      (restored.*array).level = state[next++];
      const bool has_moduli = (are_streamed_ ? kept_[m].drive.modulus.size() : frames_[m].modulus.drive.bytes()) > 0;
      if (has_moduli) (restored.*array).modulus = state[next++];
      if (are_streamed_)
        kept_[m].*array = std::move(restored.*array);
      else
        send(restored, array, frames_[m]);
    }
}

}  // namespace holotrace
