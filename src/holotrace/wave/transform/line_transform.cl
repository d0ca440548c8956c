// Fourier transforms of lines, with the factors and the shifts before, between and after them (line_transform.h).
//
// transform_lines holds a line in local memory; each group of items transforms one line. It is Stockham's transform with
// butterflies of 2, 3, 4, 5 and 8: each item reads its samples, then all items wait, then each item writes them in the
// order of the next pass. Lines that are too long for that, or whose length has other factors, are in global memory, and
// pass_lines does one pass for any factor.
//
// Compiled with HELD, the longest line of transform_lines, and GROUP = HELD / 8.

typedef struct {
  int is_used, start, step, is_mirrored, stride, offset, is_conjugate;
} LineFactors;

typedef struct {
  int count, shift, stride;
  LineFactors factors;
} LineEnd;

typedef struct {
  int length, passes, first;  // first: line of the first group
  float sign;                 // of the exponent of the first transform
  int has_second, adds;
  LineEnd in, out;
  LineFactors filter, ramp;
  int radix[16];
} LineJob;

#define MOST_BUTTERFLIES(R) ((8 + R - 1) / R)  // of an item in a pass

float2 multiply(float2 a, float2 b) { return (float2)(a.x * b.x - a.y * b.y, a.x * b.y + a.y * b.x); }
float2 turn(float2 a, float sign) { return (float2)(-sign * a.y, sign * a.x); }  // sign · i · a

int wrapped(int place, int length) {
  const int rest = place % length;
  return rest < 0 ? rest + length : rest;
}

float2 factor(__global const float2* values, LineFactors f, int line, int at) {
  int row = f.start + line * f.step;
  if (f.is_mirrored && row < 0) row = -row;
  const float2 value = values[(size_t)row * f.stride + f.offset + at];
  return f.is_conjugate ? (float2)(value.x, -value.y) : value;
}

float2 filtered(float2 sample, __global const float2* filter, __global const float2* ramp, const LineJob* job, int line,
                int at) {
  const float2 value = multiply(sample, factor(filter, job->filter, line, at));
  return job->ramp.is_used ? multiply(value, factor(ramp, job->ramp, line, at)) : value;
}

// Sample `at` of the transform's input: the samples of the line at this place of the period, added up.
float2 entering(__global const float2* from, __global const float2* enter, const LineJob* job, int line, int at) {
  float2 sum = (float2)(0.0f);
  for (int n = wrapped(at - job->in.shift, job->length); n < job->in.count; n += job->length) {
    const float2 sample = from[(size_t)line * job->in.stride + n];
    sum += job->in.factors.is_used ? multiply(sample, factor(enter, job->in.factors, line, n)) : sample;
  }
  return sum;
}

void leave_line(__global float2* to, __global const float2* leave, const LineJob* job, int line, int o, float2 value) {
  const float2 sample = job->out.factors.is_used ? multiply(value, factor(leave, job->out.factors, line, o)) : value;
  __global float2* const place = to + (size_t)line * job->out.stride + o;
  *place = job->adds ? *place + sample : sample;
}

void butterfly_2(float2* v, float sign) {
  const float2 a = v[0];
  v[0] = a + v[1];
  v[1] = a - v[1];
}

void butterfly_3(float2* v, float sign) {
  const float2 sum = v[1] + v[2], side = turn(0.866025404f * (v[1] - v[2]), sign), middle = v[0] - 0.5f * sum;
  v[0] += sum;
  v[1] = middle + side;
  v[2] = middle - side;
}

void butterfly_4(float2* v, float sign) {
  const float2 a = v[0] + v[2], b = v[0] - v[2], c = v[1] + v[3], d = turn(v[1] - v[3], sign);
  v[0] = a + c;
  v[1] = b + d;
  v[2] = a - c;
  v[3] = b - d;
}

void butterfly_5(float2* v, float sign) {
  const float2 a = v[1] + v[4], b = v[2] + v[3], c = v[1] - v[4], d = v[2] - v[3];
  const float2 near = v[0] + 0.309016994f * a - 0.809016994f * b, far = v[0] - 0.809016994f * a + 0.309016994f * b;
  const float2 p = turn(0.951056516f * c + 0.587785252f * d, sign), q = turn(0.587785252f * c - 0.951056516f * d, sign);
  v[0] += a + b;
  v[1] = near + p;
  v[2] = far + q;
  v[3] = far - q;
  v[4] = near - p;
}

void butterfly_8(float2* v, float sign) {
  float2 even[4] = {v[0], v[2], v[4], v[6]}, odd[4] = {v[1], v[3], v[5], v[7]};
  butterfly_4(even, sign);
  butterfly_4(odd, sign);
  odd[1] = 0.707106781f * (odd[1] + turn(odd[1], sign));
  odd[2] = turn(odd[2], sign);
  odd[3] = 0.707106781f * (turn(odd[3], sign) - odd[3]);
#pragma unroll
  for (int k = 0; k < 4; ++k) {
    v[k] = even[k] + odd[k];
    v[k + 4] = even[k] - odd[k];
  }
}

// Butterfly j of a pass over a line whose factors so far have the product `done`.
#define READ(R)                                                                                  \
  _Pragma("unroll") for (int b = 0; b < MOST_BUTTERFLIES(R); ++b) {                              \
    const int j = item + b * GROUP;                                                              \
    if (j >= length / R) continue;                                                               \
    const int step = j % done * (length / (done * R));                                           \
    _Pragma("unroll") for (int r = 0; r < R; ++r) {                                              \
      const float2 w = twiddles[r * step];                                                       \
      const float2 x = held[j + r * (length / R)];                                               \
      v[b * R + r] = r == 0 ? x : multiply(x, (float2)(w.x, sign * w.y));                        \
    }                                                                                            \
    butterfly_##R(v + b * R, sign);                                                              \
  }

