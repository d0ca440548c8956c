#include <algorithm>
#include <cmath>
#include <complex>
#include <optional>
#include <utility>
#include <variant>
#include <vector>

#include "holotrace/base/random.h"
#include "holotrace/base/units.h"
#include "holotrace/trace/paths/path_walk.h"

namespace holotrace {

namespace {

/// Phase factor of an optical path [m] and of the phases that surfaces add [rad]. Whole cycles are dropped in double,
/// before the exponential.
std::complex<double> phase_factor(double path, double wavelength, double added) {
  const double cycles = path / wavelength;
  return std::polar(1.0, 2 * pi * (cycles - std::floor(cycles)) + added);
}

/// Records the optical path along a light path and keeps laser light apart from other light.
class PhasorSink {
 public:
  static constexpr bool follows_phase = true, follows_polarization = false, is_by_path = false;

  PhasorSink(const PathScene& scene, int paths, std::span<Phasors> sums)
      : scene_(scene), paths_(paths), sums_(sums), way_(sums.size()), incoherent_(sums.size()) {}

  void start(const PathStart& start) {
    const SurfacePoint& point = start.point;
    path_ = phase_ = {};
    move_ = start.phase_move;
    branches_ = 1;
    index_ = Vec3{1, 1, 1} * start.index;
    const Material& material = scene_.scene.materials[size_t(point.material)];
    if (is_solid_glass(material)) index_ = indices(material, point, false);
  }

  void travel(double distance) { path_ += index_ * distance; }

  void scatter(const SurfacePoint& point, const BsdfSample& next) {
    constexpr uint64_t most = uint64_t(1) << 62;
    const bool is_random = branches_ == 0 || branches_ >= most || next.lobe != Lobe::specular;
    branches_ = is_random ? 0 : branches_ << 1 | uint64_t(next.is_transmission);
    phase_ += next.phase;
    const Material& material = scene_.scene.materials[size_t(point.material)];
    if (is_solid_glass(material)) index_ = indices(material, point, next.is_transmission);
    path_ = path_ - index_ * dot(move_, next.direction);
    move_ = {};
  }

  /// The place at which the phase of light on `point` is evaluated.
  Vec3 place_of_phase(Vec3 point) const { return point + move_; }

  void add(uint32_t accepted, int group, Vec3 radiance) {
    const int path_groups = scene_.automaton.path_groups(),
              first = scene_.params.separate_lights ? group * path_groups : 0;
    group_ = group;
    for (int path_group = 0; path_group < path_groups; ++path_group)
      if (accepted >> path_group & 1) way_[size_t(first + path_group)] += radiance;
  }

  void end_way(std::optional<double> laser_path, const MirrorOnWay& mirror) {
    const double clamp = scene_.params.clamp > 0 ? scene_.params.clamp : std::numeric_limits<double>::infinity();
    for (size_t i = 0; i < way_.size(); ++i) {
      const Vec3 light{std::min(way_[i].x, clamp), std::min(way_[i].y, clamp), std::min(way_[i].z, clamp)};
      is_clamped_ = is_clamped_ || light != way_[i];
      way_[i] = {};
      if (is_black(light)) continue;
      if (!laser_path)
        incoherent_[i] += light;
      else if (const Vec3 path = path_ + index_ * *laser_path; branches_ == 0)
        add_wave(i, light / paths_, path, phase_ + mirror.phase);
      else
        add_to_alike({i, group_, mirror.number, branches_, light, path, phase_ + mirror.phase});
    }
  }

  /// Adds the light that needs the mean over all paths.
  void finish(CounterRandom random) {
    for (const Alike& way : alike_) add_wave(way.sum, way.light / paths_, way.path, way.phase);
    for (size_t i = 0; i < incoherent_.size(); ++i) {
      const double u = random.uniform(), v = random.uniform(), w = random.uniform();
      add_wave(i, incoherent_[i] / paths_, {}, Vec3{u, v, w} * (2 * pi));
    }
  }

  /// Whether a clamp has reduced a contribution since the last call.
  bool was_clamped() { return std::exchange(is_clamped_, false); }

 private:
  /// Contributions of one light by the same mirrors and glass faces.
  struct Alike {
    size_t sum;
    int group, mirror;
    uint64_t branches;
    Vec3 light, path, phase;
  };

  static bool is_solid_glass(const Material& material) { return solid_index(material) != nullptr; }

  Vec3 indices(const Material& material, const SurfacePoint& point, bool is_far) const {
    const auto at = [&](double wavelength) {
      const MediumIndices media = media_at(material, point, wavelength);
      return is_far ? media.far : media.near;
    };
    return {at(scene_.lines.wavelengths[0]), at(scene_.lines.wavelengths[1]), at(scene_.lines.wavelengths[2])};
  }

  void add_wave(size_t sum, Vec3 light, Vec3 path, Vec3 phase) {
    for (size_t line = 0; line < 3; ++line)
      sums_[sum][line] += std::sqrt(component(light, line)) *
                          phase_factor(component(path, line), scene_.lines.wavelengths[line], component(phase, line));
  }

  void add_to_alike(const Alike& way) {
    const auto same = std::find_if(alike_.begin(), alike_.end(), [&](const Alike& other) {
      return other.sum == way.sum && other.group == way.group && other.mirror == way.mirror &&
             other.branches == way.branches;
    });
    if (same == alike_.end())
      alike_.push_back(way);
    else
      same->light += way.light;
  }

  const PathScene& scene_;
  int paths_;
  std::span<Phasors> sums_;
  std::vector<Vec3> way_, incoherent_;
  std::vector<Alike> alike_;

  // The path so far, at the lines.
  Vec3 path_, phase_, index_{1, 1, 1};  // [m]; [rad]; index of the medium that the path is in
  Vec3 move_;                           // PathStart::phase_move, while the path is still at its start
  uint64_t branches_ = 1;  // a 1, then a bit for each specular surface, 1 for a transmission; 0 after a random bounce
  int group_ = 0;
  bool is_clamped_ = false;
};

/// Samples of all frames share seed and frame; no frame has this number.
constexpr uint32_t phases_frame = ~0U;

}  // namespace

void laser_phasors(const PathScene& scene, const PathStart& start, int paths, uint64_t sample, std::span<Phasors> sums,
                   PathCounts& counts) {
  std::fill(sums.begin(), sums.end(), Phasors{});
  PhasorSink sink(scene, paths, sums);
  LowDiscrepancy numbers(scene.params.seed, 0, sample);
  for (int path = 0; path < paths; ++path) {
    numbers.start(uint32_t(path));
    PathWalk(scene, sink, counts).follow(start, numbers);
    counts.clamped += sink.was_clamped();
  }
  sink.finish(CounterRandom(scene.params.seed, phases_frame, sample));
}

}  // namespace holotrace
