#pragma once

#include <array>
#include <cmath>

namespace holotrace {

/// Operations of a method of summing waves, counted before they are done.
struct SummationWork {
  double exact_terms = 0;         ///< pairs of a wave and a pixel that are summed one by one in double
  double multiply_adds = 0;       ///< multiply-adds of floats, in the products of tiles
  double bf16_multiply_adds = 0;  ///< multiply-adds of bf16 numbers
  double factors = 0;             ///< columns and rows of waves in tiles: a sine and a cosine each
  double packings = 0;            ///< conversions of a part of a factor's three numbers to bf16
  double wave_tiles = 0;          ///< pairs of a wave and a tile: work done once for each pair
  double plane_waves = 0;         ///< such pairs in the method `planes`: phases and kernel weights
  double spreads = 0;             ///< complex cells of that method's grids to which waves are added
  double fft_operations = 0;      ///< Σ 5·N·log₂N over the transforms
  double samples = 0;             ///< complex samples multiplied by a transfer function, added up or copied
};

/// Operations of each kind that one thread of this machine does per second; 0 where it cannot do them. The defaults
/// are those of an ordinary processor with AVX2, for machines that were not measured.
struct SummationRates {
  double exact_terms = 2e7;
  double multiply_adds = 3e10;
  double bf16_multiply_adds = 0;
  double factors = 6e8;
  double packings = 1e9;
  double wave_tiles = 3e7;
  double plane_waves = 1.5e7;
  double spreads = 1e9;
  double fft_operations = 6e9;
  double samples = 3e8;
};

/// A kind of operation: its name in files, its count and its rate.
struct SummationTerm {
  const char* name;
  double SummationWork::*count;
  double SummationRates::*rate;
};

/// The list of all kinds; all code that predicts, measures, rounds or saves them uses it.
inline constexpr std::array<SummationTerm, 10> summation_terms{{
    {"exact_terms", &SummationWork::exact_terms, &SummationRates::exact_terms},
    {"multiply_adds", &SummationWork::multiply_adds, &SummationRates::multiply_adds},
    {"bf16_multiply_adds", &SummationWork::bf16_multiply_adds, &SummationRates::bf16_multiply_adds},
    {"factors", &SummationWork::factors, &SummationRates::factors},
    {"packings", &SummationWork::packings, &SummationRates::packings},
    {"wave_tiles", &SummationWork::wave_tiles, &SummationRates::wave_tiles},
    {"plane_waves", &SummationWork::plane_waves, &SummationRates::plane_waves},
    {"spreads", &SummationWork::spreads, &SummationRates::spreads},
    {"fft_operations", &SummationWork::fft_operations, &SummationRates::fft_operations},
    {"samples", &SummationWork::samples, &SummationRates::samples},
}};

/// The sum of the work of two tasks.
inline SummationWork operator+(SummationWork a, const SummationWork& b) {
  for (const SummationTerm& term : summation_terms) a.*term.count += b.*term.count;
  return a;
}

inline SummationWork operator*(double factor, SummationWork work) {
  for (const SummationTerm& term : summation_terms) work.*term.count *= factor;
  return work;
}

/// The nearest power of 2^(1/4): measured rates are kept in steps of about 19 %, so that a second measurement of the
/// same machine mostly gives the same numbers.
inline double coarse_rate(double rate) { return rate > 0 ? std::exp2(std::round(4 * std::log2(rate)) / 4) : 0; }

/// What an OpenCL device does per second; 0 where it was not measured.
struct DeviceRates {
  double multiply_adds = 0;  ///< of the sum of waves in tiles, its factors counted as in multiply_adds_per_wave_pixel
  double bytes = 0;          ///< transferred to the device or back
  double moved_bytes = 0;    ///< read and written in its memory by the kernels of a propagation
};

/// A rate and its name in files.
struct DeviceRateTerm {
  const char* name;
  double DeviceRates::*rate;
};

inline constexpr std::array<DeviceRateTerm, 3> device_rate_terms{{{"multiply_adds", &DeviceRates::multiply_adds},
                                                                  {"bytes", &DeviceRates::bytes},
                                                                  {"moved_bytes", &DeviceRates::moved_bytes}}};

}  // namespace holotrace
