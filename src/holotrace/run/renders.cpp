#include "holotrace/run/renders.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <tuple>
#include <utility>
#include <vector>

#include "holotrace/base/units.h"
#include "holotrace/data/acceptance.h"
#include "holotrace/denoise/denoise.h"
#include "holotrace/run/scene_targets.h"
#include "holotrace/trace/focal_stack.h"
#include "holotrace/trace/render.h"
#include "holotrace/view/camera.h"
#include "holotrace/view/pupil_picture.h"
#include "holotrace/view/stereo.h"

namespace holotrace {
namespace {

float brightest_channel(const Image& image, size_t pixel) {
  return *std::max_element(&image.values[3 * pixel], &image.values[3 * pixel] + 3);
}

// Marks the `count` brightest of the pixels that `is_wanted` accepts, or all of them.
template <class IsWanted>
PixelMask brightest_pixels(const Image& image, size_t count, const IsWanted& is_wanted) {
  std::vector<std::pair<float, size_t>> wanted;
  for (size_t pixel = 0; pixel < image.values.size() / 3; ++pixel)
    if (is_wanted(pixel)) wanted.emplace_back(brightest_channel(image, pixel), pixel);
  count = std::min(count, wanted.size());
  std::nth_element(wanted.begin(), wanted.begin() + std::ptrdiff_t(count), wanted.end(), std::greater<>());
  PixelMask mask(image.values.size() / 3, 0);
  for (size_t i = 0; i < count; ++i) mask[wanted[i].second] = 1;
  return mask;
}

// Whether a pixel or one of its neighbours is in the mask.
bool touches(const PixelMask& mask, const Image& image, size_t pixel) {
  const int row = int(pixel / size_t(image.nx)), column = int(pixel % size_t(image.nx));
  for (int j = std::max(0, row - 1); j <= std::min(image.ny - 1, row + 1); ++j)
    for (int i = std::max(0, column - 1); i <= std::min(image.nx - 1, column + 1); ++i)
      if (mask[size_t(j) * size_t(image.nx) + size_t(i)]) return true;
  return false;
}

// Gives the brightest pixels all paths of the job: those that seem brightest, then those that still do, and the neighbours
// of those that are nearly as bright as the maximum.
void render_brightest(const Job& job, const RenderParams& params, HalvedRender& halved, const Observer& observer) {
  halved.brightest = halved.mean;
  if (halved.mean.values == halved.first.values) return;
  constexpr float nearly_maximal = 0.9F;  // a view's pixel as bright as the maximum has such pixels under it
  Image& image = halved.brightest;
  const size_t count = std::max<size_t>(1, image.values.size() / 3 / pixels_per_brightest);
  const auto render_all_paths = [&](const PixelMask& mask, int step) {
    RenderParams full = params;
    full.paths = job.render.paths;
    Observer progress;
    progress.on_progress = part_of(observer, step, 2).on_progress;
    render_pixels(exposure_of(job), job.slm.grid, view_wavelength(job.wavelengths, job.trace.has_common_cone), full,
                  mask, image, progress);
  };
  PixelMask done = brightest_pixels(image, count, [](size_t) { return true; });
  render_all_paths(done, 0);
  float peak = 0;
  for (size_t pixel = 0; pixel < done.size(); ++pixel)
    if (done[pixel]) peak = std::max(peak, brightest_channel(image, pixel));
  PixelMask bright = done;
  for (size_t pixel = 0; pixel < done.size(); ++pixel)
    bright[pixel] = done[pixel] && brightest_channel(image, pixel) >= nearly_maximal * peak;
  render_all_paths(brightest_pixels(image, count,
                                    [&](size_t pixel) {
                                      return !done[pixel] &&
                                             (brightest_channel(image, pixel) > peak || touches(bright, image, pixel));
                                    }),
                   1);
}

// The picture has the middle of the views at a distance.
void follow_window(const Job& job, double distance, RenderParams& params) {
  const Vec2 middle = middle_of_renders(job, distance);
  params.azimuth = std::atan(middle.x);
  params.elevation = std::atan(middle.y);
}

PlannedRender of_waves(const Job& job, const std::string& stage, const RenderParams& params) {
  return {stage, light_of_waves(job, params)};
}

}  // namespace

Vec2 middle_of_renders(const Job& job, double distance) {
  if (job.camera.window == ViewWindow::eye || aims_at_scene(job))
    return middle_of_window(job.camera, distance, job.encode.image);
  return {std::tan(job.render.azimuth), std::tan(job.render.elevation)};
}

RenderParams light_of_waves(const Job& job, RenderParams params) {
  params.has_background = job.trace.has_background;
  if (job.wavelengths.size() == 1) params.glass_wavelength = job.wavelengths.front();
  if (params.path_expressions.empty()) params.path_expressions = job.trace.path_expressions;
  return params;
}

int quick_paths(int paths) { return 2 * (paths / 8 + (paths % 8 > 0)); }

bool is_quick(const Job& job) {
  return job.render.reference == Reference::quick && quick_paths(job.render.paths) < job.render.paths;
}

std::vector<PlannedRender> plan_renders(const Job& job) {
  if (job.render.reference == Reference::none) return {};
  RenderParams params = job.render;
  if (is_quick(job)) params.paths = quick_paths(params.paths);
  if (job.render.lens == Lens::pinhole && job.render.eye == Vec3{}) {
    follow_window(job, job.camera.distances.front(), params);
    return {of_waves(job, "render", params)};
  }
  std::vector<PlannedRender> renders;
  const bool is_one = job.camera.distances.size() == 1;
  for (const double distance : job.camera.distances) {
    renders.push_back(of_waves(job, is_one ? "render" : "render focused at " + format_length(distance), params));
    renders.back().params.focus = distance;
    follow_window(job, distance, renders.back().params);
  }
  return renders;
}

std::vector<PlannedRender> plan_stereo_renders(const Job& job) {
  if (job.render.eye_separation == 0) return {};
  std::vector<PlannedRender> renders;
  for (const RenderParams& params : stereo_pair(job.render)) {
    renders.push_back(of_waves(job, renders.empty() ? "render for the left eye" : "render for the right eye", params));
    renders.back().params.focus = job.camera.distances.front();
  }
  return renders;
}

Image make_render(const Job& job, const RenderParams& params, const Observer& observer) {
  observer.fact("seed", params.seed);
  if (!job.moments.empty()) observer.fact("shutter_moments", job.moments.size());
  return render(exposure_of(job), job.slm.grid, view_wavelength(job.wavelengths, job.trace.has_common_cone), params,
                observer);
}

std::array<Image, 4> make_stokes(const Job& job, const RenderParams& params, const Observer& observer) {
  require(params.clamp == 0, "expected no clamp for the Stokes parameters, got {}; leave out clamp", params.clamp);
  require(params.denoise != Denoise::all, "expected no denoising of the Stokes parameters, got all; leave out denoise");
  std::array<Image, 4> parameters;
  Job one = job;
  for (size_t k = 0; k < 4; ++k) {
    StokesVector row{};
    row[k] = 1;
    one.scene.analyser = row;
    for (Moment& moment : one.moments) {
      const auto scene = std::make_shared<Scene>(*moment.scene);
      scene->analyser = row;
      moment.scene = scene;
    }
    Observer part;
    if (k == 0) part = observer;  // its facts and warnings are those of all
    part.on_progress = part_of(observer, int(k), 4).on_progress;
    parameters[k] = make_render(one, params, part);
  }
  return parameters;
}

HalvedRender make_halved_render(const Job& job, const RenderParams& params, const Observer& observer) {
  RenderParams half = params;
  half.paths = params.paths / 2;
  const Observer before = part_of(observer, 0, 3), after = part_of(observer, 1, 3);
  HalvedRender halved{{}, make_render(job, half, before), {}};
  half.seed += 1;
  Observer progress;  // the facts are those of the first half
  progress.on_progress = after.on_progress;
  halved.mean = make_render(job, half, progress);
  for (size_t i = 0; i < halved.mean.values.size(); ++i)
    halved.mean.values[i] = (halved.mean.values[i] + halved.first.values[i]) / 2;
  observer.fact("paths_per_pixel", params.paths);
  render_brightest(job, params, halved, part_of(observer, 2, 3));
  return halved;
}

namespace {

// The pictures of all distances with one half of the paths.
std::vector<Image> trace_half(const Job& job, RenderParams params, const Observer& observer) {
  const Grid& panel = job.slm.grid;
  const double wavelength = view_wavelength(job.wavelengths, job.trace.has_common_cone);
  const std::vector<double>& distances = job.camera.distances;
  if (job.camera.pupil == 0)
    return trace_focal_stack(exposure_of(job), panel, wavelength, distances, params, observer).pictures;
  params.lens = Lens::round;
  params.eye = job.camera.eye;
  params.pupil = job.camera.pupil;
  params.columns = panel.nx;
  params.rows = panel.ny;
  std::vector<Image> pictures;
  for (size_t d = 0; d < distances.size(); ++d) {
    params.focus = distances[d];
    follow_window(job, distances[d], params);
    params.field_of_view = std::atan(panel.height() / 2 / std::abs(distances[d]));
    pictures.push_back(
        render(exposure_of(job), panel, wavelength, params, part_of(observer, int(d), int(distances.size()))));
    limit_to_pupil(pictures.back(), panel.pitch, wavelength, distances[d] + params.eye.z, params.pupil);
  }
  return pictures;
}

}  // namespace

std::vector<HalvedRender> trace_scene_references(const Job& job, const Observer& observer) {
  if (job.render.reference == Reference::none) return {};
  RenderParams params = light_of_waves(job, job.render);
  params.paths =
      std::max(2, (is_quick(job) ? quick_paths(paths_per_pixel(job.render)) : paths_per_pixel(job.render)) / 2);
  std::vector<HalvedRender> references;
  Observer progress;  // facts are those of the targets
  for (int half = 0; half < 2; ++half) {
    params.seed = job.render.seed + 1 + half;  // that of the targets is job.render.seed
    progress.on_progress = part_of(observer, half, 2).on_progress;
    std::vector<Image> pictures = trace_half(job, params, progress);
    references.resize(pictures.size());
    for (size_t d = 0; d < pictures.size(); ++d) {
      HalvedRender& reference = references[d];
      if (half == 0) {
        reference.first = std::move(pictures[d]);
        continue;
      }
      reference.mean = std::move(pictures[d]);
      for (size_t i = 0; i < reference.mean.values.size(); ++i)
        reference.mean.values[i] = (reference.mean.values[i] + reference.first.values[i]) / 2;
    }
  }
  observer.fact("paths_per_pixel", 2 * params.paths);
  return references;
}

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
  const Image noisy = make_render(job, params, part_between(observer, 0, of_tracing));
  observer.fact("denoised", 1);
  return denoise(noisy, {}, DenoiseQuality::high, part_between(observer, of_tracing, 1));
}

