#include "holotrace/trace/paths/path.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <numeric>
#include <optional>
#include <vector>

#include "holotrace/base/error.h"
#include "holotrace/trace/paths/diffuse_lanes.h"
#include "holotrace/trace/paths/path_walk.h"

namespace holotrace {

namespace {

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
        sink_(sink),
        direct_light_(scene, sink, counts) {
    static_assert(!Sink::follows_phase, "paths of a group have no phase");
  }

  /// Begins paths of the block at the first surfaces on rays of a camera. Bit i of the result is 1 if there is none on ray i.
  uint32_t begin(std::span<const NumberedRay> rays) {
    LaneVectors origin, direction;
    for (size_t i = 0; i < rays.size(); ++i) origin.set(i, rays[i].ray.origin), direction.set(i, rays[i].ray.direction);
    const uint32_t asked = (1U << rays.size()) - 1;
    const uint32_t found =
        scene_.accelerator.closest_hits({origin, direction, without_end}, asked, Aim::random, true, hits_);
    counts_.rays += int64_t(rays.size());
    for (uint32_t left = found; left; left &= left - 1) {
      const auto i = size_t(std::countr_zero(left));
      of_path(rays[i].path);
      walk_.set_found(rays[i].ray, hits_[i]);
      if (!walk_.begin_here()) continue;
      set_first();
      put(rays[i].path);
    }
    const uint32_t misses = asked & ~found;
    for (uint32_t left = misses; left; left &= left - 1) {
      const auto i = size_t(std::countr_zero(left));
      if constexpr (Sink::is_by_path) sink_.lights[rays[i].path] = hits_[i].weight;
    }
    return misses;
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

  void of_path(uint32_t path) {
    if constexpr (Sink::is_by_path) sink_.of_path(path);
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
    const PathAutomaton::State state = scene_.automaton.step(state_, PathEvent::diffuse);
    uint32_t going = 0;  // bits: paths that go on
    std::array<bool, most_together> is_counted;
    for (size_t i = 0; i < size_t(count); ++i) {
      const Vec3 throughput = paths_.throughput[i];
      const double choice = needs_choices ? choices.y[paths_.number[i]] * 0x1p-32 : 0;
      const double share = next.pdf[i] > 0 ? std::min(1.0, max_component(throughput)) : 0;
      const double goes_on = depth_ >= scene_.params.roulette_depth || share == 0 ? share : 1;
      if (!(choice < goes_on)) continue;
      going |= 1U << i;
      is_counted[i] = choice < share;
      paths_.throughput.set(i, throughput * (1 / goes_on));
    }
    counts_.absorbed += count - std::popcount(going);
    uint32_t found = 0;
    if (walk_.looks_on(state, depth_))
      found = scene_.accelerator.closest_hits({paths_.surfaces.start, next.direction, without_end}, going, Aim::random,
                                              false, hits_);
    paths_.surfaces.count = 0;
    for (uint32_t left = going; left; left &= left - 1) {
      const auto i = size_t(std::countr_zero(left));
      const uint32_t path = paths_.number[i];
      const Ray ray{paths_.surfaces.start[i], next.direction[i]};
      of_path(path);
      // Paths that stay take the places of paths that have left.
      Vec3 throughput = paths_.throughput[i];
      if (scene_.accelerator.has_media() && !(found >> i & 1) && walk_.looks_on(state, depth_))
        throughput *= hits_[i].weight;  // of light from beyond the media
      if (walk_.leave_diffuse({state, depth_, throughput, is_counted[i], paths_.surfaces, i}, ray, next.pdf[i],
                              found >> i & 1 ? &hits_[i] : nullptr))
        put(path);
    }
    state_ = state;
    aim_ = Aim::random;
  }

  const PathScene& scene_;
  PathCounts& counts_;
  LowDiscrepancy& numbers_;
  int dimension_;
  PathWalk<Sink> walk_;
  Sink& sink_;
  DirectLight<Sink> direct_light_;
  const Common* common_ = nullptr;

  DiffusePaths paths_;
  std::array<Hit, most_together> hits_;
  PathAutomaton::State state_ = 0;
  int depth_ = 1;
  Aim aim_ = Aim::exact;
};

/// Adds light to its sums, and to `whole`, in which each light counts once.
struct RadianceSink {
  static constexpr bool follows_phase = false, is_by_path = false, follows_polarization = false;
  std::span<Vec3> sums;
  int path_groups;
  bool is_by_light;
  Vec3 whole{};

