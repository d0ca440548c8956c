#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "holotrace/data/params/camera.h"
#include "holotrace/data/params/propagate.h"
#include "holotrace/data/params/show.h"
#include "holotrace/io/scene/scene_edits.h"

namespace holotrace {

/// What the page asks to see: the settings of `holotrace show`, and some of the session's holograms.
struct ViewState {
  ShowParams show;
  CameraParams camera;  ///< one distance, no sweep
  PropagateParams propagation;
  std::vector<size_t> shown{};  ///< numbers of the holograms, from 0; empty: all of them
  bool is_draft = false;  ///< coarser and faster, while something moves: one frame, samples instead of pixel areas
  std::vector<SceneEdit> edits{};  ///< of a live scene: values in place of those of its file
  int step = 1;                    ///< of a draft: 2 means only every second pixel of every second row
};

/// The keys and values of a request, decoded. A key may come once.
using Query = std::map<std::string, std::string>;

/// Bounds of a request from the page. They keep one request from taking the machine's memory or minutes of time.
inline constexpr size_t most_query_bytes = 4096;
inline constexpr int most_subpixels = 5, most_illumination_states = 256;
inline constexpr double most_sensor_pixels = 32e6;

/// The text after "?" as keys and values: pairs joined by "&", percent-encoded UTF-8, "+" for a space.
/// @throws Error for a text that is too long or badly encoded, and for a key that comes twice
Query parse_query(const std::string& text);

/// The state that a query asks for. Its keys are the flags of `holotrace show` without dashes at the start ("distance",
/// "focal-length", …) with the same texts, "items" (numbers joined by commas) and "draft" ("1", or "2" for
/// half the resolution); and for a live scene "set.KEY" with the value of that key.
/// @param items    number of holograms of the session
/// @param defaults settings of the keys that are left out
/// @throws Error   for unknown keys, naming the nearest; for values that are invalid or beyond the bounds above
ViewState view_state(const Query& query, const ViewState& defaults, size_t items);

/// The arguments of `holotrace show` that give the same picture: flags and texts of the query, in the order of the keys.
/// They include those of holograms of other programs, which a page cannot set.
std::vector<std::string> show_arguments(const Query& query);

/// The text as one word of a POSIX shell.
std::string shell_word(const std::string& text);

}  // namespace holotrace
