// Samples of a field, one by one (propagate_on_device.h), compiled together with sample_place_kernel.h.

// |u|², as irradiance_of_row of propagate.cpp.
__kernel void irradiance(__global const float2* u, __global float* to, int nx) {
  const int i = get_global_id(0), j = get_global_id(1);
  if (i >= nx) return;
  const size_t place = sample_place(i, j, nx);
  const float2 sample = u[place];
  to[place] = sample.x * sample.x + sample.y * sample.y;
}

// to[j][i] = from[j + down][i + right]; 0 outside.
__kernel void take_window(__global const float2* from, int from_nx, int from_ny, int right, int down,
                          __global float2* to, int nx, int ny) {
  const int i = get_global_id(0), j = get_global_id(1);
  if (i >= nx) return;
  const int x = i + right, y = j + down;
  const bool is_inside = x >= 0 && x < from_nx && y >= 0 && y < from_ny;
  to[sample_place(i, j, nx)] = is_inside ? from[sample_place(x, y, from_nx)] : (float2)(0.0f);
}
