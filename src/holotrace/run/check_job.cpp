#include <algorithm>
#include <cmath>

#include "holotrace/base/error.h"
#include "holotrace/base/machine.h"
#include "holotrace/base/units.h"
#include "holotrace/data/acceptance.h"
#include "holotrace/data/params/parameter.h"
#include "holotrace/run/eye_views.h"
#include "holotrace/run/illumination_plan.h"
#include "holotrace/run/pipeline.h"
#include "holotrace/run/scene_targets.h"
#include "holotrace/run/viewing.h"
#include "holotrace/slm/encode/blank_hologram.h"
#include "holotrace/trace/gather.h"
#include "holotrace/trace/shade_triangles.h"

namespace holotrace {
namespace {

// Number of sets that is known before tracing; sets of separate lights are counted later.
size_t least_sets(const Job& job) {
  return job.wavelengths.size() * (job.trace.separate_polarizations ? 2 : 1) *
         (job.trace.separate_path_groups ? std::max<size_t>(1, job.trace.path_expressions.size()) : 1);
}

IlluminationPlan plan_at(const Job& job, double wavelength, const std::vector<Viewpoint>& from) {
  const auto stop = stop_of(job.encode, job.slm.grid, wavelength);
  const double lit_with = job.show.wavelength > 0 ? job.show.wavelength : wavelength;
  return plan_illumination(job.slm, job.show, lit_with, job.encode.image, from, stop);
}

}  // namespace

int64_t states_at(const Job& job, double wavelength, const std::vector<Viewpoint>& from) {
  return int64_t(plan_at(job, wavelength, from).states.size());
}

int64_t most_states(const Job& job, const std::vector<Viewpoint>& from) {
  int64_t most = 1;
  for (const double wavelength : job.wavelengths) most = std::max(most, states_at(job, wavelength, from));
  return most;
}

int64_t most_instants(const Job& job, const std::vector<Viewpoint>& from) {
  int64_t most = 1;
  for (const double wavelength : job.wavelengths)
    most = std::max(most, int64_t(plan_at(job, wavelength, from).instants));
  return most;
}

// Counts the fields of two frames, all holograms, the light that leaves the
// panel with its transform, the propagation to the sensor, padded to the sum of both windows, and the sums of views.
void check_memory(const Job& job, size_t sets) {
  const Grid& panel = job.slm.grid;
  const double pixels = double(panel.pixels()), frames = job.trace.frames;
  const std::vector<Viewpoint> from = viewpoints_of(job);
  const ViewingNeed need = viewing_need({job.slm, job.show, job.propagate, from}, job.wavelengths, job.encode.image,
                                        stop_of(job.encode, panel, job.wavelengths.front()),
                                        widest_part(plan_at(job, job.wavelengths.front(), from)));
  const double kept = job.trace.strategy == Strategy::gather ? 1 + frames : frames > 1 ? 2 : 1;
  const double fields = 8 * pixels * double(sets) * kept;
  const double planes = job.encode.method == Encoding::complex ? 2 : 1;  // planes of levels
  const double holograms = 2 * planes * pixels * double(sets) * frames;
  const int64_t states = most_states(job, from);
  const bool is_one = sets == 1 && frames == 1 && states == 1 && from.size() == job.camera.distances.size();
  const double views = is_one ? 0 : viewing_bytes(need.columns * need.rows, from.size(), double(sets), states);
  require_memory(fields + holograms + need.shown + need.passing + views,
                 fmt::format("a run of {} hologram(s) on {} × {} pixels at {} samples per pixel and axis, seen by a "
                             "sensor of {} × {} pixels,",
                             double(sets) * frames, panel.nx, panel.ny, job.show.subpixels, std::llround(need.columns),
                             std::llround(need.rows)));
}

namespace {

// The panel sends light to an eye from its nearest edge at the angle that it accepts, and the eye's pupil must resolve the panel.
void check_eyes(const Job& job) {
  const Grid& panel = job.slm.grid;
  const Eyebox box = eyebox_of(job.encode);
  const double wavelength = view_wavelength(job.wavelengths, job.trace.has_common_cone), pupil = pupil_of(job.encode);
  for (const Vec3& eye : eyes_of(job.encode)) {
    const double blur = 1.22 * wavelength * eye.z / pupil, side = std::min(panel.width(), panel.height());
    require(
        blur <= side / 4,
        "expected an eye that sees detail on the panel, got one at {}, where the diffraction of its pupil of {} blurs the panel by "
        "{} of its {}; move the eye nearer, such as to 250 mm",
        format_length(eye.z), format_length(pupil), format_length(blur), format_length(side));
    const double reach = box_radius(eye.z, wavelength, panel.pitch);
    const double across = panel.width() / 2 + reach, down = panel.height() / 2 + reach;
    require(
        std::abs(eye.x) <= across && std::abs(eye.y) <= down,
        "expected an eye that light of the panel reaches, at most {} beside its axis and {} above it at {}, got {} and "
        "{}; move the eye, or use a panel with smaller pixels",
        format_length(across), format_length(down), format_length(eye.z), format_length(eye.x), format_length(eye.y));
    require(
        std::abs(eye.x) + box.width / 2 <= across && std::abs(eye.y) + box.height / 2 <= down,
        "expected an eyebox that light of the panel reaches, within {} x {} at {}, got one that ends {} beside the axis "
        "and {} above it; give a smaller [encode] eyebox",
        format_length(2 * across), format_length(2 * down), format_length(eye.z),
        format_length(std::abs(eye.x) + box.width / 2), format_length(std::abs(eye.y) + box.height / 2));
  }
}

}  // namespace

void check_job(const Job& job) {
  require(!job.wavelengths.empty(), "expected at least one wavelength, got none");
  check_ranges(job.trace);
  check_ranges(job.render);
  check_ranges(job.synthesize);
  check_ranges(job.encode);
  check_ranges(job.show);
  check_ranges(job.propagate);
  check_ranges(job.camera);
  require(
      !job.trace.separate_polarizations || !aims_at_scene(job),
      "expected separate_polarizations only with holograms of waves, got holograms that are optimised for the scene's "
      "light; leave it out, or take another method than sgd");
  for (const double wavelength : job.wavelengths) check_wavelength(wavelength, job.slm.grid);
  for (size_t i = 0; i < job.wavelengths.size(); ++i)
    require(std::count(job.wavelengths.begin(), job.wavelengths.end(), job.wavelengths[i]) == 1,
            "expected wavelengths that differ, got {} twice; leave one out, or ask for frames",
            format_length(job.wavelengths[i]));
  const bool is_coloured = job.wavelengths.size() > 1;
  require(!is_coloured || job.show.wavelength == 0,
          "expected [show] wavelength with a scene of one wavelength, got {} of {}; leave it out: each hologram is lit "
          "with its own",
          format_length(job.show.wavelength), job.wavelengths.size());
  require(
      !is_coloured || !job.encode.is_joint || aims_at_scene(job),
      "expected [encode] joint of a scene with method = \"sgd\" and target = \"render\" or \"light-field\", got another "
      "method or target; give these, or leave joint out: each of the {} wavelengths then has its own hologram",
      job.wavelengths.size());
  require(job.encode.method == Encoding::sgd ||
              (job.encode.target != EncodeTarget::render && job.encode.target != EncodeTarget::light_field),
          "expected the encoding method sgd for the targets render and light-field, got another one; give method = "
          "\"sgd\", or leave target out");
  if (job.encode.target == EncodeTarget::light_field || aims_at_eyes(job)) {
    const char* target = aims_at_eyes(job) ? "eyes" : "the target light-field";
    require(job.encode.image == ImageSide::virtual_image,
            "expected a virtual image for {}, got a real one; give image = \"virtual\"", target);
    require(
        job.encode.subpixels == 1,
        "expected one sample per pixel for {}, got {} per axis; leave out [encode] subpixels, or give the target render "
        "without eyes",
        target, job.encode.subpixels);
  }
  EncodeParams encoding = job.encode;
  encoding.method = method_or(job.encode.method, Encoding::phase);
  check_encoding(job.slm, encoding, {});
  eyebox_of(job.encode);  // also where waves or other targets leave eyes unused
  eyes_of(job.encode);
  if (aims_at_eyes(job)) check_eyes(job);
  if (job.synthesize.method == SynthesisMethod::triangles)
    check_shading(job.scene, job.trace);
  else if (job.trace.strategy == Strategy::gather)
    check_gather(job.trace);
  check_memory(job, least_sets(job));
}

}  // namespace holotrace
