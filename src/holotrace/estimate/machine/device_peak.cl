// What a device can do at most: multiply-adds in registers, and memory.

#ifdef FP_FAST_FMAF
#define MULTIPLY_ADD fma
#else
#define MULTIPLY_ADD mad
#endif

// 32 multiply-adds per item and round, in independent sums that hide the latency.
__kernel void multiply_adds(__global float* sums, float factor, int rounds) {
  const float start = get_global_id(0);
  float4 a = start, b = start + 1.0f, c = start + 2.0f, d = start + 3.0f;
  float4 e = start + 4.0f, f = start + 5.0f, g = start + 6.0f, h = start + 7.0f;
  const float4 x = factor, y = 1.0f;
  for (int i = 0; i < rounds; ++i) {
    a = MULTIPLY_ADD(a, x, y);
    b = MULTIPLY_ADD(b, x, y);
    c = MULTIPLY_ADD(c, x, y);
    d = MULTIPLY_ADD(d, x, y);
    e = MULTIPLY_ADD(e, x, y);
    f = MULTIPLY_ADD(f, x, y);
    g = MULTIPLY_ADD(g, x, y);
    h = MULTIPLY_ADD(h, x, y);
  }
  const float4 all = ((a + b) + (c + d)) + ((e + f) + (g + h));
  sums[get_global_id(0)] = all.x + all.y + all.z + all.w;
}

// 16 bytes read and 16 written per item.
__kernel void copy(__global const float4* from, __global float4* to) { to[get_global_id(0)] = from[get_global_id(0)]; }
