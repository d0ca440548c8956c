#include "holotrace/slm/encode/iterate/processor_arrays.h"

#include <fmt/format.h>

#include <algorithm>

#include "holotrace/base/error.h"
#include "holotrace/base/memory.h"
#include "holotrace/base/threads.h"
#include "holotrace/slm/encode/iterate/processor_light.h"

namespace holotrace {
namespace {

template <class From, class To>
void copy_values(const Array2D<From>& from, Array2D<To>& to) {
  std::copy(from.values.begin(), from.values.end(), to.values.begin());
}

}  // namespace

Drive drive_of(const Hologram& hologram) {
  Drive drive{Array2D<float>(hologram.level.ny, hologram.level.nx),
              Array2D<float>(hologram.modulus_level.ny, hologram.modulus_level.nx)};
  copy_values(hologram.level, drive.level);
  copy_values(hologram.modulus_level, drive.modulus);
  return drive;
}

ProcessorFrames::ProcessorFrames(const Slm& slm, const EncodeParams& params, const std::vector<Hologram>& frames,
                                 const OtherFrames& others)
    : slm_(slm), params_(params), others_(others) {
  for (const Hologram& frame : frames) rounded_.push_back(drive_of(frame));
}

void ProcessorFrames::prepare_steps() {
  require(!have_steps_ended_, "expected no step and no state of a descent after its end");
  if (!frames_.empty()) return;
  for (const Drive& start : rounded_) {
    frames_.push_back({start, Drive::like(start), Drive::like(start)});
    slopes_.push_back(Drive::like(start));
  }
}

std::unique_ptr<WavelengthLight> ProcessorFrames::light_of(const DrivenPanel& panel, double wavelength) {
  return std::make_unique<ProcessorLight>(PanelInLight{slm_, params_, panel, wavelength}, rounded_, slopes_, others_);
}

void ProcessorFrames::clear_slopes() {
  prepare_steps();
  for (Drive& slope : slopes_)
    each_array(slope, [](Array2D<float>& values) { std::fill(values.values.begin(), values.values.end(), 0.0F); });
}

void ProcessorFrames::step(const DriveStep& step) {
  const auto move = [&](const AdamStep& adam, float turn, Array2D<float> Drive::*values, size_t m) {
    Frame& frame = frames_[m];
    parallel_for(
        0, (frame.drive.*values).ny,
        [&](int64_t row) {
          const int j = int(row);
          float* drive = (frame.drive.*values).row(j);
          const size_t nx = size_t((frame.drive.*values).nx);
          adam_step(adam, (slopes_[m].*values).row(j), (frame.mean.*values).row(j), (frame.square.*values).row(j),
                    drive, nx);
          settle_drive(turn, step.levels, step.hardness, drive, (rounded_[m].*values).row(j), nx);
        },
        {}, 16);
  };
  for (size_t m = 0; m < frames_.size(); ++m) {
    move(step.level, step.levels_per_cycle, &Drive::level, m);
    if (rounded_[m].modulus.size() > 0) move(step.modulus, 0, &Drive::modulus, m);
  }
}

void ProcessorFrames::end_steps() {
  frames_ = {};
  slopes_ = {};
  have_steps_ended_ = true;
}

void ProcessorFrames::write(std::vector<Hologram>& frames) const {
  for (size_t m = 0; m < frames.size(); ++m) {
    copy_values(rounded_[m].level, frames[m].level);
    copy_values(rounded_[m].modulus, frames[m].modulus_level);
  }
}

template <class Work>
void ProcessorFrames::each_array_of_state(const Work& work) {
  prepare_steps();
  for (size_t m = 0; m < frames_.size(); ++m)
    for (Drive* drive : {&rounded_[m], &frames_[m].drive, &frames_[m].mean, &frames_[m].square})
      each_array(*drive, work);
}

std::vector<Array2D<float>> ProcessorFrames::state() {
  std::vector<Array2D<float>> arrays;
  each_array_of_state([&](Array2D<float>& values) { arrays.push_back(values); });
  return arrays;
}

void ProcessorFrames::restore(const std::vector<Array2D<float>>& state) {
  size_t next = 0;
  each_array_of_state([&](Array2D<float>& values) { values = state[next++]; });
}

// Transfer functions and targets of the planes; drive, moments, slope, light and samples of the frames; all samples of one frame,
// for a judgement.
void require_memory_for_descent(size_t planes, const Slm& slm, const EncodeParams& params,
                                const std::vector<Hologram>& frames, int processes) {
  const Grid& grid = slm.grid;
  const size_t arrays = frames.front().modulation == Modulation::complex ? 2 : 1;
  const double fine = double(params.subpixels) * params.subpixels, samples = params.subpixels > 1 ? fine : 2;
  const size_t at_once = params.planes_per_update == 0 ? planes : std::min(planes, size_t(params.planes_per_update));
  const double of_plane = 4 + 16 * fine, of_frame = 20 * double(arrays) + 8 * fine + 8 * samples * double(at_once);
  require_memory(
      processes * double(grid.pixels()) * (of_plane * double(planes) + of_frame * double(frames.size()) + 32),
      fmt::format("gradient descent for {} frame(s) of {} × {} pixels and {} target plane(s){}", frames.size(), grid.nx,
                  grid.ny, planes, processes > 1 ? fmt::format(" in each of {} processes", processes) : ""));
}

}  // namespace holotrace
