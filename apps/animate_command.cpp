// animate: a scene at several times → holograms and films.

#include <memory>
#include <string>

#include "checkpoints.h"
#include "commands.h"
#include "console.h"
#include "holotrace/base/units.h"
#include "holotrace/io/files/folders.h"
#include "holotrace/io/files/output.h"
#include "holotrace/io/picture/animation.h"
#include "holotrace/io/run/film.h"
#include "holotrace/io/scene/eye_track_file.h"
#include "holotrace/run/eye_views.h"
#include "holotrace/run/reuse.h"
#include "holotrace/run/scene_targets.h"
#include "rank_links.h"
#include "run_flags.h"

namespace holotrace {
namespace {

const char* said_of(FilmStep step) {
  switch (step) {
    case FilmStep::kept:
      return "kept from an earlier call";
    case FilmStep::same:
      return "equal to the time before";
    case FilmStep::computed:
      break;
  }
  return "computed";
}

// How long shutters of a film are open [s]: that of its camera, and that of each time, whose holograms show what happens while they
// are shown. Holograms of waves show one instant, so where the camera sees several of them, renders do, too.
struct FilmShutter {
  double of_camera, of_time;
};

FilmShutter shutter_of_film(const Job& first, const Shutter& shutter) {
  const double seconds = shutter.seconds_at(first.animate.fps), interval = 1 / first.animate.fps;
  constexpr double rounding = 1e-9;
  if (!first.animate.times.empty() || seconds <= interval * (1 + rounding)) return {0, seconds};
  return {seconds, aims_at_scene(first) ? interval : 0};
}

}  // namespace

void add_animate_command(CLI::App& app, const GlobalFlags& global) {
  CLI::App* command = app.add_subcommand(
      "animate", "film: the holograms of a scene at several times, and films of what is seen of them");
  struct Options {
    std::string scene, folder;
    RunFlags flags;
    Flags times{{{"format", "film_format"}, {"start", "film_start"}}};  // --start is that of [encode]
  };
  auto o = std::make_shared<Options>();
  add_scene(*command, o->scene);
  command
      ->add_option(
          "-o,--output", o->folder,
          "output folder: t_0001, t_0002, … with the holograms, the render and the view of each time; films of the "
          "views (view.webp; several distances: view_2.webp, …) and of the renders (render.webp); timing.csv, "
          "the order in which a display shows the holograms; and report.json. The same command resumes an "
          "interrupted one: finished times are kept. Ranks (mpirun) share the times, or with --from-last the frames of each time")
      ->required()
      ->type_name("DIR");
  o->times.add(*command, AnimateParams(), {}, "Times (overrides the scene's [animate])");
  o->flags.add(*command, false);
  shorten_help(*command,
               {"holotrace animate scene.toml -o film", "holotrace animate scene.toml -o film --seconds 2 --fps 25",
                "holotrace animate walk.glb -o film --film-format mp4",
                "holotrace animate bunny.obj -o film --turntable \"4 s\""},
               {"--output",     "--film-start", "--seconds",   "--fps",         "--times",       "--shutter",
                "--turntable",  "--from-last",  "--eye-track", "--eye-latency", "--film-format", "--slm",
                "--wavelength", "--quality",    "--method",    "--frames",      "--distance",    "--pupil",
                "--eye",        "--paths",      "--seed",      "--help",        "--help-all"});
  command->callback([o, &global] {
    Job first = o->flags.job(o->scene, global.outside(), std::nullopt, 0);
    o->times.apply(first.animate);
    FilmPlan plan{times_of(first.animate, last_change(first)),
                  first.animate.fps,
                  first.animate.format,
                  {},
                  0,
                  first.animate.from_last};
    const FilmShutter shutter = shutter_of_film(first, o->flags.shutter_of(first));
    plan.shutter = shutter.of_camera;
    plan.job_at = [&](double time) { return o->flags.job(o->scene, global.outside(), time, shutter.of_time); };
    require(
        first.camera.sweep == Sweep::none,
        "expected a film without a sweep, got one of each time; leave out sweep, or move the camera by keys over time");
    check_time_of_film(first, first, plan.from_last);
    if (plan.from_last) plan.walk = walk_through(measured_places(first, plan.times), first);
    if (first.tracked) plan.job_at(plan.times.back());  // a track that ends before is an error at once
    // Ranks share the times, or the frames of times that depend on each other.
    Ranks& ranks = *global.ranks;
    const size_t count = plan.times.size();
    const bool shares_times = ranks.size() > 1 && !plan.from_last;
    const TimeRange own =
        shares_times ? share_of_times(count, size_t(ranks.rank()), size_t(ranks.size())) : TimeRange{0, count};
    if (ranks.rank() > 0) {
      report_times(ranks, make_times(o->folder, plan, own));
      return;
    }
    if (plan.times.size() > 1 && !last_change(first) && !first.tracked)
      say_warnings({fmt::format(
          "nothing in {} changes with time, so all {} pictures are alike; give keys over time, an animated model, "
          "or an --eye-track",
          printable(o->scene), plan.times.size())});
    const std::vector<std::string> films = film_paths(o->folder, plan.format);
    if (has_animation_ending(films.front())) check_animation(films.front(), plan.fps);
    make_folder(o->folder);
    const FolderLock lock(o->folder);
    for (const std::string& path : films) note_output(path);
    Console console(global.is_quiet);
    console.keep_progress_in(o->folder);
    RankLinks links(ranks, global.threads);
    FilmWatch watch;
    watch.stages = [&](size_t i) {
      return
          [&, i](const std::string& stage) { return console.watch(fmt::format("{} of {}: {}", i + 1, count, stage)); };
    };
    watch.on_time = [&](size_t i, FilmStep step) {
      console.finish();
      if (!global.is_quiet) fmt::print("{} of {}, {}: {}\n", i + 1, count, format_time(plan.times[i]), said_of(step));
      std::fflush(stdout);
    };
    watch.before_naming = defer_interrupts;
    if (shares_times) start_times(ranks);
    std::vector<std::string> notes = make_times(o->folder, plan, own, watch, {}, shares_times ? nullptr : &links);
    if (shares_times)
      for (const std::string& note : wait_for_times(ranks)) notes.push_back(note);
    ranks.is_job_running = false;
    const SavedRun saved = finish_film(o->folder, plan, watch);
    console.finish();
    say_warnings(notes);
    say_warnings(saved.notes);
    if (global.is_quiet) return;
    if (own.end < count) fmt::print("{} to {} of {}: by other ranks\n", own.end + 1, count, count);
    fmt::print("film of {} times, {:g} s at {:g} per second, in {}:", count, double(count) / plan.fps, plan.fps,
               printable(o->folder));
    for (const auto& [name, bytes] : saved.files) fmt::print(" {}", name);
    fmt::print(" report.json\n");
  });
}

}  // namespace holotrace
