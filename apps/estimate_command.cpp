// holotrace estimate: the predicted cost of a scene, from short probes of it.

#include <fmt/format.h>

#include <cmath>
#include <memory>

#include "commands.h"
#include "flags.h"
#include "holotrace/base/error.h"
#include "holotrace/base/machine.h"
#include "holotrace/run/choose.h"
#include "holotrace/run/estimate/film_estimate.h"
#include "holotrace/run/estimate/job_estimate.h"
#include "run_flags.h"

namespace holotrace {
namespace {

void print_text(const CostAnswer& a) {
  const JobEstimate& e = a.estimate;
  const auto line = [](const std::string& name, const std::string& value, const std::string& meaning) {
    fmt::print("  {:<28} {:>14}  {}\n", name, value, meaning);
  };
  const auto count = [](double value) { return fmt::format("{:.4g}", value); };
  const auto seconds = [](double value) { return fmt::format("{:.3g} s", value); };
  fmt::print("The job\n");
  line("holograms", count(e.holograms()),
       fmt::format("{:g} sets (colours, path groups, lights) x {:g} frames", e.sets, e.frames));
  if (e.paths > 0) {
    line("light paths", count(e.paths), "N of Eq. 16");
    line("mean path length", count(e.mean_path_length), "l_avg: surfaces on a path, measured (Eq. 21)");
    line("continuation probability", count(1 - 1 / std::max(e.mean_path_length, 1.0)), "rho = 1 - 1 / l_avg (Eq. 20)");
    line("rays", count(e.rays), "rays that find the nearest surface");
    line("shadow rays", count(e.shadow_rays), "to lights");
    line("waves", count(e.waves), fmt::format("summed by the method {}", e.method.empty() ? "of the job" : e.method));
    line("waves x pixels", count(e.waves_pixels), "of one frame");
    fmt::print("\nOne ray (T_t), {:g} triangles\n", e.triangles);
    line(e.accelerator, fmt::format("{:.3g} us", 1e6 * e.seconds_per_ray), "all threads at work, shading included");
    if (e.other_seconds_per_ray > 0) {
      line(e.other_accelerator, fmt::format("{:.3g} us", 1e6 * e.other_seconds_per_ray), "the same rays");
      line("grid, predicted", fmt::format("{:.3g} us", 1e6 * e.grid_seconds_per_ray),
           fmt::format("the ray alone, one thread: {:.3g} cells, {:.3g} tests", e.grid_cells_per_ray,
                       e.grid_tests_per_ray));
    }
    if (!e.why_no_other.empty()) line(e.other_accelerator, "not measured", e.why_no_other);
    line("scene preparation", seconds(e.prepare_seconds), "before the first ray");
  }
  fmt::print("\nA run on this machine, seconds of its stages\n");
  for (const StageEstimate& stage : e.stages) line(stage.stage, seconds(stage.seconds), "");
  if (e.is_whole())
    line("all", seconds(e.seconds()), "without reading and saving files");
  else
    line("all", "unknown", fmt::format("the other stages could not be probed: {}", e.why_no_simulation));
  line("this estimate", seconds(e.probe_seconds), "");
  if (e.paths > 0) {
    fmt::print("\nThe paper's count\n");
    line("Eq. 23, these paths", seconds(a.ours.trace_seconds), "N (1 + l_avg) T_t: one shadow ray per path");
    line(fmt::format("Eq. 23, {:g} per pixel", a.samples), seconds(a.per_pixel.trace_seconds),
         fmt::format("N = P S = {:.3g}: every pixel its own paths (strategy gather)", a.per_pixel.paths));
  }
  fmt::print("\nIn real time at {:g} frames per second: trace, sum and encode each frame anew\n",
             a.real.frames_per_second);
  line("seconds per frame", seconds(a.real.seconds_per_frame),
       e.is_whole() ? "on this machine" : "on this machine, without encoding");
  line("number of such machines", fmt::format("{:.3g}", a.real.times), "if work scales perfectly");
  line("number of such cores", fmt::format("{:.3g}", a.real.cores), "");
  line("multiply-adds", fmt::format("{:.3g}/s", a.real.multiply_adds_per_second),
       "at the peak of this machine, in single precision");
}

void print_film(const FilmEstimate& film, double refresh, double cores_here) {
  const auto line = [](const std::string& name, const std::string& value, const std::string& meaning) {
    fmt::print("  {:<28} {:>14}  {}\n", name, value, meaning);
  };
  const auto count = [](double value) { return fmt::format("{:.4g}", value); };
  const auto seconds = [](double value) { return fmt::format("{:.3g} s", value); };
  const FilmCounts& counts = film.counts;
  fmt::print("\nThe film, {:g} times at {:g} per second\n", counts.times, film.fps);
  line("computed afresh", count(counts.afresh), "times");
  if (counts.continued > 0)
    line("continued", count(counts.continued), "times whose iterations go on from the last ones");
  line("holograms reused", count(counts.reused), "times at which only the camera sees something else");
  line("equal", count(counts.equal), "times at which nothing has changed");
  line("holograms", count(film.holograms()),
       fmt::format("{:g} at each time, of {:g} bit(s)", film.holograms_per_time, film.bits));
  line("first time", seconds(film.first_seconds), "on this machine");
  line("all times", seconds(film.seconds), "on this machine, with what is reused");
  line("on disk", format_bytes(film.bytes_on_disk), "before compression, without the films");
  fmt::print("\nThe display\n");
  std::string of_panel = "give --refresh to compare it with the panel's";
  if (refresh > 0)
    of_panel = refresh >= film.holograms_per_second()
                   ? fmt::format("the panel shows {:g}", refresh)
                   : fmt::format("too many: the panel shows {:g}, enough for {:.3g} times per second", refresh,
                                 refresh / film.holograms_per_time);
  line("holograms", count(film.holograms_per_second()) + "/s", of_panel);
  line("bit planes", count(film.bit_planes_per_second()) + "/s", "");
  line("data", format_bytes(film.bytes_per_second()) + "/s", "to the panel");
  fmt::print("\nThe film in real time\n");
  line("Eq. 17, each time afresh", fmt::format("{:.3g} rays/s", film.rays_per_second), "F N (1 + l_avg)");
  line("Eq. 17, with reuse", fmt::format("{:.3g} rays/s", film.new_rays_per_second),
       "only the times that are traced again");
  line("waves x pixels", fmt::format("{:.3g}/s", film.waves_pixels_per_second),
       "only the times whose waves are summed again");
  line("seconds per time", seconds(film.real.seconds_per_frame), "trace, sum and encode what has changed");
  line("number of such machines", fmt::format("{:.3g}", film.real.times),
       fmt::format("of {:g} threads, if work scales perfectly", cores_here));
  line("multiply-adds", fmt::format("{:.3g}/s", film.real.multiply_adds_per_second),
       "at the peak of this machine, in single precision");
}

}  // namespace

void add_estimate_command(CLI::App& app, const GlobalFlags& global) {
  CLI::App* command = app.add_subcommand(
      "estimate",
      "predicted time of a run, stage by stage, and what real-time display would need; measured by short "
      "probes");
  struct Options {
    std::string scene;
    RunFlags flags;
    double frames_per_second = 30, refresh = 0;
    Flags film{{{"start", "film_start"}}};
    bool is_json = false, has_accelerators = false;
  };
  auto o = std::make_shared<Options>();
  add_scene(*command, o->scene);
  o->flags.add(*command, true);
  CLI::Option* fps = command
                         ->add_option("--fps", o->frames_per_second,
                                      "frame rate of the real-time estimate and of the film, in frames per second "
                                      "[30; a film: that of the scene's [animate]]")
                         ->type_name("NUMBER");
  command
      ->add_option("--refresh", o->refresh,
                   "holograms per second that the panel shows, to compare a film with it; 0: not known [0]")
      ->type_name("NUMBER");
  o->film.add(*command, AnimateParams(), {"fps", "format"},
              "Film (overrides the scene's [animate]; scenes that change over time, or with seconds or times)");
  command->add_flag(
      "--accelerators", o->has_accelerators,
      "also compare the time per ray of Embree and of the uniform grid (the paper's appendix); takes some "
      "seconds more");
  command->add_flag("--json", o->is_json, "as JSON");
  shorten_help(*command, {"holotrace estimate scene.toml", "holotrace estimate model.glb --quality good"},
               {"--slm", "--wavelength", "--quality", "--method", "--frames", "--iterations", "--paths", "--eye",
                "--fps", "--seconds", "--refresh", "--accelerators", "--json", "--help", "--help-all"});
  command->callback([o, fps, &global] {
    check_flag("--refresh", o->refresh, range::not_negative, Quantity::number);
    check_flag("--fps", o->frames_per_second, range::above_to(0, 1e6), Quantity::number);
    const auto job_at = [&](std::optional<double> time) {
      return choose_missing(o->flags.job(o->scene, global.outside(), time));
    };
    Job job = o->flags.job(o->scene, global.outside());
    say_warnings(job.warnings);
    o->film.apply(job.animate);
    if (fps->count() > 0) job.animate.fps = o->frames_per_second;
    const bool has_film = last_change(job) || o->film.has("seconds") || o->film.has("times");
    std::optional<FilmCounts> counts;
    if (has_film) {
      const std::vector<double> times = times_of(job.animate, last_change(job));
      counts = count_film_times(times, job_at, job.animate.from_last);
    }
    const CostAnswer a = answer_about_cost(job, o->frames_per_second, o->has_accelerators);
    std::optional<FilmEstimate> film;
    if (counts) film = estimate_film(a, choose_missing(job), *counts, job.animate.fps);
    if (o->is_json) {
      auto json = cost_json(a);
      if (film) json["film"] = film_json(*film);
      fmt::print("{}\n", json.dump(2));
      return;
    }
    print_text(a);
    if (film) print_film(*film, o->refresh, thread_count());
  });
}

}  // namespace holotrace
