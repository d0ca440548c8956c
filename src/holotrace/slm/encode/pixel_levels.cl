// Levels of single pixels (device_levels.h), compiled together with level_kernel.h.

// Of each row: the largest modulus, the sum of the moduli and that of their squares. A group of GROUP items adds up a row.
__kernel void row_moments(__global const float2* u, int nx, __global float* moments) {
  __local float largest[GROUP], sums[GROUP], squares[GROUP];
  const int item = get_local_id(0), row = get_group_id(1);
  float most = 0, sum = 0, square = 0;
  for (int i = item; i < nx; i += GROUP) {
    const float2 sample = u[(size_t)row * nx + i];
    const float power = sample.x * sample.x + sample.y * sample.y, modulus = sqrt(power);
    most = fmax(most, modulus);
    sum += modulus;
    square += power;
  }
  largest[item] = most;
  sums[item] = sum;
  squares[item] = square;
  for (int left = GROUP / 2; left > 0; left /= 2) {
    barrier(CLK_LOCAL_MEM_FENCE);
    if (item >= left) continue;
    largest[item] = fmax(largest[item], largest[item + left]);
    sums[item] += sums[item + left];
    squares[item] += squares[item + left];
  }
  if (item > 0) return;
  moments[3 * row] = largest[0];
  moments[3 * row + 1] = sums[0];
  moments[3 * row + 2] = squares[0];
}

// The level of the phase of each sample, or for sign = −1 of its conjugate; of phase 0 for a dark one.
__kernel void phase_levels(__global const float2* u, int count, float sign, int levels, float range,
                           __global ushort* to) {
  const int i = get_global_id(0);
  if (i >= count) return;
  const bool is_dark = u[i].x == 0 && u[i].y == 0;
  const float turns = is_dark ? 0.0f : 0.5f * atan2pi(sign * u[i].y, u[i].x);
  to[i] = nearest_phase_level(turns < 0 ? turns + 1 : turns, levels, range);
}

// The level of the modulus of each sample, times `scale`.
__kernel void amplitude_levels(__global const float2* u, int count, float scale, int levels, __global ushort* to) {
  const int i = get_global_id(0);
  if (i < count) to[i] = nearest_amplitude_level(scale * length(u[i]), levels);
}
