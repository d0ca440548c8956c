#include "holotrace/slm/encode/iterate/device_light.h"

#include <utility>

namespace holotrace {

DeviceLight::DeviceLight(const std::vector<std::unique_ptr<FrameShare>>& shares, const PanelInLight& panel,
                         const OtherFrames& others)
    : shares_(shares), lit_(panel), others_(others), frames_(others.count) {
  for (const auto& share : shares_) frames_ += share->frames();
  for (const auto& share : shares_)
    lights_.push_back(std::make_unique<ShareLight>(*share, lit_, frames_, others_.has_targets() && lights_.empty()));
}

void DeviceLight::on_all(const std::function<void(ShareLight& share)>& work) {
  on_all_shares(shares_, [&](size_t i) { work(*lights_[i]); });
}

void DeviceLight::add(const TargetPlane& target) {
  // Before a device is locked: it runs on many threads, which may be waiting for the device.
  const TargetPropagation way(lit_.slm, lit_.wavelength, target.z, optics_of(lit_.panel, lit_.params));
  on_all([&](ShareLight& share) { share.add(target, way); });
}

void DeviceLight::leave(const PanelDetail& detail) {
  on_all([&](ShareLight& share) { share.leave(detail); });
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
  others_.exchange->add_up(values.data(), values.size());
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
  if (others_.exchange) others_.exchange->hand_out(values.data(), values.size());
  on_all_shares(shares_, [&](size_t i) {
    if (i > 0 || !others_.has_targets()) shares_[i]->device().write(part(*lights_[i]), values.data(), from.bytes());
  });
}

ModulusSums DeviceLight::plane_sums(size_t plane, SampleGroup group, bool is_kept) {
  on_all([&](ShareLight& share) { share.show(plane, group, is_kept); });
  const Part mean = [&](const ShareLight& share) -> const DeviceBuffer& { return share.mean(plane); };
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
  send_to_others([&](const ShareLight& share) -> const DeviceBuffer& { return share.mean(plane); });
  const double of_frame = -2 * scale * scale * factor * part_of_light(group) / double(frames_);
  on_all([&](ShareLight& share) {
    share.add_slopes(plane, group, of_frame);
    share.drop(plane);
  });
  return error;
}

ModulusSums DeviceLight::view_sums(const ViewTargets& views, bool is_kept) {
  // Before a device is locked, as in add.
  const PupilPropagation& way = pupils_.to(lit_.slm, lit_.wavelength, views, optics_of(lit_.panel, lit_.params));
  on_all([&](ShareLight& share) { share.show_views(views, way, is_kept); });
  ModulusSums sums;
  for (size_t k = 0; k < views.pupils.size(); ++k) {
    const Part mean = [k](const ShareLight& share) -> const DeviceBuffer& { return share.mean_of_view(k); };
    add_parts(mean);
    add_other_processes(mean);
    if (!others_.has_targets()) continue;
    const auto lock = shares_.front()->device().lock();
    const ModulusSums of_view = lights_.front()->fit_sums_of_view(k);
    sums.cross += of_view.cross;
    sums.square += of_view.square;
  }
  if (!is_kept) on_all([](ShareLight& share) { share.drop_views(); });
  return sums;
}

double DeviceLight::add_gradient_of_views(const ViewTargets& views, double scale, double factor) {
  double error = 0;
  for (size_t k = 0; k < views.pupils.size(); ++k) {
    if (others_.has_targets()) {
      const auto lock = shares_.front()->device().lock();
      error += scale * scale * lights_.front()->leave_residual_of_view(k, 1 / scale);
    }
    send_to_others([k](const ShareLight& share) -> const DeviceBuffer& { return share.mean_of_view(k); });
  }
  const double of_frame = -2 * scale * scale * factor / double(frames_);
  on_all([&](ShareLight& share) {
    share.add_slopes_of_views(of_frame);
    share.drop_views();
  });
  return error;
}

}  // namespace holotrace
