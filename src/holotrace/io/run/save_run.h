#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "holotrace/io/files/output_set.h"
#include "holotrace/io/run_folder.h"
#include "holotrace/run/pipeline.h"
#include "holotrace/run/view_holograms.h"

namespace holotrace {

/// Pictures of a series of holograms, and how the camera took them.
struct SeenViews {
  const std::vector<Viewpoint>& from;  ///< viewpoints of all pictures
  const ViewSeries& views;             ///< at the distances of the camera
  const ViewSeries& sweep;             ///< may be empty
  const ViewSeries& stereo;            ///< may be empty
  const CameraParams& camera;
};

/// Writes the views of all distances as view.png, view_2.png, …, and the sweep: view_sweep_01.png, …; view_sweep.gif (or
/// as CameraParams::sweep_format says), the animation of all its pictures; and view_sweep.png, its chart (viewing.h); and
/// the stereo pair (save_stereo). The first view records the other files.
/// If the name asks for the sweep alone (is_sweep_alone), only that is written. @throws Error for such a name without a
/// sweep
/// @param name      file name of the view, of image_endings or animation_endings
/// @param observer  is warned if the chart cannot be drawn, for instance because gnuplot is not installed
void save_views(const OutputSet& set, const std::string& name, const SeenViews& seen, const Observer& observer);

/// The same, in place of the files of an earlier call. @return a sentence for each file of a user that was set aside
std::vector<std::string> write_views(const std::string& path, const SeenViews& seen, const Observer& observer);

/// Checks, before the work, that views can be written, and notes the one that write_views gives its name last.
/// @throws Error for another ending; for the name of a sweep alone without a sweep; and as check_output, check_animation
///               and check_image do
void check_views_output(const std::string& path, const CameraParams& camera);

/// Whether the name of a view asks for the sweep alone: for its animation (view.gif), or its pictures (view_####.png).
bool is_sweep_alone(const std::string& view);

/// The files of a sweep of `pictures` pictures: its animation first, if it has one.
std::vector<std::string> sweep_paths(const std::string& view, size_t pictures, SweepFormat format);

/// Writes a stereo pair and its anaglyph: NAME_left, NAME_right and NAME_anaglyph, with the extension of `name`. If
/// `is_anaglyph_plain`, the anaglyph is `name` itself, and records the pair.
/// @param bits  bits per channel of a PNG
void save_stereo(const OutputSet& set, const std::string& name, const std::vector<Image>& pair, double white, int bits,
                 bool is_anaglyph_plain = false);

/// The paths of the files that a run writes into its folder, the first of each kind.
std::vector<std::string> run_paths(const std::string& folder);

/// The files of a run, and a sentence for each file of a user that was set aside.
struct SavedRun {
  FileRecord files;
  std::vector<std::string> notes;
};

/// Writes all that a run computed into its folder, where it replaces what an earlier run left (write_together). If the
/// program is killed while the files get their names, report.json says that the folder is incomplete.
/// @param watch          of the stages "save the sweep" and "chart"
/// @param before_naming  is called before the files get their names; what it returns lives until they have them
/// @param film           of a time of a film: fields, waves, places, radiance and charts are left out, and film_render.exr and
///                       film_view.exr are added, the pictures of the films (film.h)
SavedRun save_run(const std::string& folder, const RunResults& results, const Job& job, const StageObserver& watch = {},
                  const std::function<std::shared_ptr<void>()>& before_naming = {}, const FilmMark* film = nullptr);

/// Reads what save_run wrote: renders, as their radiance with the white of an automatic exposure where that was written;
/// sources, points, fields, holograms; and pictures of 8 or 16 bits, as linear light whose white is 1. The files do not
/// hold viewpoints, and the report as JSON alone: both stay empty.
/// @throws Error  as list_complete_run, check_series and the readers of the files do
RunResults load_run(const std::string& folder);

}  // namespace holotrace