#define WRITE(R)                                                                                 \
  _Pragma("unroll") for (int b = 0; b < MOST_BUTTERFLIES(R); ++b) {                              \
    const int j = item + b * GROUP;                                                              \
    if (j >= length / R) continue;                                                               \
    _Pragma("unroll") for (int r = 0; r < R; ++r)                                                \
        held[j / done * done * R + j % done + r * done] = v[b * R + r];                          \
  }

#define FOR_RADIX(WORK) \
  switch (radix) {      \
    case 2:             \
      WORK(2) break;    \
    case 3:             \
      WORK(3) break;    \
    case 4:             \
      WORK(4) break;    \
    case 5:             \
      WORK(5) break;    \
    case 8:             \
      WORK(8) break;    \
  }

// The samples are in `held` before and after. twiddles[k] = exp(2πik/length).
void transform(__local float2* held, __global const float2* twiddles, const LineJob* job, float sign) {
  const int item = get_local_id(0), length = job->length;
  int done = 1;
  for (int pass = 0; pass < job->passes; ++pass) {
    const int radix = job->radix[pass];
    float2 v[10];
    FOR_RADIX(READ)
    barrier(CLK_LOCAL_MEM_FENCE);
    FOR_RADIX(WRITE)
    barrier(CLK_LOCAL_MEM_FENCE);
    done *= radix;
  }
}

__kernel __attribute__((reqd_work_group_size(GROUP, 1, 1))) void transform_lines(
    LineJob job, __global const float2* twiddles, __global const float2* from, __global const float2* enter,
    __global const float2* filter, __global const float2* ramp, __global const float2* leave, __global float2* to) {
  __local float2 held[HELD];
  const int item = get_local_id(0), line = job.first + get_group_id(0), length = job.length;
  for (int i = item; i < length; i += GROUP) held[i] = entering(from, enter, &job, line, i);
  barrier(CLK_LOCAL_MEM_FENCE);
  transform(held, twiddles, &job, job.sign);
  if (job.has_second) {
    for (int i = item; i < length; i += GROUP) held[i] = filtered(held[i], filter, ramp, &job, line, i);
    barrier(CLK_LOCAL_MEM_FENCE);
    transform(held, twiddles, &job, -job.sign);
  }
  for (int o = item; o < job.out.count; o += GROUP)
    leave_line(to, leave, &job, line, o, held[wrapped(o + job.out.shift, length)]);
}

// The same in steps, for lines in global memory: line job.first + i is line i of `work`.

__kernel void enter_lines(LineJob job, __global const float2* from, __global const float2* enter,
                          __global float2* work) {
  const int i = get_global_id(0), n = get_global_id(1);
  if (i < job.length) work[(size_t)n * job.length + i] = entering(from, enter, &job, job.first + n, i);
}

__kernel void filter_lines(LineJob job, __global const float2* filter, __global const float2* ramp,
                           __global float2* work) {
  const int i = get_global_id(0), n = get_global_id(1);
  if (i >= job.length) return;
  __global float2* const at = work + (size_t)n * job.length + i;
  *at = filtered(*at, filter, ramp, &job, job.first + n, i);
}

__kernel void leave_lines(LineJob job, __global const float2* work, __global const float2* leave,
                          __global float2* to) {
  const int o = get_global_id(0), n = get_global_id(1);
  if (o < job.out.count)
    leave_line(to, leave, &job, job.first + n, o, work[(size_t)n * job.length + wrapped(o + job.out.shift, job.length)]);
}

// One sample of a pass with any factor.
__kernel void pass_lines(int length, int radix, int done, float sign, __global const float2* twiddles,
                         __global const float2* from, __global float2* to) {
  const int i = get_global_id(0), butterflies = length / radix;
  if (i >= length) return;
  const int j = i % butterflies, q = i / butterflies, step = j % done * (length / (done * radix));
  __global const float2* const line = from + (size_t)get_global_id(1) * length;
  float2 sum = (float2)(0.0f);
  for (int r = 0, at = 0, root = 0; r < radix; ++r) {
    // exp(2πi·(r·step + q·r·length/radix)/length), where root = q·r modulo radix
    const int k = at + root * butterflies;
    const float2 w = twiddles[k < length ? k : k - length];
    sum += multiply(line[j + r * butterflies], (float2)(w.x, sign * w.y));
    at += step;
    root += q;
    if (root >= radix) root -= radix;
  }
  to[(size_t)get_global_id(1) * length + j / done * done * radix + j % done + q * done] = sum;
}

#define TILE 16

// to[column][row] = from[row][column], for matrices that are `step` samples apart
typedef struct {
  int stride, offset, step;
} Place;

__kernel __attribute__((reqd_work_group_size(TILE, TILE, 1))) void transpose_lines(int rows, int columns, Place source,
                                                                                   Place target,
                                                                                   __global const float2* from,
                                                                                   __global float2* to) {
  __local float2 tile[TILE][TILE + 1];
  const int x = get_local_id(0), y = get_local_id(1);
  const int left = get_group_id(0) * TILE, top = get_global_id(1) - y;
  from += get_global_id(2) * (size_t)source.step + source.offset;
  to += get_global_id(2) * (size_t)target.step + target.offset;
  if (top + y < rows && left + x < columns) tile[y][x] = from[(size_t)(top + y) * source.stride + left + x];
  barrier(CLK_LOCAL_MEM_FENCE);
  if (left + y < columns && top + x < rows) to[(size_t)(left + y) * target.stride + top + x] = tile[x][y];
}
