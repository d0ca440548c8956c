#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <memory_resource>
#include <optional>
#include <utility>
#include <vector>

#include "holotrace/base/vec.h"
#include "holotrace/data/scene.h"
#include "holotrace/trace/geometry/accelerator.h"
#include "holotrace/trace/geometry/box_tree.h"
#include "holotrace/trace/geometry/face_crossings.h"
#include "holotrace/trace/shared/ray.h"

namespace holotrace {

class MediumGrid;

/// The media of a scene: where a ray is in which of them, where a particle stops it, and how much light passes.
///
/// **Where.** Regions are closed meshes whose material has a medium, solids of glass without one, which absorb by their attenuation
/// (PrincipledMaterial) or are empty, boxes, and one medium for the rest of space. Where several overlap, a smaller region comes before
/// a larger one: so the innermost counts. A place is inside a mesh that winds around it any number of times but 0. Nothing is
/// remembered along a path. The boundaries on the whole half line tell where it began, since a ray enters a region as often as it
/// leaves it in the end. Glass that absorbs may have holes. Its inside is then what lies between a face that a ray enters, or an
/// origin within the bounds of the mesh, and a face by which it leaves next. Other glass with holes is not empty.
///
/// **Absorption alone.** A medium that neither scatters nor emits has no particles: light is dimmed by its transmittance.
///
/// **Free flight.** A ray meets a particle at the distance t with the density σ(t)·T(t), T = exp(−∫σ dt). Colours may have
/// different σ. The distance is then drawn by one of the three lines, chosen at random, and the light is weighted by the mean of
/// the densities of all three (E. Veach, Robust Monte Carlo Methods for Light Transport Simulation, 1997, section 9.2.4, with one
/// sample; A. Wilkie et al., EGSR 2014):
///
///     weightᵢ = σᵢ·Tᵢ / (⅓·Σⱼ σⱼ·Tⱼ),   at a surface Tᵢ / (⅓·Σⱼ Tⱼ)
///
/// With equal σ the weight is 1. In a grid of densities, particles are drawn by delta tracking: tentative ones have the density of
/// the local majorant μ, and each is real with the probability σ/μ. Majorants are those of blocks of 8 × 8 × 8 cells of the grid, or
/// of fewer where densities differ so much that most tentative particles would not be real.
///
/// **Transmittance** is exp(−σ·t) in even media, and by ratio tracking in grids: T is the product of 1 − σ/μ over tentative
/// particles (J. Novák, A. Selle, W. Jarosz, SIGGRAPH Asia 2014), whose mean is exact.
///
/// **Fire.** Particles of a medium with temperatures emit as black particles: σ_a·B(λ, T) per length, with Planck's B of a nanometre of
/// the spectrum. A thick flame has the radiance of a black body, one of the thickness τ the share 1 − exp(−τ) of it.
///
/// Random numbers are a hash of the ray and the seed: the same ray always meets the same particle, so particles stand still. Calls may
/// run on several threads at once. Keeps a reference to the scene.
class Media {
 public:
  /// @param lines  at which the extinction is taken
  /// @param seed   of the random numbers
  /// @throws Error, naming the medium and mesh, for a mesh around a medium that is not closed, or reaches through the plane of the
  ///         panel
  Media(const Scene& scene, const Lines& lines, uint64_t seed);
  ~Media();

  /// Lets a particle stop a ray that has met the surface of `hit`, or none if `found` is false. Sets the weight of the hit in any
  /// case.
  /// @return  whether the ray has met a surface or a particle
  bool stop(const Ray& ray, bool found, Hit& hit) const;

  /// A particle on the ray before a distance [m], which may be infinite, with the weight of all light that particles send from
  /// there. In even media there always is one; in grids with the probability of free flight.
  std::optional<Hit> particle_before(const Ray& ray, double distance) const;

  /// The share of light at the lines that passes on the ray before a distance [m], which may be infinite.
  Vec3 transmittance(const Ray& ray, double distance) const;

  /// Largest z of a box [m]; 0 if all are behind the panel.
  double front() const { return front_; }

  /// Accelerator::reach_of_particles.
  double reach_of_particles(const ScenePrecision& scene) const;

 private:
  struct Kind {
    Vec3 extinction;         // at the lines [1/m]
    int material;            // of the particles
    const MediumGrid* grid;  // of densities; nullptr: even
    bool only_absorbs;       // has no particles
    const MediumGrid* temperature = nullptr;
  };
  struct Region {
    int medium;      // −1: empty
    bool has_holes;  // a mesh that is not closed
    Box bounds;      // of a mesh
  };
  struct Segment {
    double from, to;  // [m]
    int medium;
  };
  /// Their memory; more is taken from the heap if that is full.
  struct Segments {
    std::array<std::byte, 4096> memory;
    std::pmr::monotonic_buffer_resource resource{memory.data(), memory.size()};
    std::pmr::vector<Segment> list{&resource};
  };
  struct Flight {
    double distance = 0;  // [m]
    int medium = -1;      // −1: no particle
    Vec3 weight{1, 1, 1};
  };

  void find_segments(const Ray& ray, double end, Segments& segments) const;
  Flight fly(const Ray& ray, double end, bool surely) const;
  Hit particle(const Ray& ray, const Flight& flight) const;
  template <class Visit>
  bool visit_tentative(const Ray& ray, const Segment& segment, uint64_t& random, const Visit& visit) const;
  Vec3 passed_on(const Ray& ray, const Segment& segment, uint64_t& random) const;

  std::vector<Kind> kinds_;                         // of each medium, then of solids that absorb
  std::vector<std::unique_ptr<MediumGrid>> grids_;  // of those that have some
  Lines lines_;
  std::vector<Region> regions_;                 // of several at one place, the first counts
  std::vector<std::pair<int, Box>> boxes_;      // of regions
  std::unique_ptr<const FaceCrossings> faces_;  // of the meshes of regions; nullptr: none
  double front_ = 0;
  uint64_t seed_;
};

/// The media of a scene; nullptr if there are none, nor solids that absorb.
std::unique_ptr<const Media> make_media(const Scene& scene, const Lines& lines, uint64_t seed);

}  // namespace holotrace
