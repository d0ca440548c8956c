#include "holotrace/run/denoised_pictures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "holotrace/data/acceptance.h"
#include "holotrace/denoise/denoise.h"
#include "holotrace/denoise/find_denoiser.h"
#include "holotrace/run/renders.h"
#include "holotrace/trace/focal_stack.h"

namespace holotrace {
namespace {

bool is_to_denoise(Denoise choice, PictureUse use) {
  return choice == Denoise::all || (choice == Denoise::automatic && use == PictureUse::to_look_at);
}

// Whether pictures of a scene can be denoised, which is stated.
bool can_denoise(const Scene& scene, Denoise choice, const Observer& observer) {
  const auto say_why_not = [&](const std::string& why, bool is_warned) {
    observer.fact("denoised", 0);
    observer.fact("why_not_denoised", why);
    if (is_warned) observer.warn("pictures are not denoised: " + why);
    return false;
  };
  if (!scene.points.empty())
    return say_why_not("the scene has luminous points, which look like noise", choice == Denoise::all);
  try {
    observer.fact("denoiser", find_denoiser());
    return true;
  } catch (const NoDenoiser& none) {
    return say_why_not(none.what(), none.is_broken || choice == Denoise::all);
  }
}

// An observer for a part of a task, from one fraction of it to another.
Observer between(const Observer& observer, double from, double to) {
  Observer part = observer;
  if (observer.on_progress)
    part.on_progress = [&observer, from, to](double fraction) { observer.progress(from + (to - from) * fraction); };
  return part;
}

// Channel 0 of up to three pictures from `first` on, as the channels of one; the last one fills up.
Image as_channels(const std::vector<Image>& pictures, size_t first) {
  Image all = pictures[first];
  for (size_t c = 1; c < 3; ++c) {
    const Image& from = pictures[std::min(first + c, pictures.size() - 1)];
    for (size_t i = 0; i < all.values.size(); i += 3) all.values[i + c] = from.values[i];
  }
  return all;
}

Image grey_of_channel(const Image& all, size_t channel) {
  Image grey = all;
  for (size_t i = 0; i < all.values.size(); i += 3)
    std::fill_n(grey.values.begin() + int64_t(i), 3, all.values[i + channel]);
  return grey;
}

constexpr double of_tracing = 0.9;  // of a picture's time, about

// PSNR of the amplitude of a picture against another [dB].
double amplitude_psnr(const Image& picture, const Image& truth) {
  double squares = 0, peak = 0;
  for (size_t i = 0; i < truth.values.size(); ++i) {
    const double amplitude = std::sqrt(double(truth.values[i])),
                 error = std::sqrt(double(picture.values[i])) - amplitude;
    squares += error * error;
    peak = std::max(peak, amplitude);
  }
  return 10 * std::log10(peak * peak * double(truth.values.size()) / squares);
}

}  // namespace

Image make_picture(const Job& job, const RenderParams& params, PictureUse use, const Observer& observer) {
  if (!is_to_denoise(params.denoise, use) || !can_denoise(job.scene, params.denoise, observer))
    return make_render(job, params, observer);
  const Image noisy = make_render(job, params, between(observer, 0, of_tracing));
  observer.fact("denoised", 1);
  return denoise(noisy, {}, DenoiseQuality::high, between(observer, of_tracing, 1));
}

FocalStack make_focal_stack(const Job& job, const std::vector<double>& distances, const RenderParams& params,
                            PictureUse use, const Observer& observer) {
  const bool is_denoised = is_to_denoise(params.denoise, use) && can_denoise(job.scene, params.denoise, observer);
  const double traced = is_denoised ? of_tracing : 1;
  FocalStack stack =
      trace_focal_stack(job.scene, job.slm.grid, view_wavelength(job.wavelengths, job.trace.has_common_cone), distances,
                        params, between(observer, 0, traced));
  if (!is_denoised) return stack;
  const double each = (1 - traced) / double(stack.pictures.size());
  for (size_t k = 0; k < stack.pictures.size(); ++k)
    stack.pictures[k] = denoise(stack.pictures[k], {}, DenoiseQuality::high,
                                between(observer, traced + each * double(k), traced + each * double(k + 1)));
  observer.fact("denoised", stack.pictures.size());
  return stack;
}

void denoise_targets(const Job& job, std::vector<Image>& planes, std::vector<Image>& cells, const Observer& observer) {
  const Denoise choice = job.encode.denoise;
  if (choice == Denoise::none || planes.empty() || !can_denoise(job.scene, choice, observer)) return;
  Observer at_end = observer;  // tracing has reported its own progress; a caller may want to stop
  at_end.on_progress = [&](double) { observer.progress(1); };
  size_t done = 0;
  // Grey planes show the same things at the same places, so three are denoised as one picture's colours: in a third of the time,
  // for a few decibels of 50.
  const bool are_grey = std::all_of(planes.begin(), planes.end(), is_grey);
  for (const auto& [pictures, kind, together] :
       {std::tuple(&planes, "plane", size_t(are_grey ? 3 : 1)), std::tuple(&cells, "view", size_t(1))})
    for (size_t k = 0; k < pictures->size(); k += together) {
      observer.status(fmt::format("denoising {} {} of {}", kind, k + 1, pictures->size()));
      Image noisy = together == 1 ? std::move((*pictures)[k]) : as_channels(*pictures, k);
      Image denoised = denoise(noisy, {}, DenoiseQuality::fast, at_end);
      const double psnr = k == 0 ? amplitude_psnr(noisy, denoised) : 0;
      const bool is_clean = choice == Denoise::automatic && psnr > clean_enough;
      if (together == 1) (*pictures)[k] = std::move(is_clean ? noisy : denoised);
      if (is_clean) {
        observer.fact("why_not_denoised", fmt::format("the light paths alone have a PSNR of {:.1f} dB", psnr));
        break;
      }
      for (size_t c = 0; together > 1 && c < together && k + c < pictures->size(); ++c)
        (*pictures)[k + c] = grey_of_channel(denoised, c);
      done += std::min(together, pictures->size() - k);
    }
  observer.status("");
  observer.fact("denoised", done);
}

}  // namespace holotrace
