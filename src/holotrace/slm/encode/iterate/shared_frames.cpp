#include "holotrace/slm/encode/iterate/shared_frames.h"

#include <algorithm>
#include <deque>
#include <utility>

#include "holotrace/base/archive.h"
#include "holotrace/base/error.h"
#include "holotrace/data/members.h"
#include "holotrace/slm/encode/iterate/device_arrays.h"
#include "holotrace/slm/encode/iterate/iteration_devices.h"
#include "holotrace/slm/encode/iterate/processor_arrays.h"

namespace holotrace {
namespace {

template <class Value>
void receive_array(ProcessLinks& links, int from, Array2D<Value>& array) {
  Array2D<Value> received;
  from_message(links.receive(from), received);
  require(array.size() == 0 || (received.nx == array.nx && received.ny == array.ny),
          "expected {} × {} values from rank {}, got {} × {}", array.nx, array.ny, from, received.nx, received.ny);
  array = std::move(received);
}

}  // namespace

class SharedFrames::Exchange : public FrameExchange {
 public:
  Exchange(ProcessLinks& links, int processes) : links_(links), processes_(processes) {}

  bool is_first() const override { return true; }

  void reduce_to_first(float* values, size_t count) override {
    for (int process = 1; process < processes_; ++process) {
      std::vector<float> part;
      from_message(links_.receive(process), part);
      require(part.size() == count, "expected {} values from rank {}, got {}", count, process, part.size());
      for (size_t i = 0; i < count; ++i) values[i] += part[i];
    }
  }

  void broadcast_from_first(float* values, size_t count) override {
    const std::string bytes = to_message(std::vector<float>(values, values + count));
    for (int process = 1; process < processes_; ++process) links_.send(process, bytes);
  }

 private:
  ProcessLinks& links_;
  int processes_;
};

// Orders go out before the own work, which waits for what they bring.
class SharedFrames::Light : public WavelengthLight {
 public:
  Light(const SharedFrames& frames, uint64_t colour, std::unique_ptr<WavelengthLight> own)
      : frames_(frames), colour_(colour), own_(std::move(own)) {}

  void add(const TargetPlane& target) override {
    FrameOrderMessage message = to(FrameOrder::add);
    message.wavelength = target.wavelength;
    message.z = target.z;
    frames_.order(to_message(message));
    own_->add(target);
  }

  void leave(const PanelDetail& detail) override {
    FrameOrderMessage message = to(FrameOrder::leave);
    message.detail = detail;
    frames_.order(to_message(message));
    own_->leave(detail);
  }

  ModulusSums plane_sums(size_t plane, SampleGroup group, bool is_kept) override {
    FrameOrderMessage message = to(FrameOrder::plane_sums);
    message.plane = plane;
    message.group = group;
    message.is_kept = is_kept;
    frames_.order(to_message(message));
    return own_->plane_sums(plane, group, is_kept);
  }

  double add_gradient(size_t plane, SampleGroup group, double scale, double factor) override {
    FrameOrderMessage message = to(FrameOrder::add_gradient);
    message.plane = plane;
    message.group = group;
    message.scale = scale;
    message.factor = factor;
    frames_.order(to_message(message));
    return own_->add_gradient(plane, group, scale, factor);
  }

  ModulusSums view_sums(const ViewTargets& views, bool is_kept) override {
    FrameOrderMessage message = to(FrameOrder::view_sums);
    message.is_kept = is_kept;
    frames_.order(to_message(message));
    frames_.order(to_message(views));
    return own_->view_sums(views, is_kept);
  }

  double add_gradient_of_views(const ViewTargets& views, double scale, double factor) override {
    FrameOrderMessage message = to(FrameOrder::add_gradient_of_views);
    message.scale = scale;
    message.factor = factor;
    frames_.order(to_message(message));
    return own_->add_gradient_of_views(views, scale, factor);
  }

 private:
  FrameOrderMessage to(FrameOrder order) const { return {.order = order, .colour = colour_}; }

