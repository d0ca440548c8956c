// A panel with its effects, pixel by pixel (device_panel.h). The panel is taken as periodic by the blur. Empty buffers
// are told by numbers: their arguments are then any others.

typedef struct {
  int count, knots;  // pixels; knots of the calibration: 0 for none
  float cycles_per_level, amplitude_per_level, modulus_per_level;
  int has_amplitude, is_complex, has_stuck, is_halfway;
} Response;

typedef struct {
  int nx, ny, n;          // pixels, and samples per pixel and axis
  int reach, first;       // of the blur along x, −1 for none; the first of the cell's taps
  int has_amplitude, has_static;
  float gap_re, gap_im;
} Cell;

int wrapped(int i, int n) {
  const int rest = i % n;
  return rest < 0 ? rest + n : rest;
}

// The level that a pixel has: its own, or that of a dead pixel, which is 0 or more.
float level_of(Response r, __global const float* drive, __global const float* stuck, int i) {
  const float level = r.is_halfway ? 0.5f : drive[i];
  return r.has_stuck && stuck[i] >= 0 ? stuck[i] : level;
}

// Cycles, amplitude and their slopes at a level; linear between the knots (PixelResponse).
float4 response_at(Response r, __global const float4* knots, float level) {
  if (r.knots == 0)
    return (float4)(r.cycles_per_level * level, r.has_amplitude && !r.is_complex ? r.amplitude_per_level * level : 1,
                    r.cycles_per_level, r.amplitude_per_level);
  const int k = (int)clamp(level, 0.0f, (float)(r.knots - 1));
  const float rest = clamp(level - k, 0.0f, 1.0f);
  const float4 knot = knots[k];
  return (float4)(knot.x + rest * knot.z, knot.y + rest * knot.w, knot.z, knot.w);
}

__kernel void respond(Response r, __global const float* drive, __global const float* modulus,
                      __global const float* stuck, __global const float* stuck_moduli, __global const float4* knots,
                      __global float* cycles, __global float* amplitudes) {
  const int i = get_global_id(0);
  if (i >= r.count) return;
  const float4 shown = response_at(r, knots, level_of(r, drive, stuck, i));
  cycles[i] = shown.x;
  if (!r.has_amplitude) return;
  const float mu = !r.is_complex ? 1
                                 : r.modulus_per_level *
                                       (r.has_stuck && stuck_moduli[i] >= 0 ? stuck_moduli[i] : modulus[i]);
  amplitudes[i] = shown.y * mu;
}

// to[j] = Σ_d taps[first + d + reach]·from[j + d·sign], or += that. sign −1: the adjoint.
__kernel void blur_columns(int nx, int ny, int reach, int first, int sign, int adds, __global const float* taps,
                           __global const float* from, __global float* to) {
  const int i = get_global_id(0), j = get_global_id(1);
  if (i >= nx) return;
  float sum = 0;
  for (int d = -reach; d <= reach; ++d)
    sum += taps[first + d + reach] * from[(size_t)wrapped(j + sign * d, ny) * nx + i];
  const size_t at = (size_t)j * nx + i;
  to[at] = adds ? to[at] + sum : sum;
}

float blurred_in_row(__global const float* row, __global const float* taps, int nx, int reach, int first, int sign,
                     int i) {
  float sum = 0;
  for (int d = -reach; d <= reach; ++d) sum += taps[first + d + reach] * row[wrapped(i + sign * d, nx)];
  return sum;
}

// The value of a cell, from the values of the pixels of its row.
float of_cell(Cell c, __global const float* values, __global const float* taps, int j, int i) {
  __global const float* const row = values + (size_t)j * c.nx;
  return c.reach < 0 ? row[i] : blurred_in_row(row, taps, c.nx, c.reach, c.first, 1, i);
}

float2 phasor(float cycles) {
  const float rest = 2 * (cycles - rint(cycles));
  return (float2)(cospi(rest), sinpi(rest));
}

float2 product(float2 a, float2 b) { return (float2)(a.x * b.x - a.y * b.y, a.x * b.y + a.y * b.x); }

