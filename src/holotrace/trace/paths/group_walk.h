#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>

#include "holotrace/trace/paths/diffuse_lanes.h"
#include "holotrace/trace/paths/path_walk.h"

namespace holotrace {

/// Paths of one block of random numbers that are followed together. While they are on diffuse surfaces that only reflect, what
/// happens there is computed in vector lanes (diffuse_lanes.h). A path that reaches another surface is followed by itself from
/// there to its end (path_walk.h). The mean of the light is that of PathWalk.
///
/// Lights are sampled at every surface (PathParams::asks_at_end is not known here), and phases are not followed.
template <class Sink>
class GroupWalk {
 public:
  using Common = typename PathWalk<Sink>::CommonStart;

  /// @param numbers    at any path of the block
  /// @param dimension  of the numbers, the first that has not been taken
  GroupWalk(const PathScene& scene, Sink& sink, PathCounts& counts, LowDiscrepancy& numbers, int dimension)
      : scene_(scene),
        counts_(counts),
        numbers_(numbers),
        dimension_(dimension),
        walk_(scene, sink, counts),
        direct_light_(scene, sink, counts) {
    static_assert(!Sink::follows_phase, "paths of a group have no phase");
  }

  /// Begins a path of the block, 0 … 15, at the first surface on a ray of a camera; false if there is none.
  bool begin(uint32_t path, const Ray& ray) {
    if (!walk_.find(ray)) return false;
    if (!walk_.begin_here()) return true;
    set_first();
    put(path);
    return true;
  }

  /// Begins paths 0 … count − 1 of the block at a surface without a lamp. Lights have been sampled there.
  void begin(const PathStart& start, const Common& common, int count) {
    walk_.begin(start, count);
    set_first();
    common_ = &common;
    if (const auto reflectance = reflectance_here())
      paths_.fill(count, start.point, start_here(), *reflectance);
    else
      for (int path = 0; path < count; ++path) {
        walk_.set_start(start);
        follow_alone(uint32_t(path));
      }
  }

  /// Follows all paths that have begun to their ends.
  void follow() {
    for (; paths_.surfaces.count > 0; ++depth_) {
      if (common_)
        dimension_ += common_->dimensions;
      else
        dimension_ += direct_light_.add_for_group(paths_, state_, depth_, aim_, dimension_, numbers_);
      scatter();
    }
  }

 private:
  void set_first() {
    state_ = walk_.state();
    depth_ = walk_.depth();
    aim_ = walk_.aim();
  }

  std::optional<Vec3> reflectance_here() const {
    return diffuse_reflectance(walk_.material(), walk_.point(), scene_.lines);
  }
  Vec3 start_here() const { return scene_.accelerator.leave(walk_.point(), walk_.point().geometric_normal); }

  /// Puts a path that has reached a surface where it belongs.
  void put(uint32_t path) {
    if (const auto reflectance = reflectance_here())
      paths_.add(path, walk_.point(), start_here(), walk_.throughput() * *reflectance);
    else
      follow_alone(path);
  }

  void follow_alone(uint32_t path) {
    numbers_.go_to(path, dimension_);
    walk_.set_common(common_);
    walk_.go_on(numbers_);
  }

  /// Draws how the paths go on, and lets them.
  void scatter() {
    // For roulette, and for paths that count as cut after the last surface.
    const bool needs_choices = depth_ >= std::min(scene_.params.roulette_depth, scene_.params.max_depth);
    LowDiscrepancy::Block choices;
    if (needs_choices) choices = numbers_.of_block(dimension_);
    const LowDiscrepancy::Block& places = numbers_.of_block(dimension_ + 1);
    dimension_ += 2;
    common_ = nullptr;
    const int count = paths_.surfaces.count;
    std::array<uint32_t, most_together> u, v;
    for (size_t i = 0; i < size_t(count); ++i) u[i] = places.x[paths_.number[i]], v[i] = places.y[paths_.number[i]];
    DiffuseSamples next;
    sample_directions(paths_.surfaces, u.data(), v.data(), next);
    paths_.surfaces.count = 0;
    for (size_t i = 0; i < size_t(count); ++i) {
      const uint32_t path = paths_.number[i];
      const Vec3 throughput = paths_.throughput[i];
      const double choice = needs_choices ? choices.y[path] * 0x1p-32 : 0;
      const double share = next.pdf[i] > 0 ? std::min(1.0, max_component(throughput)) : 0;
      const double goes_on = depth_ >= scene_.params.roulette_depth || share == 0 ? share : 1;
      if (!(choice < goes_on)) {
        ++counts_.absorbed;
        continue;
      }
      const Ray ray{paths_.surfaces.start[i], next.direction[i]};
      // Paths that stay take the places of paths that have left.
      if (walk_.leave_diffuse({state_, depth_, throughput * (1 / goes_on), choice < share}, ray, next.pdf[i]))
        put(path);
    }
    state_ = scene_.automaton.step(state_, PathEvent::diffuse);
    aim_ = Aim::random;
  }

  const PathScene& scene_;
  PathCounts& counts_;
  LowDiscrepancy& numbers_;
  int dimension_;
  PathWalk<Sink> walk_;
  DirectLight<Sink> direct_light_;
  const Common* common_ = nullptr;

  DiffusePaths paths_;
  PathAutomaton::State state_ = 0;
  int depth_ = 1;
  Aim aim_ = Aim::exact;
};

}  // namespace holotrace
