#include "holotrace/slm/encode/iterate/wavelength_descent.h"

#include <algorithm>
#include <cmath>

#include "holotrace/slm/encode/iterate/target_sums.h"

namespace holotrace {
namespace {

constexpr double not_known = -1;  // the error of a plane

}  // namespace

WavelengthDescent::WavelengthDescent(const Slm& slm, const Hologram& hologram, double wavelength,
                                     const EncodeParams& params, FrameArrays& frames)
    : wavelength_(wavelength),
      pixels_(slm.grid),
      panel_(slm, hologram, wavelength, params.subpixels),
      wavelength_light_(frames.light_of(panel_, wavelength)) {}

void WavelengthDescent::add(const TargetPlane& target) {
  wavelength_light_->add(target);
  targets_.push_back(&target);
  errors_.push_back(not_known);
  powers_.push_back(target_power(target));
  power_ += powers_.back();
  peak_ = std::max(peak_, target_peak(target));
  if (target.weight.size() == 0) weight_ += double(target.amplitude.size());
  for (const float w : target.weight.values) weight_ += double(w);
  are_smooth_ = are_smooth_ && is_smooth(target);
}

void WavelengthDescent::add(const ViewTargets& views) {
  views_.push_back(&views);
  errors_.push_back(not_known);
  powers_.push_back(target_power(views));
  power_ += powers_.back();
  for (const Array2D<float>& amplitude : views.amplitudes) {
    weight_ += double(amplitude.size());
    for (const float a : amplitude.values) peak_ = std::max(peak_, double(a));
  }
  are_smooth_ = false;
}

double WavelengthDescent::error() const {
  double error = 0, power = 0;
  for (size_t k = 0; k < errors_.size(); ++k)
    if (errors_[k] != not_known) {
      error += errors_[k];
      power += powers_[k];
    }
  return power > 0 ? error * power_ / power : power_;
}

void WavelengthDescent::judge() {
  leave();
  ModulusSums all;
  std::vector<ModulusSums> sums;
  light_ = 0;
  const auto add_sums = [&](const ModulusSums& one, double pixels_of_sample) {
    sums.push_back(one);
    all.cross += one.cross;
    all.square += one.square;
    light_ += one.square * pixels_of_sample / (double(turns()) * double(pixels_.pixels()));
  };
  for (size_t k = 0; k < targets_.size(); ++k) add_sums(wavelength_light_->plane_sums(k, SampleGroup::all, false), 1);
  for (const ViewTargets* views : views_)
    add_sums(wavelength_light_->view_sums(*views, false), std::pow(views->picture.pitch / pixels_.pitch, 2));
  fit_scale(all, 0);
  for (size_t k = 0; k < sums.size(); ++k)
    errors_[k] = powers_[k] - 2 * scale_ * sums[k].cross + scale_ * scale_ * sums[k].square;
}

void WavelengthDescent::add_views(const ViewTargets& views, double factor) {
  const double light = target_power(views);
  if (light == 0) return;
  constexpr double memory = 0.7;
  const ModulusSums sums = wavelength_light_->view_sums(views, true);
  if (targets_.empty()) fit_scale(sums, memory);
  const double error = wavelength_light_->add_gradient_of_views(views, scale_, factor / light);
  if (!targets_.empty()) return;
  for (size_t k = 0; k < views_.size(); ++k)
    if (views_[k]->z == views.z) errors_[k] = error / light * powers_[k];
}

// The scale that fits the planes of the latest turns: the sums of each earlier update count `memory` times those of
// the next one, because the light in the planes grows while the frames are found.
void WavelengthDescent::fit_scale(const ModulusSums& turn, double memory) {
  recent_.cross = memory * recent_.cross + turn.cross;
  recent_.square = memory * recent_.square + turn.square;
  scale_ = recent_.square > 0 && recent_.cross > 0 ? recent_.cross / recent_.square : 1;
}

void WavelengthDescent::add_planes(const std::vector<size_t>& planes, SampleGroup samples, double factor) {
  ModulusSums turn;
  for (const size_t plane : planes) {
    const ModulusSums sums = wavelength_light_->plane_sums(plane, samples, true);
    turn.cross += sums.cross;
    turn.square += sums.square;
  }
  // Of all planes, the sums need no others.
  fit_scale(turn, std::min(0.7, 1 - double(planes.size()) / double(targets_.size())));
  for (const size_t plane : planes) errors_[plane] = wavelength_light_->add_gradient(plane, samples, scale_, factor);
}

}  // namespace holotrace