// a·exp(iφ) − γ, times the static error.
__kernel void cell_light(Cell c, __global const float* cycles, __global const float* amplitudes,
                         __global const float* taps, __global const float2* static_errors, __global float2* to) {
  const int i = get_global_id(0), j = get_global_id(1);
  if (i >= c.nx) return;
  const size_t at = (size_t)j * c.nx + i;
  float2 v = phasor(of_cell(c, cycles, taps, j, i));
  if (c.has_amplitude) v *= of_cell(c, amplitudes, taps, j, i);
  v -= (float2)(c.gap_re, c.gap_im);
  to[at * c.n] = c.has_static ? product(v, static_errors[at]) : v;
}

// 2π·a·Im(q·u*) and Re(q·u*), u the light of amplitude 1 (turn_back).
__kernel void cell_slopes(Cell c, __global const float* cycles, __global const float* amplitudes,
                          __global const float* taps, __global const float2* static_errors, __global const float2* q,
                          __global float* of_cycles, __global float* of_amplitudes) {
  const int i = get_global_id(0), j = get_global_id(1);
  if (i >= c.nx) return;
  const size_t at = (size_t)j * c.nx + i;
  float2 u = phasor(of_cell(c, cycles, taps, j, i));
  if (c.has_static) u = product(u, static_errors[at]);
  const float2 g = q[at * c.n];
  const float a = c.has_amplitude ? of_cell(c, amplitudes, taps, j, i) : 1;
  of_cycles[at] = 6.28318531f * a * (g.y * u.x - g.x * u.y);
  if (c.has_amplitude) of_amplitudes[at] = g.x * u.x + g.y * u.y;
}

// The adjoint of the blur of a cell along its row: to[i] = Σ_d taps[first + d + reach]·from[i − d], or += that.
__kernel void blur_rows_back(Cell c, int adds, __global const float* taps, __global const float* from,
                             __global float* to) {
  const int i = get_global_id(0), j = get_global_id(1);
  if (i >= c.nx) return;
  const size_t at = (size_t)j * c.nx + i;
  const float sum = blurred_in_row(from + (size_t)j * c.nx, taps, c.nx, c.reach, c.first, -1, i);
  to[at] = adds ? to[at] + sum : sum;
}

__kernel void pattern_slopes(Response r, float factor, __global const float* drive, __global const float* modulus,
                             __global const float* stuck, __global const float4* knots,
                             __global const float* of_cycles, __global const float* of_amplitudes,
                             __global float* slope, __global float* slope_of_modulus) {
  const int i = get_global_id(0);
  if (i >= r.count || (r.has_stuck && stuck[i] >= 0)) return;
  const float4 shown = response_at(r, knots, level_of(r, drive, stuck, i));
  float sum = shown.z * of_cycles[i];
  if (r.has_amplitude) sum += (r.is_complex ? r.modulus_per_level * modulus[i] : 1) * shown.w * of_amplitudes[i];
  slope[i] += factor * sum;
  if (r.is_complex) slope_of_modulus[i] += factor * r.modulus_per_level * shown.y * of_amplitudes[i];
}

// u += the light of the gaps over whole pixels, even or as it is under static errors.
__kernel void add_gaps(int count, float re, float im, int has_field, __global const float2* field,
                       __global float2* u) {
  const int i = get_global_id(0);
  if (i < count) u[i] += has_field ? field[i] : (float2)(re, im);
}

// u *= the light on the panel, or its conjugate: a factor of the column times one of the row, or `samples`. `u` is row by
// row, or column by column.
__kernel void illuminate(int width, int height, int has_samples, int is_by_columns, int is_conjugate,
                         __global const float2* along_x, __global const float2* along_y,
                         __global const float2* samples, __global float2* u) {
  const int k = get_global_id(0);
  if (k >= width * height) return;
  const int i = is_by_columns ? k / height : k % width, j = is_by_columns ? k % height : k / width;
  float2 light = has_samples ? samples[(size_t)j * width + i] : product(along_x[i], along_y[j]);
  if (is_conjugate) light.y = -light.y;
  u[k] = product(u[k], light);
}

// to[n·k] = from[k], and 0 between them; and back.
__kernel void put_apart(int count, int n, __global const float2* from, __global float2* to) {
  const int k = get_global_id(0);
  if (k < count) to[k] = k % n == 0 ? from[k / n] : (float2)(0.0f);
}

__kernel void put_together(int count, int n, __global const float2* from, __global float2* to) {
  const int k = get_global_id(0);
  if (k < count) to[k] = from[(size_t)k * n];
}

__kernel void clear_samples(int count, __global float2* to) {
  const int k = get_global_id(0);
  if (k < count) to[k] = (float2)(0.0f);
}
