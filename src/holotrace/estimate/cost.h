#pragma once

namespace holotrace {

/// Inputs of the cost estimate of a hologram. Times and ρ are measured by a probe of the scene.
struct CostInputs {
  double pixels = 0;             ///< P, pixels of the panel
  double samples_per_pixel = 0;  ///< S, paths per pixel
  double frames = 1;             ///< F, number of holograms
  double reflectance = 0;        ///< ρ, the probability that a path continues at a surface, in [0, 1)
  double trace_seconds = 0;      ///< T_t, time of one ray through the scene [s]
  double waves = 0;              ///< waves that reach the panel, each of them every pixel
  double wave_rate = 1;          ///< waves·pixels that the synthesis sums per second [1/s]
};

/// The paper's estimate (Eq. 16–23), and the synthesis time, which the paper leaves out. Times are of all frames.
struct Cost {
  double paths = 0;              ///< N = P·S, paths of one frame
  double mean_path_length = 0;   ///< l_avg = 1/(1−ρ)
  double rays = 0;               ///< N_B = l_avg·N (Eq. 21), rays of one frame
  double trace_seconds = 0;      ///< F·N·(1 + l_avg)·T_t (Eq. 17, 23), the rays and the shadow ray of each path [s]
  double synthesis_seconds = 0;  ///< F·waves·P/rate [s]
  double seconds = 0;            ///< the sum of both [s]
};

/// Mean number of surfaces on a path that continues with probability ρ: 1/(1−ρ) (Eq. 20), or (1−ρᵏ⁺¹)/(1−ρ) if it
/// ends after k bounces. (Eq. 19 is this sum of k+1 terms; the paper's closed form has ρᵏ.) Negative k: no end.
/// @throws Error  unless ρ is in [0, 1)
double mean_path_length(double reflectance, int bounces = -1);

/// @throws Error  for an input that is negative or not finite, ρ outside [0, 1), or a wave rate of 0
Cost estimate_cost(const CostInputs& inputs);

}  // namespace holotrace
