#pragma once

#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "holotrace/data/image.h"
#include "holotrace/viewer/contents.h"
#include "holotrace/viewer/live_scene.h"
#include "holotrace/viewer/requests.h"
#include "holotrace/viewer/view_cache.h"

namespace holotrace {

/// A picture with 8 bits per value, as a page shows it.
struct BytePicture {
  int nx = 0, ny = 0, channels = 1;
  std::vector<uint8_t> values;  ///< [row][column][channel]
};

/// A view as a camera takes it.
struct TakenView {
  Image image;                          ///< as the sensor reads it [W/m²]
  double white = 1;                     ///< irradiance of white [W/m²]
  int step = 1;                         ///< 2: every second pixel of the sensor
  std::vector<std::string> warnings{};  ///< each once
  std::string made_of{};                ///< Contents::made_of
};

/// The quantity of a hologram that a page shows beside the view.
enum class PanelQuantity { level, amplitude, phase };

/// What people look at in a viewer. The light that leaves the panel, and the part of it that passes the camera's pupil,
/// stay in memory: a change of focus is one propagation. May be called from several threads; one picture is computed at
/// a time.
///
/// Memory: the levels of each hologram (2 bytes per pixel), and at most `light_bytes` for fields.
class Session {
 public:
  /// @param light_bytes  for fields that are kept; 0: a quarter of this machine's memory
  explicit Session(std::vector<std::string> paths, ContentsParams params = {}, double light_bytes = 0);

  /// Reads the files again if they were written again. @return the number of times that they were read
  int refresh();

  /// What the last picture showed. It may be asked while one is computed.
  std::shared_ptr<const Contents> shown();

  /// Why files that were given show nothing; "" if there is something, or if a run may still write it.
  std::string why_empty();

  /// What is shown and how much memory it takes at most, for a message.
  std::string memory_text();

  /// All that a page must know before it asks for pictures, as JSON.
  std::string describe();

  /// The state of a query with the session's defaults, for instance the distance at which a run looked.
  /// @throws Error as view_state does
  ViewState state_of(const Query& query);

  /// The same picture as `holotrace show` with these settings. A draft shows the first frame of each wavelength and name,
  /// and what the sensor reads at samples, of all pixels or every second one.
  /// @param is_outdated  asked between holograms; if it returns true, the result is empty
  /// @throws Error       as view_hologram does, if there is no hologram, and for a sensor or memory beyond the bounds
  std::optional<TakenView> view(const ViewState& state, const std::function<bool()>& is_outdated = {});

  /// Finds optimised holograms of a live scene, which further views then show (LiveScene::improve). Views are answered
  /// meanwhile. @return whether they are there
  bool improve(const ViewState& state, const std::function<bool()>& is_outdated = {});

  /// What the view should show, on its pixels and as bright (view_cache.h). That of a scene takes seconds, in which
  /// views are still answered.
  /// @param is_outdated  asked from any thread while a scene is traced; if it returns true, that ends
  /// @return             nothing if the session has no render, or if its tracing was ended
  std::optional<TakenView> reference(const ViewState& state, const std::function<bool()>& is_outdated = {});

  /// Whether reference() can return a render.
  bool has_render();

  /// How near the view is to that render (view/compare.h), as JSON; without a render only the contrast.
  std::string metrics(const ViewState& state);

  /// The irradiance of a window of pixels [W/m²] of the view, as JSON. @throws Error for a window outside the view
  std::string values(const ViewState& state, int column, int row, int columns, int rows);

  /// The levels of a hologram, or the field that leaves the panel with the state's effects.
  BytePicture panel(size_t item, PanelQuantity quantity, const ViewState& state);

  /// The view as bytes of a file, as `holotrace show -o view.png` writes it. @param extension ".png" or ".exr"
  std::string file(const ViewState& state, const std::string& extension);

  /// The views of a sweep from a distance or x of the eye to another [m] as bytes of an animation, as `holotrace show --sweep`
  /// writes it. @param ending  one of animation_endings @throws Error also as check_animation does, and if the files are written
  /// again meanwhile
  std::string film(const ViewState& state, Sweep sweep, double from, double to, const std::string& ending);

  /// The command line of `holotrace show` that gives the view of a query; "" if its holograms are not in files.
  std::string command_line(const Query& query);

  /// Places of the scene and their brightness: x, y, z [m] and amplitude of each point, 4 floats.
  std::vector<float> points();

  std::string report();

 private:
  std::optional<TakenView> take(const ViewState& state, const std::function<bool()>& is_outdated, bool is_kept = true);
  std::vector<size_t> chosen(const ViewState& state) const;
  bool turn_to(const ViewState& state, const std::function<bool()>& is_outdated);
  struct Compared {
    TakenView view;
    std::optional<TakenView> render;
  };
  Compared with_render(const ViewState& state, const TraceRequest& trace);
  void load();

  const std::vector<std::string> paths_;
  const ContentsParams params_;
  std::mutex mutex_;
  std::string stamp_;
  int readings_ = 0;
  std::shared_ptr<LiveScene> live_;  // nullptr for what does not change
  std::shared_ptr<const Contents> contents_;
  std::mutex shown_mutex_;
  std::shared_ptr<const Contents> shown_;
  ViewState defaults_;
  LightCache light_;
  RendersShown renders_;
  struct Kept {
    std::string key;
    TakenView view;
  };
  std::optional<Kept> last_;  // the last still view
};

}  // namespace holotrace
