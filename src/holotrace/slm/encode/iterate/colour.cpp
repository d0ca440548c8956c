#include "holotrace/slm/encode/iterate/colour.h"

#include <algorithm>

#include "holotrace/slm/encode/iterate/target_sums.h"

namespace holotrace {
namespace {

constexpr double not_known = -1;  // the error of a plane

}  // namespace

Colour::Colour(const Slm& slm, const Hologram& hologram, double wavelength, const EncodeParams& params,
               FrameArrays& frames)
    : wavelength_(wavelength),
      panel_(slm, hologram, wavelength, params.subpixels),
      frames_light_(frames.light_of(panel_, wavelength)) {}

void Colour::add(const TargetPlane& target) {
  frames_light_->add(target);
  targets_.push_back(&target);
  errors_.push_back(not_known);
  powers_.push_back(target_power(target));
  power_ += powers_.back();
  are_smooth_ = are_smooth_ && is_smooth(target);
}

double Colour::error() const {
  double error = 0, power = 0;
  for (size_t k = 0; k < errors_.size(); ++k)
    if (errors_[k] != not_known) {
      error += errors_[k];
      power += powers_[k];
    }
  return power > 0 ? error * power_ / power : power_;
}

void Colour::judge() {
  leave();
  ModulusSums all;
  std::vector<ModulusSums> sums;
  for (size_t k = 0; k < targets_.size(); ++k) {
    sums.push_back(frames_light_->plane_sums(k, SampleGroup::all, false));
    all.cross += sums.back().cross;
    all.square += sums.back().square;
  }
  fit_scale(all, 0);
  light_ = all.square;
  for (size_t k = 0; k < targets_.size(); ++k)
    errors_[k] = powers_[k] - 2 * scale_ * sums[k].cross + scale_ * scale_ * sums[k].square;
}

// The scale that fits the planes of the latest turns: the sums of each earlier update count `memory` times those of
// the next one, because the light in the planes grows while the frames are found.
void Colour::fit_scale(const ModulusSums& turn, double memory) {
  recent_.cross = memory * recent_.cross + turn.cross;
  recent_.square = memory * recent_.square + turn.square;
  scale_ = recent_.square > 0 && recent_.cross > 0 ? recent_.cross / recent_.square : 1;
}

void Colour::add_planes(const std::vector<size_t>& planes, SampleGroup samples, double factor) {
  ModulusSums turn;
  for (const size_t plane : planes) {
    const ModulusSums sums = frames_light_->plane_sums(plane, samples, true);
    turn.cross += sums.cross;
    turn.square += sums.square;
  }
  // Of all planes, the sums need no others.
  fit_scale(turn, std::min(0.7, 1 - double(planes.size()) / double(targets_.size())));
  for (const size_t plane : planes) errors_[plane] = frames_light_->add_gradient(plane, samples, scale_, factor);
}

}  // namespace holotrace
