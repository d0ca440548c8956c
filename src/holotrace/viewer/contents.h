#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "holotrace/base/vec.h"
#include "holotrace/data/field.h"
#include "holotrace/data/hologram.h"
#include "holotrace/data/job.h"
#include "holotrace/data/params/show.h"
#include "holotrace/data/slm.h"
#include "holotrace/data/sources.h"
#include "holotrace/io/files/file.h"
#include "holotrace/io/run_folder.h"
#include "holotrace/run/stage.h"

namespace holotrace {

/// A hologram that is looked at, or a field, which stands for a hologram on a panel without a pixel structure.
struct ViewedItem {
  std::string file;  ///< that it was read from; "" for what was computed
  Hologram hologram;
  Slm slm;
  std::optional<Field> field{};  ///< the light that leaves the panel; then `hologram` has no levels
};

/// Wavelengths of the light in which an item is shown [m].
std::vector<double> wavelengths_of(const ViewedItem& item, const ShowParams& show = {});

/// A point of the scene, for pictures in space.
struct SpacePoint {
  Vec3 place;            ///< [m]; z < 0 behind the panel
  float brightness = 1;  ///< amplitude, relative to the brightest
};

/// What the viewer shows, as far as it can be read.
struct Contents {
  std::string kind;                     ///< "folder", "holograms", "field", "sources" or "scene"
  std::vector<ViewedItem> items;        ///< holograms or fields
  std::vector<RenderOfView> renders;    ///< renders of a run and where its views lie in them
  std::vector<SpacePoint> points;       ///< at most most_space_points, chosen evenly
  std::shared_ptr<const Job> job{};     ///< of a scene
  std::string report;                   ///< report.json of a folder; "" if there is none
  std::string made_of{};                ///< of a live scene: from what its holograms were made
  std::vector<std::string> problems{};  ///< a sentence for each thing that could not be read
};

inline constexpr size_t most_space_points = 20000;

/// How the paths of a session are read.
struct ContentsParams {
  std::string slm{};  ///< panel: preset name or file; "": the one of each hologram, or pluto
  Outside outside = Outside::refused;
  bool is_live = false;   ///< whether the values of a scene may be changed (live_scene.h)
  StageObserver watch{};  ///< of what takes time: tracing a scene, summing sources
  std::map<std::string, std::string>
      hologram{};  ///< texts of given fields of HologramParams, as holotrace show takes them
};

/// Reads a folder of `holotrace run`, holograms, a field, sources (their field is summed) or a scene (it is traced).
/// A file that is missing or damaged becomes a problem, and the others are shown.
/// @param paths  one path, or several holograms
/// @throws Error for paths that do not exist or are of no such kind, and for what is said of holograms if there are none
Contents load_contents(const std::vector<std::string>& paths, const ContentsParams& params);

/// Places of waves and their brightness, at most most_space_points, chosen evenly.
std::vector<SpacePoint> points_in_space(const std::vector<Sources>& sets);

/// Changes whenever the files of the paths that load_contents reads are written again.
std::string stamp_of(const std::vector<std::string>& paths);

}  // namespace holotrace
