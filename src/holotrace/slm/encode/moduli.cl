// Moduli of samples (shown_pixels.h), compiled together with sample_place_kernel.h and compensated_sum_kernel.h. A group
// of GROUP items takes a row, in an order that does not depend on the device.

// Of each row the largest |re| or |im|, as the bits of a float: they have the order of the numbers, and those of an infinity
// or of what is not a number are the largest.
__kernel void row_peaks(__global const float2* u, int nx, __global uint* peaks) {
  __local uint parts[GROUP];
  const int item = get_local_id(0), row = get_global_id(1);
  uint most = 0;
  for (int i = item; i < nx; i += GROUP) {
    const float2 sample = u[sample_place(i, row, nx)];
    most = max(most, max(as_uint(sample.x) & 0x7fffffff, as_uint(sample.y) & 0x7fffffff));
  }
  parts[item] = most;
  for (int left = GROUP / 2; left > 0; left /= 2) {
    barrier(CLK_LOCAL_MEM_FENCE);
    if (item < left) parts[item] = max(parts[item], parts[item + left]);
  }
  if (item == 0) peaks[row] = parts[0];
}

// Of each row, times `unit`: the largest modulus, the sum of the moduli and that of their squares.
__kernel void row_moments(__global const float2* u, int nx, float unit, __global float* moments) {
  __local float largest[GROUP], sums[GROUP], squares[GROUP];
  const int item = get_local_id(0), row = get_global_id(1);
  float most = 0;
  CompensatedSum sum = {0, 0}, square = {0, 0};
  for (int i = item; i < nx; i += GROUP) {
    const float2 sample = unit * u[sample_place(i, row, nx)];
    const float power = sample.x * sample.x + sample.y * sample.y, modulus = sqrt(power);
    most = fmax(most, modulus);
    sum = with_term(sum, modulus);
    square = with_term(square, power);
  }
  largest[item] = most;
  sums[item] = sum.sum;
  squares[item] = square.sum;
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

// Adds to the count of step |u|·per_modulus, at most STEPS, for `rows` rows from `first` on, in so many groups. Counts of a
// group are summed in local memory.
__kernel void count_moduli(__global const float2* u, int nx, int first, int rows, int groups,
                           float per_modulus, __global uint* counts) {
  __local uint here[STEPS + 1];
  const int item = get_local_id(0);
  for (int step = item; step <= STEPS; step += GROUP) here[step] = 0;
  barrier(CLK_LOCAL_MEM_FENCE);
  for (int row = get_global_id(1); row < rows; row += groups)
    for (int i = item; i < nx; i += GROUP)
      atomic_inc(&here[min((int)(per_modulus * length(u[sample_place(i, first + row, nx)])), STEPS)]);
  barrier(CLK_LOCAL_MEM_FENCE);
  for (int step = item; step <= STEPS; step += GROUP)
    if (here[step] > 0) atomic_add(&counts[step], here[step]);
}

// Scales the samples to moduli of at most 1, u/max(top, |u|). Of each row the sum of |u|² − top² above `top`.
__kernel void clip_moduli(__global float2* u, int nx, float top, __global float* clipped) {
  __local float parts[GROUP];
  const int item = get_local_id(0), row = get_global_id(1);
  CompensatedSum sum = {0, 0};
  for (int i = item; i < nx; i += GROUP) {
    const size_t place = sample_place(i, row, nx);
    const float2 sample = u[place];
    const float modulus = length(sample);
    if (modulus > top) sum = with_term(sum, (modulus - top) * (modulus + top));
    u[place] = modulus > 0 ? sample / fmax(top, modulus) : (float2)(0.0f);
  }
  parts[item] = sum.sum;
  for (int left = GROUP / 2; left > 0; left /= 2) {
    barrier(CLK_LOCAL_MEM_FENCE);
    if (item < left) parts[item] += parts[item + left];
  }
  if (item == 0) clipped[row] = parts[0];
}
