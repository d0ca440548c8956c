// A panel with its effects, pixel by pixel (device_panel.h), or some of its rows. The panel is taken as periodic by the
// blur. Empty buffers are told by numbers: their arguments are then any others. Work items are those of a column and a row.

typedef struct {
  int nx, knots;  // pixels of a row; knots of the calibration: 0 for none
  float cycles_per_level, amplitude_per_level, modulus_per_level;
  int has_amplitude, is_complex, has_stuck, is_halfway;
} Response;

// The expansion of the light over a pixel (pixel_expansion.h) has TERMS terms along each axis. Pairs (p, q) of them are in the
// order of q: all p < TERMS − q for q = 0, and so on.
typedef struct {
  int nx, ny, n;      // pixels, and samples per pixel and axis
  int reach, points;  // of the blur along x, −1 for none; of the expansion along each axis
  int has_amplitude, has_static;
  float gap_re, gap_im;
} Pixel;

int wrapped(int i, int n) {
  const int rest = i % n;
  return rest < 0 ? rest + n : rest;
}

// The level that a pixel has: its own, or that of a dead pixel, which is 0 or more.
float level_of(Response r, __global const float* drive, __global const float* stuck, size_t i) {
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
  if (get_global_id(0) >= r.nx) return;
  const size_t i = get_global_id(1) * r.nx + get_global_id(0);
  const float4 shown = response_at(r, knots, level_of(r, drive, stuck, i));
  cycles[i] = shown.x;
  if (!r.has_amplitude) return;
  const float mu =
      !r.is_complex ? 1 : r.modulus_per_level * (r.has_stuck && stuck_moduli[i] >= 0 ? stuck_moduli[i] : modulus[i]);
  amplitudes[i] = shown.y * mu;
}

// to[j] = Σ_d taps[first + d + reach]·from[j + halo + d·sign], or += that. sign −1: the adjoint. `from` has `rows` rows, the
// first `halo` of which are before those of `to`.
__kernel void blur_columns(int nx, int rows, int halo, int reach, int first, int sign, int adds,
                           __global const float* taps, __global const float* from, __global float* to) {
  const int i = get_global_id(0), j = get_global_id(1);
  if (i >= nx) return;
  float sum = 0;
  for (int d = -reach; d <= reach; ++d)
    sum += taps[first + d + reach] * from[(size_t)wrapped(j + halo + sign * d, rows) * nx + i];
  const size_t at = (size_t)j * nx + i;
  to[at] = adds ? to[at] + sum : sum;
}

float blurred_in_row(__global const float* row, __global const float* taps, int nx, int reach, int first, int sign,
                     int i) {
  float sum = 0;
  for (int d = -reach; d <= reach; ++d) sum += taps[first + d + reach] * row[wrapped(i + sign * d, nx)];
  return sum;
}

// The value at point cx, from the values of the pixels of its row.
float at_point(Pixel p, __global const float* values, __global const float* taps, int cx, int j, int i) {
  __global const float* const row = values + (size_t)j * p.nx;
  return p.reach < 0 ? row[i] : blurred_in_row(row, taps, p.nx, p.reach, cx * (2 * p.reach + 1), 1, i);
}

float2 phasor(float cycles) {
  const float rest = 2 * (cycles - rint(cycles));
  return (float2)(cospi(rest), sinpi(rest));
}

float2 product(float2 a, float2 b) { return (float2)(a.x * b.x - a.y * b.y, a.x * b.y + a.y * b.x); }

// Adds the light a·exp(iφ) of row cy of the points to the terms of all pixels: of each pair an array of (ny, nx). With the
// last row comes −γ, and all is multiplied by the static errors.
__kernel void add_terms(Pixel p, int cy, __global const float* cycles, __global const float* amplitudes,
                        __global const float* taps, __global const float* projections,
                        __global const float2* static_errors, __global float2* terms) {
  const int i = get_global_id(0), j = get_global_id(1);
  if (i >= p.nx) return;
  const size_t at = (size_t)j * p.nx + i, pixels = (size_t)p.nx * p.ny;
  float2 along_x[TERMS];
  for (int k = 0; k < TERMS; ++k) along_x[k] = (float2)(0.0f);
  for (int cx = 0; cx < p.points; ++cx) {
    float2 v = phasor(at_point(p, cycles, taps, cx, j, i));
    if (p.has_amplitude) v *= at_point(p, amplitudes, taps, cx, j, i);
    for (int k = 0; k < TERMS; ++k) along_x[k] += projections[k * p.points + cx] * v;
  }
  const int is_last = cy == p.points - 1;
  __global float2* to = terms + at;
  for (int q = 0; q < TERMS; ++q)
    for (int k = 0; k < TERMS - q; ++k, to += pixels) {
      float2 sum = projections[q * p.points + cy] * along_x[k];
      if (cy > 0) sum += *to;
      if (is_last && q == 0 && k == 0) sum -= (float2)(p.gap_re, p.gap_im);
      *to = is_last && p.has_static ? product(sum, static_errors[at]) : sum;
    }
}

// A term of all pixels, to[n·k] = its value of pixel k; and back, with the conjugate static errors, for gradients.
__kernel void take_term(int nx, int ny, int n, int pair, __global const float2* terms, __global float2* to) {
  if (get_global_id(0) >= nx) return;
  const size_t k = get_global_id(1) * nx + get_global_id(0);
  to[k * n] = terms[(size_t)nx * ny * pair + k];
}

