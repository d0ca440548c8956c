#include "holotrace/slm/encode/iterate/device_arrays.h"

#include <algorithm>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include "holotrace/base/own_threads.h"
#include "holotrace/slm/encode/iterate/frames_light.h"
#include "holotrace/slm/encode/iterate/processor_arrays.h"

namespace holotrace {
namespace {

/// The light of all frames on OpenCL devices, each of which computes that of its share. Of one device, only the row sums of
/// the planes leave it.
///
/// **Of several devices**, each computes its frames' part of the mean irradiance of a plane. The parts of the others go to the
/// first one, by way of the processor, which adds them in the order of the shares. The first one has the target; what the
/// residual's factor is there goes back to the others. So for each plane of an update 4 bytes per pixel leave each device but the
/// first and 4 arrive there; 4 arrive at the first one and 4 leave it. Views are the same, with the pixels of their pictures.
///
/// **With frames of other processes** (OtherFrames), the first device's sum goes on to them in the same way.
class DeviceLight : public WavelengthLight {
 public:
  /// @param shares  must outlive this object
  DeviceLight(const std::vector<std::unique_ptr<FramesOnDevice>>& shares, const PanelInLight& panel,
              const OtherFrames& others = {});

  void add(const TargetPlane& target) override;
  void leave(const PanelDetail& detail) override;
  ModulusSums plane_sums(size_t plane, SampleGroup group, bool is_kept) override;
  double add_gradient(size_t plane, SampleGroup group, double scale, double factor) override;
  ModulusSums view_sums(const ViewTargets& views, bool is_kept) override;
  double add_gradient_of_views(const ViewTargets& views, double scale, double factor) override;

 private:
  using Part = std::function<const DeviceBuffer&(const FramesLight& share)>;
  void on_all(const std::function<void(FramesLight& share)>& work);
  void add_parts(const Part& part);
  void add_other_processes(const Part& part);
  void send_to_others(const Part& part);

