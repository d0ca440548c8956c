// Levels of single pixels (device_levels.h), compiled together with sample_place_kernel.h, level_kernel.h,
// interference_kernel.h and double_phase_kernel.h. One item takes one pixel.

// The level nearest to the phase of a sample; to phase 0 for a dark one.
int level_of_phase(float re, float im, int levels, float range) {
  const float turns = re == 0 && im == 0 ? 0.0f : 0.5f * atan2pi(im, re);
  return nearest_phase_level(turns < 0 ? turns + 1 : turns, levels, range);
}

// Of each sample, or for sign = −1 of its conjugate.
__kernel void phase_levels(__global const float2* u, int nx, float sign, int levels, float range, __global ushort* to) {
  const int i = get_global_id(0);
  if (i >= nx) return;
  const size_t place = sample_place(i, get_global_id(1), nx);
  to[place] = level_of_phase(u[place].x, sign * u[place].y, levels, range);
}

// The level of the modulus of each sample, times `unit` and `scale`.
__kernel void amplitude_levels(__global const float2* u, int nx, float unit, float scale, int levels,
                               __global ushort* to) {
  const int i = get_global_id(0);
  if (i >= nx) return;
  const size_t place = sample_place(i, get_global_id(1), nx);
  to[place] = nearest_amplitude_level(scale * length(unit * u[place]), levels);
}

// The level of the phase that shows each sample of modulus 1 or less, or for sign = −1 its conjugate, by two alternating
// phases.
__kernel void double_phase_levels(__global const float2* u, int nx, float sign, int levels, float range,
                                  __global ushort* to) {
  const int i = get_global_id(0), j = get_global_id(1);
  if (i >= nx) return;
  const size_t place = sample_place(i, j, nx);
  const PixelPhasor sample = {u[place].x, sign * u[place].y};
  const PixelPhasor shown = double_phase_pixel(sample, chessboard_sign(i, j));
  to[place] = level_of_phase(shown.re, shown.im, levels, range);
}

WaveSample sample_of(float2 u) {
  const WaveSample sample = {u.x, u.y};
  return sample;
}

// A level for Re(U·R*) ≥ 0, and another one below; 0 for a dark sample.
__kernel void binary_levels(__global const float2* u, int nx, float unit, __global const float2* along_x,
                            __global const float2* along_y, int above, int below, __global ushort* to) {
  const int i = get_global_id(0), j = get_global_id(1);
  if (i >= nx) return;
  const size_t place = sample_place(i, j, nx);
  const float2 sample = unit * u[place];
  const WaveSample wave = plane_wave(sample_of(along_x[i]), sample_of(along_y[j]));
  const bool is_dark = sample.x == 0 && sample.y == 0;
  to[place] = is_dark ? 0 : product_with(wave, sample_of(sample)) >= 0 ? above : below;
}

// The irradiance at a pixel, of samples times `unit` and of a reference of that modulus.
float irradiance_at(__global const float2* u, size_t place, float unit, float2 along_x, float2 along_y, float reference,
                    int with_bias) {
  const WaveSample wave = plane_wave(sample_of(along_x), sample_of(along_y));
  return interference(sample_of(unit * u[place]), wave, reference, with_bias);
}

// The least and the largest irradiance of each row. A group of GROUP items takes a row.
__kernel void irradiance_ranges(__global const float2* u, int nx, float unit, __global const float2* along_x,
                                __global const float2* along_y, float reference, int with_bias,
                                __global float2* ranges) {
  __local float least[GROUP], largest[GROUP];
  const int item = get_local_id(0), row = get_global_id(1);
  float low = INFINITY, high = -INFINITY;
  for (int i = item; i < nx; i += GROUP) {
    const float at = irradiance_at(u, sample_place(i, row, nx), unit, along_x[i], along_y[row], reference, with_bias);
    low = fmin(low, at);
    high = fmax(high, at);
  }
  least[item] = low;
  largest[item] = high;
  for (int left = GROUP / 2; left > 0; left /= 2) {
    barrier(CLK_LOCAL_MEM_FENCE);
    if (item >= left) continue;
    least[item] = fmin(least[item], least[item + left]);
    largest[item] = fmax(largest[item], largest[item + left]);
  }
  if (item == 0) ranges[row] = (float2)(least[0], largest[0]);
}

// The level of each irradiance plus `offset`, times `scale`.
__kernel void irradiance_levels(__global const float2* u, int nx, float unit, __global const float2* along_x,
                                __global const float2* along_y, float reference, int with_bias, float offset,
                                float scale, int levels, __global ushort* to) {
  const int i = get_global_id(0), j = get_global_id(1);
  if (i >= nx) return;
  const size_t place = sample_place(i, j, nx);
  const float at = irradiance_at(u, place, unit, along_x[i], along_y[j], reference, with_bias);
  to[place] = nearest_amplitude_level((at + offset) * scale, levels);
}
