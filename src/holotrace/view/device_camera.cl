// The camera's work on samples (device_camera.h).

// u = 0 outside the columns [open[j].x, open[j].y) of each row j.
__kernel void cut_by_pupil(int nx, __global const int2* open, __global float2* u) {
  const int i = get_global_id(0), j = get_global_id(1);
  if (i < nx && (i < open[j].x || i >= open[j].y)) u[(size_t)j * nx + i] = (float2)(0.0f);
}

// mean_over_pixels of expose.cpp (PixelSums), first down each column of samples. The weights are divided by n.
__kernel void add_rows(int nx, int first, int n, int count, __global const float* weights, int across,
                       __global const float* from, __global float* to) {
  const int i = get_global_id(0), row = get_global_id(1);
  if (i >= across) return;
  float sum = 0;
  for (int j = 0; j < count; ++j) sum += weights[j] * from[(size_t)(first + row * n + j) * nx + first + i];
  to[(size_t)row * across + i] = sum;
}

// Then across the pixels.
__kernel void add_columns(int across, int n, int count, __global const float* weights, int columns,
                          __global const float* from, __global float* image) {
  const int column = get_global_id(0), row = get_global_id(1);
  if (column >= columns) return;
  float sum = 0;
  for (int i = 0; i < count; ++i) sum += weights[i] * from[(size_t)row * across + column * n + i];
  image[(size_t)row * columns + column] = fmax(0.0f, sum);
}