  const SharedFrames& frames_;
  uint64_t colour_;
  std::unique_ptr<WavelengthLight> own_;
};

SharedFrames::SharedFrames(ProcessLinks& links, const DescentSetup& setup, const DeviceChoice& device,
                           const std::vector<Hologram>& frames, const MakeArrays& make)
    : links_(links),
      ranges_(ranges_of_frames(frames.size(), size_t(links.count()))),
      arrays_of_frame_(arrays_of_state(frames) / frames.size()),
      exchange_(std::make_unique<Exchange>(links, int(ranges_.size()))) {
  const auto of_range = [&](const FrameRange& range) {
    return std::vector<Hologram>(frames.begin() + std::ptrdiff_t(range.first),
                                 frames.begin() + std::ptrdiff_t(range.last));
  };
  FrameJob job{setup.slm, setup.params, {}, frames.size()};
  job.params.device = device;
  const size_t fixed = setup.start.fixed;
  for (size_t i = 1; i < ranges_.size(); ++i) {
    job.frames = of_range(ranges_[i]);
    job.fixed = ranges_[i].count_below(fixed);
    links_.send(int(i), job_message(job));
    for (const Hologram& frame : job.frames) links_.send(int(i), frame_message(frame));
  }
  const FrameRange& own = ranges_.front();
  own_ = make(of_range(own), {frames.size() - own.count(), exchange_.get()}, own.count_below(fixed));
}

SharedFrames::~SharedFrames() = default;

void SharedFrames::order(const std::string& bytes) const {
  for (size_t i = 1; i < ranges_.size(); ++i) links_.send(int(i), bytes);
}

std::unique_ptr<WavelengthLight> SharedFrames::light_of(const DrivenPanel& panel, double wavelength) {
  order(to_message(FrameOrderMessage{.order = FrameOrder::light_of, .wavelength = wavelength}));
  return std::make_unique<Light>(*this, wavelengths_++, own_->light_of(panel, wavelength));
}

void SharedFrames::clear_slopes() {
  order(to_message(FrameOrderMessage{.order = FrameOrder::clear_slopes}));
  own_->clear_slopes();
}

void SharedFrames::step(const DriveStep& step) {
  FrameOrderMessage message{.order = FrameOrder::step};
  message.step = step;
  order(to_message(message));
  own_->step(step);
}

void SharedFrames::end_steps() {
  order(to_message(FrameOrderMessage{.order = FrameOrder::end_steps}));
  own_->end_steps();
}

void SharedFrames::write(std::vector<Hologram>& frames) const {
  order(to_message(FrameOrderMessage{.order = FrameOrder::write}));
  std::vector<Hologram> own(frames.begin(), frames.begin() + std::ptrdiff_t(ranges_.front().count()));
  own_->write(own);
  std::move(own.begin(), own.end(), frames.begin());
  for (size_t i = 1; i < ranges_.size(); ++i)
    for (size_t m = ranges_[i].first; m < ranges_[i].last; ++m) {
      receive_array(links_, int(i), frames[m].level);
      receive_array(links_, int(i), frames[m].modulus_level);
    }
}

std::vector<Array2D<float>> SharedFrames::state() {
  order(to_message(FrameOrderMessage{.order = FrameOrder::state}));
  std::vector<Array2D<float>> arrays = own_->state();
  for (size_t i = 1; i < ranges_.size(); ++i)
    for (size_t k = 0; k < ranges_[i].count() * arrays_of_frame_; ++k)
      receive_array(links_, int(i), arrays.emplace_back());
  return arrays;
}

void SharedFrames::restore(const std::vector<Array2D<float>>& state) {
  order(to_message(FrameOrderMessage{.order = FrameOrder::restore}));
  for (size_t i = 1; i < ranges_.size(); ++i)
    for (size_t k = ranges_[i].first * arrays_of_frame_; k < ranges_[i].last * arrays_of_frame_; ++k)
      links_.send(int(i), to_message(state[k]));
  own_->restore({state.begin(), state.begin() + std::ptrdiff_t(ranges_.front().count() * arrays_of_frame_)});
}

void SharedFrames::finish() { order(to_message(FrameOrderMessage{.order = FrameOrder::end})); }

std::string job_message(const FrameJob& job) {
  return to_message(job.slm, job.params, uint64_t(job.frames_of_all), uint64_t(job.fixed), uint64_t(job.frames.size()));
}

FrameJob job_from(const std::string& message) {
  FrameJob job;
  uint64_t frames_of_all = 0, fixed = 0, frames = 0;
  from_message(message, job.slm, job.params, frames_of_all, fixed, frames);
  job.frames_of_all = frames_of_all;
  job.fixed = fixed;
  job.frames.resize(frames);
  return job;
}

std::string frame_message(Hologram frame) {
  frame.slm.reset();
  return to_message(frame);
}

// --- the processes other than process 0 ---

namespace {

// Process 0 adds up, and hands out.
class ExchangeWithFirst : public FrameExchange {
 public:
  explicit ExchangeWithFirst(ProcessLinks& links) : links_(links) {}

  bool is_first() const override { return false; }

