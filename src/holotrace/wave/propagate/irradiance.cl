// |u|² of `count` samples, as irradiance_of_row of irradiance.cpp.
__kernel void irradiance(__global const float2* u, __global float* to, int count) {
  const int i = get_global_id(0);
  if (i < count) to[i] = u[i].x * u[i].x + u[i].y * u[i].y;
}
