// The part of the processes other than process 0 in a descent whose frames they share.

#include <deque>
#include <utility>

#include "holotrace/base/archive.h"
#include "holotrace/base/error.h"
#include "holotrace/data/members.h"
#include "holotrace/slm/encode/iterate/descent_device.h"
#include "holotrace/slm/encode/iterate/device_arrays.h"
#include "holotrace/slm/encode/iterate/frame_messages.h"
#include "holotrace/slm/encode/iterate/processor_arrays.h"
#include "holotrace/slm/encode/iterate/shared_frames.h"

namespace holotrace {
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
    member.arrays = std::make_unique<ProcessorFrames>(job.slm, job.params, job.frames, others);
  else
    member.arrays = std::make_unique<DeviceFrames>(devices, job.slm, job.params, job.frames, others);
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