  void reduce_to_first(float* values, size_t count) override {
    links_.send(0, to_message(std::vector<float>(values, values + count)));
  }

  void broadcast_from_first(float* values, size_t count) override {
    std::vector<float> received;
    from_message(links_.receive(0), received);
    require(received.size() == count, "expected {} values from rank 0, got {}", count, received.size());
    std::copy(received.begin(), received.end(), values);
  }

 private:
  ProcessLinks& links_;
};

// A wavelength: the light needs its panel, and its planes as places without targets.
struct WavelengthOfProcess {
  DrivenPanel panel;
  std::deque<TargetPlane> planes{};  // they stay where they are
  ViewTargets views{};               // the last ones
  std::unique_ptr<WavelengthLight> light{};
};

// The frames here.
struct Member {
  ProcessLinks& links;
  FrameJob job;
  ExchangeWithFirst exchange{links};
  std::unique_ptr<FrameArrays> arrays{};
  std::deque<WavelengthOfProcess> colours{};
};

void make_arrays(Member& member) {
  const FrameJob& job = member.job;
  const OtherFrames others{job.frames_of_all - job.frames.size(), &member.exchange};
  const std::vector<Device*> devices = devices_of_process(job.params.device, member.links.here(), job.frames.size());
  if (devices.empty())
    member.arrays = std::make_unique<ProcessorFrames>(job.slm, job.params, job.frames, others, job.fixed);
  else
    member.arrays = std::make_unique<DeviceFrames>(devices, job.slm, job.params, job.frames, others, job.fixed);
}

void add_colour(Member& member, double wavelength) {
  const FrameJob& job = member.job;
  member.colours.push_back({DrivenPanel(job.slm, job.frames.front(), wavelength, job.params.subpixels)});
  WavelengthOfProcess& colour = member.colours.back();
  colour.light = member.arrays->light_of(colour.panel, wavelength);
}

void add_plane(WavelengthOfProcess& colour, const FrameOrderMessage& message) {
  TargetPlane& plane = colour.planes.emplace_back();
  plane.z = message.z;
  plane.wavelength = message.wavelength;
  colour.light->add(plane);
}

void send_levels(Member& member) {
  std::vector<Hologram>& frames = member.job.frames;
  member.arrays->write(frames);
  for (const Hologram& frame : frames) {
    member.links.send(0, to_message(frame.level));
    member.links.send(0, to_message(frame.modulus_level));
  }
}

void take_state(Member& member) {
  std::vector<Array2D<float>> state(arrays_of_state(member.job.frames));
  for (Array2D<float>& array : state) from_message(member.links.receive(0), array);
  member.arrays->restore(state);
}

void obey(Member& member, const FrameOrderMessage& message) {
  FrameArrays& arrays = *member.arrays;
  const auto colour = [&]() -> WavelengthOfProcess& { return member.colours.at(message.colour); };
  switch (message.order) {
    case FrameOrder::light_of:
      return add_colour(member, message.wavelength);
    case FrameOrder::add:
      return add_plane(colour(), message);
    case FrameOrder::clear_slopes:
      return arrays.clear_slopes();
    case FrameOrder::step:
      return arrays.step(message.step);
    case FrameOrder::end_steps:
      return arrays.end_steps();
    case FrameOrder::leave:
      return colour().light->leave(message.detail);
    case FrameOrder::plane_sums:
      colour().light->plane_sums(message.plane, message.group, message.is_kept);
      return;
    case FrameOrder::add_gradient:
      colour().light->add_gradient(message.plane, message.group, message.scale, message.factor);
      return;
    case FrameOrder::view_sums:
      from_message(member.links.receive(0), colour().views);
      colour().light->view_sums(colour().views, message.is_kept);
      return;
    case FrameOrder::add_gradient_of_views:
      colour().light->add_gradient_of_views(colour().views, message.scale, message.factor);
      return;
    case FrameOrder::write:
      return send_levels(member);
    case FrameOrder::state:
      for (const Array2D<float>& array : arrays.state()) member.links.send(0, to_message(array));
      return;
    case FrameOrder::restore:
      return take_state(member);
    case FrameOrder::end:
      return;
  }
}

}  // namespace

void optimise_frames_for_first_process(ProcessLinks& links) {
  Member member{links, job_from(links.receive(0))};
  for (Hologram& frame : member.job.frames) from_message(links.receive(0), frame);
  make_arrays(member);
  for (FrameOrderMessage message; message.order != FrameOrder::end;) {
    from_message(links.receive(0), message);
    obey(member, message);
  }
}

}  // namespace holotrace
