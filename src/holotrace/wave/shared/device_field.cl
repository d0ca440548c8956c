// Σ|u|² of each row (device_field.h). A group of GROUP items adds up a row, in an order that does not depend on the device.
__kernel void row_energies(__global const float2* u, int nx, __global float* sums) {
  __local float parts[GROUP];
  const int item = get_local_id(0), row = get_group_id(1);
  float sum = 0;
  for (int i = item; i < nx; i += GROUP) {
    const float2 sample = u[(size_t)row * nx + i];
    sum += sample.x * sample.x + sample.y * sample.y;
  }
  parts[item] = sum;
  for (int left = GROUP / 2; left > 0; left /= 2) {
    barrier(CLK_LOCAL_MEM_FENCE);
    if (item < left) parts[item] += parts[item + left];
  }
  if (item == 0) sums[row] = parts[0];
}