__kernel void put_term(int nx, int ny, int n, int pair, int has_static, __global const float2* static_errors,
                       __global const float2* from, __global float2* terms) {
  if (get_global_id(0) >= nx) return;
  const size_t k = get_global_id(1) * nx + get_global_id(0);
  const float2 value = from[k * n];
  terms[(size_t)nx * ny * pair + k] =
      has_static ? product(value, (float2)(static_errors[k].x, -static_errors[k].y)) : value;
}

// 2π·a·Im(q·u*) and Re(q·u*), u the light of amplitude 1 at point (cx, cy) and q the slope by it (turn_back).
__kernel void point_slopes(Pixel p, int cx, int cy, __global const float* cycles, __global const float* amplitudes,
                           __global const float* taps, __global const float* projections, __global const float2* terms,
                           __global float* of_cycles, __global float* of_amplitudes) {
  const int i = get_global_id(0), j = get_global_id(1);
  if (i >= p.nx) return;
  const size_t at = (size_t)j * p.nx + i, pixels = (size_t)p.nx * p.ny;
  const float2 u = phasor(at_point(p, cycles, taps, cx, j, i));
  __global const float2* from = terms + at;
  float2 g = (float2)(0.0f);
  for (int q = 0; q < TERMS; ++q)
    for (int k = 0; k < TERMS - q; ++k, from += pixels)
      g += projections[q * p.points + cy] * projections[k * p.points + cx] * *from;
  const float a = p.has_amplitude ? at_point(p, amplitudes, taps, cx, j, i) : 1;
  of_cycles[at] = 6.28318531f * a * (g.y * u.x - g.x * u.y);
  if (p.has_amplitude) of_amplitudes[at] = g.x * u.x + g.y * u.y;
}

// The adjoint of the blur along a row to point cx: to[i] = Σ_d taps[first + d + reach]·from[i − d], or += that.
__kernel void blur_rows_back(Pixel p, int cx, __global const float* taps, __global const float* from,
                             __global float* to) {
  const int i = get_global_id(0), j = get_global_id(1);
  if (i >= p.nx) return;
  const size_t at = (size_t)j * p.nx + i;
  const int first = cx * (2 * p.reach + 1);
  const float sum = blurred_in_row(from + (size_t)j * p.nx, taps, p.nx, p.reach, first, -1, i);
  to[at] = cx > 0 ? to[at] + sum : sum;
}

__kernel void pattern_slopes(Response r, float factor, __global const float* drive, __global const float* modulus,
                             __global const float* stuck, __global const float4* knots, __global const float* of_cycles,
                             __global const float* of_amplitudes, __global float* slope,
                             __global float* slope_of_modulus) {
  if (get_global_id(0) >= r.nx) return;
  const size_t i = get_global_id(1) * r.nx + get_global_id(0);
  if (r.has_stuck && stuck[i] >= 0) return;
  const float4 shown = response_at(r, knots, level_of(r, drive, stuck, i));
  float sum = shown.z * of_cycles[i];
  if (r.has_amplitude) sum += (r.is_complex ? r.modulus_per_level * modulus[i] : 1) * shown.w * of_amplitudes[i];
  slope[i] += factor * sum;
  if (r.is_complex) slope_of_modulus[i] += factor * r.modulus_per_level * shown.y * of_amplitudes[i];
}

// u += the light of the gaps over whole pixels, even or as it is under static errors.
__kernel void add_gaps(int width, float re, float im, int has_field, __global const float2* field, __global float2* u) {
  if (get_global_id(0) >= width) return;
  const size_t k = get_global_id(1) * width + get_global_id(0);
  u[k] += has_field ? field[k] : (float2)(re, im);
}

// u *= the light on the panel, or its conjugate: a factor of the column times one of the row, or `samples`. `u` has `height`
// lines of `width` samples: rows, from column `first` of the panel on; or columns. `samples` are row by row in both cases.
__kernel void illuminate(int width, int height, int first, int has_samples, int is_by_columns, int is_conjugate,
                         __global const float2* along_x, __global const float2* along_y, __global const float2* samples,
                         __global float2* u) {
  if (get_global_id(0) >= width) return;
  const size_t along = get_global_id(0), across = get_global_id(1), k = across * width + along;
  const size_t i = is_by_columns ? across : along, j = is_by_columns ? along : across;
  float2 light = has_samples ? samples[is_by_columns ? j * height + i : k] : product(along_x[first + i], along_y[j]);
  if (is_conjugate) light.y = -light.y;
  u[k] = product(u[k], light);
}

// Of lines that lie one after the other: to[n·k] = from[k], and 0 between them; and back. `count` is the length of the lines
// of `to`.
__kernel void put_apart(int count, int n, __global const float2* from, __global float2* to) {
  const int k = get_global_id(0);
  if (k >= count) return;
  to[get_global_id(1) * count + k] = k % n == 0 ? from[get_global_id(1) * (count / n) + k / n] : (float2)(0.0f);
}

__kernel void put_together(int count, int n, __global const float2* from, __global float2* to) {
  const int k = get_global_id(0);
  if (k < count) to[get_global_id(1) * count + k] = from[(get_global_id(1) * count + k) * n];
}

__kernel void clear_samples(int width, __global float2* to) {
  if (get_global_id(0) < width) to[get_global_id(1) * width + get_global_id(0)] = (float2)(0.0f);
}
