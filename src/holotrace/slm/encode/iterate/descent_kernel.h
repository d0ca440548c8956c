#pragma once

// What iterations do with a pixel, in the common language of C++ and OpenCL C: descent.cl is compiled together with
// this file. The loops of processor_loops.cpp say the same in vectors; a test compares both.

#ifdef __OPENCL_VERSION__
#define HOLOTRACE_KERNEL_FUNCTION
#define HOLOTRACE_KERNEL_CONSTANT __constant
#else
#include <cmath>
#define HOLOTRACE_KERNEL_FUNCTION inline
#define HOLOTRACE_KERNEL_CONSTANT inline constexpr
namespace holotrace::descent_kernel {
using std::floor;
using std::fmax;
using std::fmin;
using std::rint;
using std::sqrt;
#endif

/// A step of Adam: `step` and ε include the bias corrections of the first steps.
typedef struct {
  float beta1, beta2, step, epsilon;
} AdamStep;

/// A pixel's drive, and what Adam remembers of its slopes: their mean and that of their squares.
typedef struct {
  float drive, mean, square;
} AdamPixel;

/// A drive in its range, and rounded.
typedef struct {
  float drive, rounded;
} SettledDrive;

/// A complex number.
typedef struct {
  float re, im;
} Phasor;

/// The factor w·(s·a − A)/A of light of the amplitude A, 0 for no light, and its error w·(A − s·a)².
typedef struct {
  float factor, error;
} Residual;

/// m ← β₁m + (1−β₁)d, v ← β₂v + (1−β₂)d², x ← x − step·m/(√v + ε)
HOLOTRACE_KERNEL_FUNCTION AdamPixel adam_pixel(AdamStep adam, float slope, AdamPixel pixel) {
  pixel.mean = adam.beta1 * pixel.mean + (1 - adam.beta1) * slope;
  pixel.square = adam.beta2 * pixel.square + (1 - adam.beta2) * (slope * slope);
  pixel.drive -= adam.step * (pixel.mean / (sqrt(pixel.square) + adam.epsilon));
  return pixel;
}

/// The drive mod turn, or for turn = 0 in [0, levels − 1]; rounded for a hardness of 1, else drive + h·(level − drive).
HOLOTRACE_KERNEL_FUNCTION SettledDrive settle_pixel(float turn, float levels, float hardness, float drive) {
  SettledDrive settled;
  const float last = levels - 1;
  drive = turn > 0 ? drive - turn * floor(drive / turn) : fmin(fmax(drive, 0.0f), last);
  const float level = rint(drive);
  settled.drive = drive;
  if (hardness < 1)
    settled.rounded = drive + hardness * (level - drive);
  else
    settled.rounded = turn > 0 && level > last ? 0.0f : level;
  return settled;
}

HOLOTRACE_KERNEL_FUNCTION Residual residual_of_pixel(float power, float amplitude, float weight, float scale) {
  Residual residual;
  const float modulus = sqrt(power), lack = scale * amplitude - modulus;
  residual.error = weight * (lack * lack);
  residual.factor = modulus == 0 ? 0.0f : weight * lack / modulus;
  return residual;
}

/// The amplitude that the weighted method asks for next, given the wanted one a: asked·(1 + (s·a/A − 1)/10), with the
/// bracket limited to 1, and at most 2a. The light has the power A².
HOLOTRACE_KERNEL_FUNCTION float strengthened(float asked, float wanted, float power, float scale) {
  const float goal = scale * wanted;
  if (goal <= 0) return asked;
  const float lack = fmin(goal / fmax(sqrt(power), 1e-6f * goal) - 1, 1.0f);
  return fmin(2 * wanted, asked * (1 + 0.1f * lack));
}

/// u/|u|, and 1 where u is 0.
HOLOTRACE_KERNEL_FUNCTION Phasor unit_modulus(Phasor u) {
  const float square = u.re * u.re + u.im * u.im, inverse = 1 / sqrt(square == 0 ? 1.0f : square);
  u.re = square == 0 ? 1.0f : u.re * inverse;
  u.im = u.im * inverse;
  return u;
}

/// Im(g·u*): the gradient by the phase of u, given g = ∂f/∂Re u + i·∂f/∂Im u.
HOLOTRACE_KERNEL_FUNCTION float phase_slope(float g_re, float g_im, float u_re, float u_im) {
  return g_im * u_re - g_re * u_im;
}

/// Weights of a pixel's own samples and of its neighbours' along an axis (pixel_means): of all that are even, those with
/// the least error.
HOLOTRACE_KERNEL_CONSTANT float of_neighbour = 2 * 0.0289f, own = 1 - 2 * 0.0289f;

/// The mean along an axis from a pixel's two samples and the nearest one of each neighbour.
HOLOTRACE_KERNEL_FUNCTION float mean_along(float first, float second, float before, float after) {
  return own * (first + second) + of_neighbour * (before + after);
}

#ifndef __OPENCL_VERSION__
}  // namespace holotrace::descent_kernel
#endif
