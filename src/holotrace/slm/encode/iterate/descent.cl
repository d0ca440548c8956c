// The pixel loops of iterations (device_loops.h), with the formulas of descent_kernel.h. Loops over pixels have one
// work item for each; sums have one group for each row. Compiled with GROUP, the items of a group, a power of 2.

// u = exp(2πi·c·ℓ), a phase panel without effects.
__kernel void leave_phases(ulong count, float cycles_per_level, __global const float* level, __global float2* u) {
  const size_t i = get_global_id(0);
  if (i >= count) return;
  const float cycles = cycles_per_level * level[i], rest = 2 * (cycles - rint(cycles));
  u[i] = (float2)(cospi(rest), sinpi(rest));
}

// slope += factor·Im(g·u*). With two levels, u is `halfway` between them.
__kernel void add_phase_slopes(ulong count, float factor, int is_halfway, float2 halfway, __global const float2* g,
                               __global const float2* u, __global float* slope) {
  const size_t i = get_global_id(0);
  if (i >= count) return;
  const float2 at = is_halfway ? halfway : u[i];
  slope[i] += factor * phase_slope(g[i].x, g[i].y, at.x, at.y);
}

// power = factor·Σ|v|² over the n × n samples of a pixel, or += that.
__kernel void add_power(int nx, int n, float factor, int adds, __global const float2* v, __global float* power) {
  const int i = get_global_id(0), j = get_global_id(1);
  if (i >= nx) return;
  float sum = 0;
  for (int y = 0; y < n; ++y)
    for (int x = 0; x < n; ++x) {
      const float2 at = v[((size_t)j * n + y) * nx * n + i * n + x];
      sum += at.x * at.x + at.y * at.y;
    }
  const size_t pixel = (size_t)j * nx + i;
  power[pixel] = (adds ? power[pixel] : 0) + factor * sum;
}

// v *= factor at the n × n samples of a pixel.
__kernel void multiply_pixels(int nx, int n, __global const float* factor, __global float2* v) {
  const int i = get_global_id(0), j = get_global_id(1);
  if (i >= nx) return;
  const float by = factor[(size_t)j * nx + i];
  for (int y = 0; y < n; ++y)
    for (int x = 0; x < n; ++x) v[((size_t)j * n + y) * nx * n + i * n + x] *= by;
}

// The mean along row j from its left and right samples.
float mean_of_row(__global const float* left, __global const float* right, int nx, int j, int i) {
  left += (size_t)j * nx;
  right += (size_t)j * nx;
  return mean_along(left[i], right[i], i > 0 ? right[i - 1] : left[0], i + 1 < nx ? left[i + 1] : right[nx - 1]);
}

// The mean over each pixel from the power at its samples: above left and right, below left and right.
__kernel void pixel_means(int nx, int ny, __global const float* above_left, __global const float* above_right,
                          __global const float* below_left, __global const float* below_right, __global float* means) {
  const int i = get_global_id(0), j = get_global_id(1);
  if (i >= nx) return;
  const float upper = mean_of_row(above_left, above_right, nx, j, i);
  const float lower = mean_of_row(below_left, below_right, nx, j, i);
  const float before = j > 0 ? mean_of_row(below_left, below_right, nx, j - 1, i) : upper;
  const float after = j + 1 < ny ? mean_of_row(above_left, above_right, nx, j + 1, i) : lower;
  means[(size_t)j * nx + i] = mean_along(upper, lower, before, after);
}

// v *= factor
__kernel void multiply_by_real(ulong count, __global const float* factor, __global float2* v) {
  const size_t i = get_global_id(0);
  if (i < count) v[i] *= factor[i];
}

// The sum over the items of a group, in an order that depends on GROUP only; the first item has it.
float sum_of_group(__local float* parts, float part) {
  const int item = get_local_id(0);
  parts[item] = part;
  for (int rest = GROUP / 2; rest > 0; rest /= 2) {
    barrier(CLK_LOCAL_MEM_FENCE);
    if (item < rest) parts[item] += parts[item + rest];
  }
  return parts[0];
}