FocalStack make_focal_stack(const Job& job, const std::vector<double>& distances, const RenderParams& params,
                            PictureUse use, const Observer& observer) {
  const bool is_denoised = is_to_denoise(params.denoise, use) && can_denoise(job.scene, params.denoise, observer);
  const double traced = is_denoised ? of_tracing : 1;
  FocalStack stack =
      trace_focal_stack(exposure_of(job), job.slm.grid, view_wavelength(job.wavelengths, job.trace.has_common_cone),
                        distances, params, part_between(observer, 0, traced));
  if (!is_denoised) return stack;
  const double each = (1 - traced) / double(stack.pictures.size());
  for (size_t k = 0; k < stack.pictures.size(); ++k)
    stack.pictures[k] = denoise(stack.pictures[k], {}, DenoiseQuality::high,
                                part_between(observer, traced + each * double(k), traced + each * double(k + 1)));
  observer.fact("denoised", stack.pictures.size());
  return stack;
}

bool can_denoise_targets(const Job& job) {
  if (job.encode.denoise == Denoise::none || !job.scene.points.empty()) return false;
  try {
    find_denoiser();
    return true;
  } catch (const NoDenoiser&) {
    return false;
  }
}

void denoise_targets(const Job& job, std::vector<Image>& planes, std::vector<Image>& cells, const Observer& observer) {
  const Denoise choice = job.encode.denoise;
  if (choice == Denoise::none || !can_denoise(job.scene, choice, observer)) return;
  const double all = double(planes.size() + cells.size());
  size_t begun = 0, done = 0;
  for (const auto& [pictures, kind] : {std::pair(&planes, "plane"), std::pair(&cells, "view")}) {
    // Grey planes, and neighbouring views, show the same things at about the same places, so three are denoised as one picture's
    // colours: in a third of the time, for a few decibels of 50.
    const size_t together = std::all_of(pictures->begin(), pictures->end(), is_grey) ? 3 : 1;
    for (size_t k = 0; k < pictures->size(); k += together) {
      observer.status(fmt::format("denoising {} {} of {}", kind, k + 1, pictures->size()));
      Image noisy = together == 1 ? std::move((*pictures)[k]) : as_channels(*pictures, k);
      const size_t of_these = std::min(together, pictures->size() - k);
      Image denoised = denoise(noisy, {}, DenoiseQuality::fast,
                               part_between(observer, double(begun) / all, double(begun + of_these) / all));
      begun += of_these;
      const double psnr = k == 0 ? amplitude_psnr(noisy, denoised) : 0;
      const bool is_clean = choice == Denoise::automatic && psnr > clean_enough;
      if (together == 1) (*pictures)[k] = std::move(is_clean ? noisy : denoised);
      if (is_clean) {
        observer.fact("why_not_denoised", fmt::format("the light paths alone have a PSNR of {:.1f} dB", psnr));
        break;
      }
      for (size_t c = 0; together > 1 && c < of_these; ++c) (*pictures)[k + c] = grey_of_channel(denoised, c);
      done += of_these;
    }
  }
  observer.status("");
  observer.progress(1);
  observer.fact("denoised", done);
}

}  // namespace holotrace
