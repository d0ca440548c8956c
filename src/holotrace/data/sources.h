#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "holotrace/base/vec.h"

namespace holotrace {

/// A spherical wave that leaves a point behind the panel:
///
///     U(p) = a · (d₀/r) · exp(i(2πr/λ + φ₀)),   r = ‖p − o‖,  d₀ = −o.z     (Eq. 5, 6)
///
/// a is its amplitude where it meets the panel head-on.
struct Source {
  Vec3 origin;          ///< o [m], z < 0
  float amplitude = 0;  ///< a [√(W/m²)]
  float phase = 0;      ///< φ₀ [rad]
  bool operator==(const Source&) const = default;
};

/// The panel cut into columns × rows tiles of (almost) equal size, row 0 on top: tile (c, r) holds the pixels
/// ⌊c·nx/columns⌋ ≤ i < ⌊(c+1)·nx/columns⌋, and rows alike. Each wave has an amplitude of its own in each.
struct TileAmplitudes {
  int columns = 0, rows = 0;  ///< 0: the waves have one amplitude for the whole panel
  std::vector<float> values;  ///< values[tile·waves + wave], tile = r·columns + c [√(W/m²)]
  bool operator==(const TileAmplitudes&) const = default;
};

/// Waves of one wavelength, all coherent with each other.
struct Sources {
  double wavelength = 0;  ///< [m]
  std::vector<Source> waves{};
  TileAmplitudes tiles{};  ///< overrule the amplitudes of the waves
  std::string name{};      ///< of the path group or light that they show, "" for all light

  /// Waves with equal keys start with the same random phase, 2π·u(seed, frame, key) (source_phase.h); a wave
  /// without a random part has the key `no_phase_key`. Empty: no wave has one.
  std::vector<uint64_t> phase_keys{};
  uint64_t seed = 0;
  uint32_t frame = 0;  ///< that the phases are of

  /// Wavelength whose acceptance bounds the waves' boxes [m], at most the waves' own: that of the shortest colour of a
  /// job where all colours share its cone. 0: their own.
  double cone_wavelength = 0;
  double acceptance_wavelength() const { return cone_wavelength > 0 ? cone_wavelength : wavelength; }

  static constexpr uint64_t no_phase_key = ~uint64_t(0);
};

/// The random part of a wave's phase in a frame [rad], in [0, 2π).
double random_phase(uint64_t seed, uint32_t frame, uint64_t key);

/// The same waves in another frame of a time-multiplexed hologram: independent random phases, all else alike. Cost:
/// one hash per wave, so a further frame needs no tracing.
void set_frame(Sources& sources, uint32_t frame);

/// @throws Error, naming the first wave at fault, unless every number is finite, every wave is
///         behind the panel (z < 0), and tile amplitudes and phase keys are as many as the waves need.
void check_sources(const Sources& sources);

/// @throws Error unless the wavelength whose acceptance waves keep to is 0 (their own) or at most their own [m]
void check_cone(double cone_wavelength, double wavelength);

}  // namespace holotrace