// Σ w·a·A and Σ w·A² of each row.
__kernel __attribute__((reqd_work_group_size(GROUP, 1, 1))) void sum_rows(int nx, int has_weight,
                                                                          __global const float* power,
                                                                          __global const float* amplitude,
                                                                          __global const float* weight,
                                                                          __global float2* sums) {
  __local float crosses[GROUP], squares[GROUP];
  const size_t start = get_group_id(0) * (size_t)nx;
  float cross_sum = 0, square_sum = 0;
  for (int i = get_local_id(0); i < nx; i += GROUP) {
    const float w = has_weight ? weight[start + i] : 1, light = power[start + i];
    cross_sum += w * amplitude[start + i] * sqrt(light);
    square_sum += w * light;
  }
  cross_sum = sum_of_group(crosses, cross_sum);
  square_sum = sum_of_group(squares, square_sum);
  if (get_local_id(0) == 0) sums[get_group_id(0)] = (float2)(cross_sum, square_sum);
}

// The power becomes the factor of its residual; Σ of the errors of each row.
__kernel __attribute__((reqd_work_group_size(GROUP, 1, 1))) void leave_residual(int nx, int has_weight, float scale,
                                                                                __global float* power,
                                                                                __global const float* amplitude,
                                                                                __global const float* weight,
                                                                                __global float* sums) {
  __local float errors[GROUP];
  const size_t start = get_group_id(0) * (size_t)nx;
  float sum = 0;
  for (int i = get_local_id(0); i < nx; i += GROUP) {
    const Residual residual =
        residual_of_pixel(power[start + i], amplitude[start + i], has_weight ? weight[start + i] : 1, scale);
    power[start + i] = residual.factor;
    sum += residual.error;
  }
  sum = sum_of_group(errors, sum);
  if (get_local_id(0) == 0) sums[get_group_id(0)] = sum;
}

// As leave_residual, for asked amplitudes, which change before; the errors are those of the target.
__kernel __attribute__((reqd_work_group_size(GROUP, 1, 1))) void leave_residual_of_asked(
    int nx, int has_weight, float scale, __global float* power, __global const float* amplitude,
    __global const float* weight, __global float* asked, __global float* sums) {
  __local float errors[GROUP];
  const size_t start = get_group_id(0) * (size_t)nx;
  float sum = 0;
  for (int i = get_local_id(0); i < nx; i += GROUP) {
    const size_t at = start + i;
    const float w = has_weight ? weight[at] : 1, light = power[at];
    asked[at] = strengthened(asked[at], amplitude[at], light, scale);
    sum += residual_of_pixel(light, amplitude[at], w, scale).error;
    power[at] = residual_of_pixel(light, asked[at], w, scale).factor;
  }
  sum = sum_of_group(errors, sum);
  if (get_local_id(0) == 0) sums[get_group_id(0)] = sum;
}

// to = factor·from, or += that; for complex numbers, too.
__kernel void add_part(ulong count, float factor, int adds, __global const float* from, __global float* to) {
  const size_t i = get_global_id(0);
  if (i < count) to[i] = (adds ? to[i] : 0) + factor * from[i];
}

// u = (u + step)/|u + step|
__kernel void add_and_make_unit_modulus(ulong count, __global const float2* step, __global float2* u) {
  const size_t i = get_global_id(0);
  if (i >= count) return;
  Phasor sum;
  sum.re = u[i].x + step[i].x;
  sum.im = u[i].y + step[i].y;
  sum = unit_modulus(sum);
  u[i] = (float2)(sum.re, sum.im);
}

__kernel void clear(ulong count, __global float* values) {
  const size_t i = get_global_id(0);
  if (i < count) values[i] = 0;
}

__kernel void step_drives(ulong count, AdamStep adam, float turn, float levels, float hardness,
                          __global const float* slope, __global float* mean, __global float* square,
                          __global float* drive, __global float* rounded) {
  const size_t i = get_global_id(0);
  if (i >= count) return;
  AdamPixel pixel;
  pixel.drive = drive[i];
  pixel.mean = mean[i];
  pixel.square = square[i];
  pixel = adam_pixel(adam, slope[i], pixel);
  const SettledDrive settled = settle_pixel(turn, levels, hardness, pixel.drive);
  mean[i] = pixel.mean;
  square[i] = pixel.square;
  drive[i] = settled.drive;
  rounded[i] = settled.rounded;
}