  void add(uint32_t accepted, int group, Vec3 radiance) {
    whole += radiance;
    const size_t first = is_by_light ? size_t(group) * size_t(path_groups) : 0;
    for (int path_group = 0; path_group < path_groups; ++path_group)
      if (accepted >> path_group & 1) sums[first + size_t(path_group)] += radiance;
  }
  void end_way(std::optional<double>, const MirrorOnWay&) {}
};

/// Adds light to that of its path, once for each path group that accepts it.
struct PathLightSink {
  static constexpr bool follows_phase = false, is_by_path = true, follows_polarization = false;
  std::array<Vec3, most_together> lights{};
  uint32_t path = 0;

  void of_path(uint32_t number) { path = number; }
  void add(uint32_t accepted, int, Vec3 radiance) { lights[path] += radiance * std::popcount(accepted); }
  void end_way(std::optional<double>, const MirrorOnWay&) {}
};

/// Adds what a detector sees of polarised light.
struct StokesSink : RadianceSink {
  static constexpr bool follows_polarization = true;
  StokesRow seen{};
};

RadianceSink make_sink(const PathScene& scene, std::span<Vec3> sums) {
  return {sums, scene.automaton.path_groups(), scene.params.separate_lights};
}

/// Whether paths may be followed as a group: without a clamp, which limits what a path finds in all, with lights sampled at each
/// surface, and without polarization.
bool fits_groups(const PathScene& scene) {
  return scene.params.clamp <= 0 && !scene.params.asks_at_end && !scene.detector;
}

/// The fraction of light of this strength that a clamp keeps.
double let_through(double light, double clamp) { return light > clamp ? clamp / light : 1; }

/// Follows a path by itself. `begin` begins it, and returns false if it has ended at once.
template <class Begin>
void follow_one(const PathScene& scene, LowDiscrepancy& numbers, std::span<Vec3> sums, PathCounts& counts,
                const Begin& begin) {
  const double clamp = scene.params.clamp;
  // The light of the path, all of it together.
  const auto follow_with = [&](auto sink) {
    PathWalk walk(scene, sink, counts);
    if (begin(walk)) walk.go_on(numbers);
    return sink.whole;
  };
  const auto follow = [&](std::span<Vec3> into) {
    return scene.detector ? follow_with(StokesSink{make_sink(scene, into)}) : follow_with(make_sink(scene, into));
  };
  if (clamp <= 0) {
    follow(sums);
    return;
  }
  std::vector<Vec3> path(sums.size());
  const Vec3 whole = follow(path);
  const Vec3 scale{let_through(whole.x, clamp), let_through(whole.y, clamp), let_through(whole.z, clamp)};
  counts.clamped += scale != Vec3{1, 1, 1};
  for (size_t i = 0; i < sums.size(); ++i) sums[i] += path[i] * scale;
}

}  // namespace

PathCounts& PathCounts::operator+=(const PathCounts& other) {
  paths += other.paths;
  vertices += other.vertices;
  rays += other.rays;
  shadow_rays += other.shadow_rays;
  escaped += other.escaped;
  absorbed += other.absorbed;
  cut += other.cut;
  left_out += other.left_out;
  clamped += other.clamped;
  return *this;
}

void report(const PathCounts& counts, int max_depth, const Observer& observer) {
  observer.fact("rays", Fact(counts.rays));
  observer.fact("shadow_rays", Fact(counts.shadow_rays));
  observer.fact("paths", Fact(counts.paths));
  observer.fact("mean_path_length", Fact(counts.mean_path_length()));
  observer.fact("escaped", Fact(counts.escaped));
  observer.fact("absorbed", Fact(counts.absorbed));
  observer.fact("cut", Fact(counts.cut));
  observer.fact("left_out", Fact(counts.left_out));
  observer.fact("clamped", Fact(counts.clamped));
  // A cut path still has the light of its first max_depth surfaces: below 5 % the loss is not visible.
  constexpr double visible = 0.05;
  if (double(counts.cut) > visible * double(counts.paths))
    observer.warn(
        fmt::format("{:.0f} % of the light paths were cut after {} surfaces, which darkens corners and "
                    "interiors; raise max_depth",
                    100.0 * double(counts.cut) / double(counts.paths), max_depth));
}

void warn_of_caustics(const PathScene& scene, const Observer& observer) {
  if (scene.caustics.has_uneven)
    observer.warn(
        "caustics of point, spot and directional lights through mirrors or glass with a normal map or an opacity "
        "below 1 are left out; use rectangle lights, or remove the map");
  if (scene.caustics.has_long)
    observer.warn(fmt::format(
        "caustics of point, spot and directional lights with more than {} reflections and refractions are left out; "
        "use rectangle lights, which paths find by themselves",
        most_chained));
}

void add_radiance(const PathScene& scene, const PathStart& start, LowDiscrepancy& numbers, std::span<Vec3> sums,
                  PathCounts& counts) {
  follow_one(scene, numbers, sums, counts, [&](auto& walk) { return walk.begin(start); });
}

bool add_radiance(const PathScene& scene, const Ray& ray, LowDiscrepancy& numbers, std::span<Vec3> sums,
                  PathCounts& counts, Vec3* beyond) {
  bool has_met = false;
  follow_one(scene, numbers, sums, counts, [&](auto& walk) {
    has_met = walk.find(ray);
    if (!has_met && beyond) *beyond = walk.weight_beyond();
    return has_met && walk.begin_here();
  });
  return has_met;
}

uint32_t find_radiance(const PathScene& scene, std::span<const NumberedRay> rays, int dimension,
                       LowDiscrepancy& numbers, std::span<Vec3> lights, PathCounts& counts) {
  require(rays.size() <= most_together && lights.size() == rays.size(),
          "expected at most {} rays that are followed together, and as many places for their light, got {} and {}",
          most_together, rays.size(), lights.size());
  if (rays.empty()) return 0;
  if (fits_groups(scene)) {
    PathLightSink sink;
    GroupWalk group(scene, sink, counts, numbers, dimension);
    const uint32_t misses = group.begin(rays);
    group.follow();
    for (size_t i = 0; i < rays.size(); ++i) lights[i] = sink.lights[rays[i].path];
    return misses;
  }
  uint32_t misses = 0;
  std::vector<Vec3> sums(size_t(scene.sums()));
  for (size_t i = 0; i < rays.size(); ++i) {
    numbers.go_to(rays[i].path, dimension);
    std::fill(sums.begin(), sums.end(), Vec3{});
    Vec3 beyond{1, 1, 1};
    const bool is_miss = !add_radiance(scene, rays[i].ray, numbers, sums, counts, &beyond);
    misses |= uint32_t(is_miss) << i;
    lights[i] = is_miss ? beyond : std::accumulate(sums.begin(), sums.end(), Vec3{});
  }
  return misses;
}

void add_light_on_way(const PathScene& scene, const Ray& ray, double distance, PathAutomaton::State state,
                      std::span<Vec3> sums) {
  RadianceSink sink = make_sink(scene, sums);
  PathCounts unused;
  PathWalk(scene, sink, unused).add_light_on_way(ray, distance, state, 0, Vec3{1, 1, 1} * scene.share_of_unpolarised());
}

void mean_radiance(const PathScene& scene, const PathStart& start, int paths, uint64_t sample, std::span<Vec3> sums,
                   PathCounts& counts) {
  std::fill(sums.begin(), sums.end(), Vec3{});
  LowDiscrepancy numbers(scene.params.seed, 0, sample);
  if (start.point.light < 0 && fits_groups(scene) && !scene.parts_lines) {
    // Lights are sampled at the start for all paths together.
    RadianceSink sink = make_sink(scene, sums);
    const auto common = PathWalk(scene, sink, counts).add_direct_light_at_start(start, paths, numbers);
    for (int first = 0; first < paths; first += most_together) {
      numbers.start(uint32_t(first));
      GroupWalk group(scene, sink, counts, numbers, 0);
      group.begin(start, common, std::min(most_together, paths - first));
      group.follow();
    }
  } else {
    for (int path = 0; path < paths; ++path) {
      numbers.start(uint32_t(path));
      add_radiance(scene, start, numbers, sums, counts);
    }
  }
  for (Vec3& sum : sums) sum = sum / paths;
}

}  // namespace holotrace
