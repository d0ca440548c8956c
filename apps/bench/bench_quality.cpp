// Steps of holotrace bench that measure the quality of each encoder, in full HD: a natural-looking picture of 1600 ×
// 880 in a plane 0.1 m away, seen through the virtual SLM. The light is integrated over the picture's pixels, or taken
// at their centres only.

#include <fmt/format.h>

#include "bench/bench.h"
#include "holotrace/base/units.h"
#include "holotrace/data/params/encode.h"
#include "holotrace/estimate/machine/timing.h"
#include "holotrace/estimate/picture_quality.h"
#include "holotrace/io/scene/slm_file.h"
#include "holotrace/slm/encode/encode.h"
#include "holotrace/slm/encode/target.h"

namespace holotrace {
namespace {

using namespace literals;

// A panel, the effects that the encoder compensates, and the light that is measured.
struct QualityJob {
  const char* name;
  Encoding method;
  StartPhase start = StartPhase::field;
  Modulation modulation = Modulation::phase;
  const char* panel = "";  // "": ideal, 8 bit
  std::vector<std::string> known = {}, effects = {};
  double distance = 0.1;  // [m]
};

BenchRow bench_quality(const QualityJob& job) {
  Slm slm{.name = "ideal", .grid = timed_full_hd, .modulation = job.modulation};
  if (*job.panel) slm = slm_preset(job.panel);
  EncodeParams params{
      .method = job.method, .target_distances = {job.distance}, .target_columns = 1600, .target_rows = 880};
  params.start = job.start;
  params.effects = job.known;
  const std::vector<TargetPlane> targets = targets_of_picture(natural_picture(1600, 880), slm.grid, 520_nm, params);
  const Field field = field_of_target(targets[0], slm, params);
  Hologram hologram;
  BenchRow row{.stage = job.name, .runs = 1};
  row.seconds = median_seconds(1, [&] {
    hologram = traits_of(job.method).aims_at_targets ? encode_targets(targets, field, slm, params)
                                                     : encode(field, slm, params);
  });
  const EncoderQuality quality = encoder_quality(targets[0], hologram, slm, {.effects = job.effects});
  const EncoderQuality at_points =
      encoder_quality(targets[0], hologram, slm, {.effects = job.effects}, PixelSampling::point);
  row.job = slm.name;
  row.result = fmt::format("{:.1f} dB ({:.1f} dB at the pixel centres), {:.3g} % of the light", quality.psnr,
                           at_points.psnr, 100 * quality.efficiency);
  row.unit = "pixels";
  row.rate = double(slm.grid.pixels()) / row.seconds;
  row.facts = {{"psnr_db", quality.psnr}, {"psnr_at_points_db", at_points.psnr}, {"efficiency", quality.efficiency}};
  return row;
}

}  // namespace

std::vector<BenchStep> quality_steps(const BenchOptions& options) {
  const StartPhase random = StartPhase::random, smooth = StartPhase::field;
  const Modulation phase = Modulation::phase;
  std::vector<QualityJob> jobs{{"phase", Encoding::phase},
                               {"phase, random", Encoding::phase, random},
                               {"complex", Encoding::complex, smooth, Modulation::complex},
                               {"complex, 0.2 m", Encoding::complex, smooth, Modulation::complex, "", {}, {}, 0.2},
                               {"double-phase", Encoding::double_phase},
                               {"error-diffusion", Encoding::error_diffusion},
                               {"off-axis, no bias", Encoding::off_axis, smooth, Modulation::amplitude},
                               {"binary, random", Encoding::binary, random}};
  if (!options.is_quick)
    for (const QualityJob& job :
         {QualityJob{"GS, random", Encoding::gerchberg_saxton, random}, QualityJob{"GS", Encoding::gerchberg_saxton},
          QualityJob{"weighted GS, random", Encoding::weighted_gerchberg_saxton, random},
          QualityJob{"weighted GS", Encoding::weighted_gerchberg_saxton},
          QualityJob{"sgd, random", Encoding::sgd, random}, QualityJob{"sgd", Encoding::sgd},
          QualityJob{"sgd, 0.2 m", Encoding::sgd, smooth, phase, "", {}, {}, 0.2},
          QualityJob{"sgd, panel unknown", Encoding::sgd, smooth, phase, "pluto", {}, {"all"}},
          QualityJob{"sgd, panel known", Encoding::sgd, smooth, phase, "pluto", {"all"}, {"all"}}})
      jobs.push_back(job);
  std::vector<BenchStep> steps;
  steps.reserve(jobs.size());
  for (const QualityJob& job : jobs) steps.push_back({job.name, [=] { return bench_quality(job); }});
  return steps;
}

}  // namespace holotrace
