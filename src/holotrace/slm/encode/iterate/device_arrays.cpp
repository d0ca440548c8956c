#include "holotrace/slm/encode/iterate/device_arrays.h"

#include <algorithm>
#include <utility>

#include "holotrace/base/run_together.h"
#include "holotrace/slm/encode/iterate/device_light.h"
#include "holotrace/slm/encode/iterate/processor_arrays.h"

namespace holotrace {

DeviceFrames::DeviceFrames(const std::vector<Device*>& devices, const Slm& slm, const EncodeParams& params,
                           const std::vector<Hologram>& frames, const OtherFrames& others)
    : slm_(slm), params_(params), others_(others) {
  const size_t shares = std::min(devices.size(), frames.size());
  for (size_t i = 0; i < shares; ++i) {
    std::vector<Drive> start;
    for (size_t m = i * frames.size() / shares; m < (i + 1) * frames.size() / shares; ++m)
      start.push_back(drive_of(frames[m]));
    shares_.push_back(std::make_unique<FrameShare>(*devices[i], slm.grid, std::move(start)));
  }
}

void on_all_shares(const std::vector<std::unique_ptr<FrameShare>>& shares, const std::function<void(size_t i)>& work) {
  run_together(int(shares.size()), [&](int i, const std::atomic<bool>&) {
    const auto lock = shares[size_t(i)]->device().lock();
    work(size_t(i));
  });
}

std::unique_ptr<ColourLight> DeviceFrames::light_of(const DrivenPanel& panel, double wavelength) {
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
