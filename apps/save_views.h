#pragma once

#include <string>
#include <vector>

#include "holotrace/run/view_series.h"

namespace holotrace {

/// Writes the pictures of a sweep beside the view they belong to, view.png: view_sweep_01.png, …; view_sweep.gif, the
/// animation of all pictures; and view_sweep.png, the chart of the sweep (viewing.h). For a view named NAME.gif, only
/// the animation. Pictures of an earlier sweep with these names are removed. Without a sweep, nothing is written.
/// @param view      path of the view: .png, .exr or .gif
/// @param observer  is warned if the chart cannot be drawn, for instance because gnuplot is not installed
void save_sweep(const std::string& view, const std::vector<Viewpoint>& from, const ViewSeries& sweep,
                const CameraParams& camera, const Observer& observer);

/// The files that save_sweep writes for `pictures` pictures.
std::vector<std::string> sweep_paths(const std::string& view, size_t pictures);

/// Removes the pictures, the animation and the chart of an earlier sweep. Holograms (pictures with a sidecar) stay.
void remove_sweep(const std::string& view);

/// Removes the i-th and further views of an earlier call (numbered_path), up to the first missing one. Holograms
/// (pictures with a sidecar) and `inputs` stay.
void remove_views(const std::string& view, size_t i, const std::vector<std::string>& inputs);

/// Writes a stereo pair and its anaglyph: NAME_left, NAME_right and NAME_anaglyph, with the extension of `path`. If
/// `is_anaglyph_plain`, the anaglyph is `path` itself.
/// @param bits  bits per channel of a PNG
void save_stereo(const std::string& path, const std::vector<Image>& pair, double white, int bits,
                 bool is_anaglyph_plain = false);

/// Removes an earlier stereo pair and its anaglyph.
void remove_stereo(const std::string& path);

/// Whether two paths name one file, which need not exist.
bool is_same_file(const std::string& a, const std::string& b);

/// The path with a suffix after its name: ("out/view.png", "_left") → "out/view_left.png".
std::string path_with_suffix(const std::string& path, const std::string& suffix);

}  // namespace holotrace
