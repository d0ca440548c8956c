// Samples of a field, one by one (device_samples.h).

// |u|², as irradiance_of_row of irradiance.cpp.
__kernel void irradiance(__global const float2* u, __global float* to, int count) {
  const int i = get_global_id(0);
  if (i < count) to[i] = u[i].x * u[i].x + u[i].y * u[i].y;
}

// to[j][i] = from[j + down][i + right]; 0 outside.
__kernel void take_window(__global const float2* from, int from_nx, int from_ny, int right, int down,
                          __global float2* to, int nx, int ny) {
  const int i = get_global_id(0), j = get_global_id(1);
  if (i >= nx) return;
  const int x = i + right, y = j + down;
  const bool is_inside = x >= 0 && x < from_nx && y >= 0 && y < from_ny;
  to[(size_t)j * nx + i] = is_inside ? from[(size_t)y * from_nx + x] : (float2)(0.0f);
}