  const std::vector<std::unique_ptr<FramesOnDevice>>& shares_;
  PanelInLight lit_;
  OtherFrames others_;
  size_t frames_ = 0;                                 // of all processes
  std::vector<std::unique_ptr<FramesLight>> lights_;  // of each share
  std::vector<std::vector<float>> parts_{};           // of all but the first, on the processor
  PupilPropagations pupils_;
};

DeviceLight::DeviceLight(const std::vector<std::unique_ptr<FramesOnDevice>>& shares, const PanelInLight& panel,
                         const OtherFrames& others)
    : shares_(shares), lit_(panel), others_(others), frames_(others.count) {
  for (const auto& share : shares_) frames_ += share->frames();
  for (const auto& share : shares_)
    lights_.push_back(std::make_unique<FramesLight>(*share, lit_, frames_, others_.has_targets() && lights_.empty()));
}

void DeviceLight::on_all(const std::function<void(FramesLight& share)>& work) {
  on_all_shares(shares_, [&](size_t i) { work(*lights_[i]); });
}

void DeviceLight::add(const TargetPlane& target) {
  // Before a device is locked: it runs on many threads, which may be waiting for the device.
  const TargetPropagation way(lit_.slm, lit_.wavelength, target.z, optics_of(lit_.panel, lit_.params));
  on_all([&](FramesLight& share) { share.add(target, way); });
}

void DeviceLight::leave(const PanelDetail& detail) {
  on_all([&](FramesLight& share) { share.leave(detail); });
}

// The first share's part becomes the sum of all parts, which are added in the order of the shares.
void DeviceLight::add_parts(const Part& part) {
  if (shares_.size() == 1) return;
  const DeviceBuffer& sum = part(*lights_.front());
  parts_.resize(shares_.size());
  on_all_shares(shares_, [&](size_t i) {
    if (i == 0) return;
    parts_[i].resize(sum.bytes() / sizeof(float));
    shares_[i]->device().read(part(*lights_[i]), parts_[i].data(), sum.bytes());
  });
  for (size_t i = 2; i < parts_.size(); ++i)
    for (size_t k = 0; k < parts_[i].size(); ++k) parts_[1][k] += parts_[i][k];
  Device& first = shares_.front()->device();
  const auto lock = first.lock();
  DeviceBuffer& received = shares_.front()->memory().received;
  if (received.bytes() < sum.bytes()) received = first.make_buffer(sum.bytes(), "the light of a target plane");
  first.write(received, parts_[1].data(), sum.bytes());
  add_part(first, received, 1, true, sum);
}

// The sum of this process becomes, on the first process, that of all. No device is locked while it waits for the others.
void DeviceLight::add_other_processes(const Part& part) {
  if (!others_.exchange) return;
  const DeviceBuffer& sum = part(*lights_.front());
  Device& first = shares_.front()->device();
  std::vector<float> values(sum.bytes() / sizeof(float));
  {
    const auto lock = first.lock();
    first.read(sum, values.data(), sum.bytes());
  }
  others_.exchange->reduce_to_first(values.data(), values.size());
  if (!others_.has_targets()) return;
  const auto lock = first.lock();
  first.write(sum, values.data(), sum.bytes());
}

// What the first share of the first process has goes to all others.
void DeviceLight::send_to_others(const Part& part) {
  if (shares_.size() == 1 && !others_.exchange) return;
  const DeviceBuffer& from = part(*lights_.front());
  std::vector<float> values(from.bytes() / sizeof(float));
  if (others_.has_targets()) {
    Device& first = shares_.front()->device();
    const auto lock = first.lock();
    first.read(from, values.data(), from.bytes());
  }
  if (others_.exchange) others_.exchange->broadcast_from_first(values.data(), values.size());
  on_all_shares(shares_, [&](size_t i) {
    if (i > 0 || !others_.has_targets()) shares_[i]->device().write(part(*lights_[i]), values.data(), from.bytes());
  });
}

ModulusSums DeviceLight::plane_sums(size_t plane, SampleGroup group, bool is_kept) {
  on_all([&](FramesLight& share) { share.show(plane, group, is_kept); });
  const Part mean = [&](const FramesLight& share) -> const DeviceBuffer& { return share.mean(plane); };
  add_parts(mean);
  add_other_processes(mean);
  const auto lock = shares_.front()->device().lock();
  const ModulusSums sums = others_.has_targets() ? lights_.front()->fit_sums(plane) : ModulusSums();
  if (!is_kept)
    for (const auto& light : lights_) light->drop(plane);
  return sums;
}

double DeviceLight::add_gradient(size_t plane, SampleGroup group, double scale, double factor) {
  double error = 0;
  if (others_.has_targets()) {
    const auto lock = shares_.front()->device().lock();
    error = scale * scale * lights_.front()->leave_residual(plane, 1 / scale);
  }
  send_to_others([&](const FramesLight& share) -> const DeviceBuffer& { return share.mean(plane); });
  const double of_frame = -2 * scale * scale * factor * irradiance_factor(group) / double(frames_);
  on_all([&](FramesLight& share) {
    share.add_slopes(plane, group, of_frame);
    share.drop(plane);
  });
  return error;
}

ModulusSums DeviceLight::view_sums(const ViewTargets& views, bool is_kept) {
  // Before a device is locked, as in add.
  const PupilPropagation& way = pupils_.to(lit_.slm, lit_.wavelength, views, optics_of(lit_.panel, lit_.params));
  on_all([&](FramesLight& share) { share.show_views(views, way, is_kept); });
  ModulusSums sums;
  for (size_t k = 0; k < views.pupils.size(); ++k) {
    const Part mean = [k](const FramesLight& share) -> const DeviceBuffer& { return share.mean_of_view(k); };
    add_parts(mean);
    add_other_processes(mean);
    if (!others_.has_targets()) continue;
    const auto lock = shares_.front()->device().lock();
    const ModulusSums of_view = lights_.front()->fit_sums_of_view(k);
    sums.cross += of_view.cross;
    sums.square += of_view.square;
  }
  if (!is_kept) on_all([](FramesLight& share) { share.drop_views(); });
  return sums;
}

double DeviceLight::add_gradient_of_views(const ViewTargets& views, double scale, double factor) {
  double error = 0;
  for (size_t k = 0; k < views.pupils.size(); ++k) {
    if (others_.has_targets()) {
      const auto lock = shares_.front()->device().lock();
      error += scale * scale * lights_.front()->leave_residual_of_view(k, 1 / scale);
    }
    send_to_others([k](const FramesLight& share) -> const DeviceBuffer& { return share.mean_of_view(k); });
  }
  const double of_frame = -2 * scale * scale * factor / double(frames_);
  on_all([&](FramesLight& share) {
    share.add_slopes_of_views(of_frame);
    share.drop_views();
  });
  return error;
}

}  // namespace

DeviceFrames::DeviceFrames(const std::vector<Device*>& devices, const Slm& slm, const EncodeParams& params,
                           const std::vector<Hologram>& frames, const OtherFrames& others, size_t fixed)
    : slm_(slm), params_(params), others_(others) {
  for (const FrameRange& range : ranges_of_frames(frames.size(), devices.size())) {
    std::vector<Drive> start;
    for (size_t m = range.first; m < range.last; ++m) start.push_back(drive_of(frames[m]));
    shares_.push_back(std::make_unique<FramesOnDevice>(*devices[shares_.size()], slm.grid, std::move(start),
                                                       range.count_below(fixed)));
  }
}

void on_all_shares(const std::vector<std::unique_ptr<FramesOnDevice>>& shares,
                   const std::function<void(size_t i)>& work) {
  run_together(int(shares.size()), [&](int i, const std::atomic<bool>&) {
    const auto lock = shares[size_t(i)]->device().lock();
    work(size_t(i));
  });
}

std::unique_ptr<WavelengthLight> DeviceFrames::light_of(const DrivenPanel& panel, double wavelength) {
  return std::make_unique<DeviceLight>(shares_, PanelInLight{slm_, params_, panel, wavelength}, others_);
}

void DeviceFrames::clear_slopes() {
  on_all_shares(shares_, [&](size_t i) { shares_[i]->clear_slopes(); });
}

void DeviceFrames::step(const DriveStep& step) {
  on_all_shares(shares_, [&](size_t i) { shares_[i]->step(step); });
}

void DeviceFrames::write(std::vector<Hologram>& frames) const {
  const auto put = [](const Array2D<float>& from, Array2D<uint16_t>& to) {
    std::copy(from.values.begin(), from.values.end(), to.values.begin());
  };
  std::vector<Hologram> written = frames;  // a device that fails leaves the frames as they were
  size_t next = 0;
  for (const auto& share : shares_) {
    const auto lock = share->device().lock();
    for (size_t m = 0; m < share->frames(); ++m, ++next) {
      const Drive levels = share->rounded(m);
      put(levels.level, written[next].level);
      put(levels.modulus, written[next].modulus_level);
    }
  }
  frames = std::move(written);
}

std::vector<Array2D<float>> DeviceFrames::state() {
  std::vector<Array2D<float>> arrays;
  for (const auto& share : shares_) {
    const auto lock = share->device().lock();
    share->add_state(arrays);
  }
  return arrays;
}

void DeviceFrames::restore(const std::vector<Array2D<float>>& state) {
  size_t next = 0;
  for (const auto& share : shares_) {
    const auto lock = share->device().lock();
    share->restore(state, next);
  }
}

}  // namespace holotrace
