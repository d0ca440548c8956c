// Fields on a device (device_field.h), compiled together with sample_place_kernel.h and compensated_sum_kernel.h.

__kernel void clear(int nx, __global float2* u) {
  const int i = get_global_id(0), j = get_global_id(1);
  if (i < nx) u[sample_place(i, j, nx)] = (float2)(0.0f);
}

// The samples of a box of so many columns, into a field of nx columns from column x0 and row y0 on.
__kernel void put_box(__global const float2* from, int columns, int nx, int x0, int y0, __global float2* to) {
  const int i = get_global_id(0), j = get_global_id(1);
  if (i < columns) to[sample_place(x0 + i, y0 + j, nx)] = from[sample_place(i, j, columns)];
}

// Σ|u|² of the columns x0 … x1 − 1 of each row from y0 on. A group of GROUP items adds up a row, in an order that does not
// depend on the device.
__kernel void row_energies(__global const float2* u, int nx, int x0, int x1, int y0, __global float* sums) {
  __local float parts[GROUP];
  const int item = get_local_id(0), row = get_global_id(1);
  CompensatedSum sum = {0, 0};
  for (int i = x0 + item; i < x1; i += GROUP) {
    const float2 sample = u[sample_place(i, y0 + row, nx)];
    sum = with_term(sum, sample.x * sample.x + sample.y * sample.y);
  }
  parts[item] = sum.sum;
  for (int left = GROUP / 2; left > 0; left /= 2) {
    barrier(CLK_LOCAL_MEM_FENCE);
    if (item < left) parts[item] += parts[item + left];
  }
  if (item == 0) sums[row] = parts[0];
}
