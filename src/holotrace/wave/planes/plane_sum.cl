// Waves in tiles of the panel by a non-uniform FFT (summation.h): spread_waves adds them to the grids of a tile's nodes,
// line_transform.cl transforms the grids, and add_nodes adds the nodes' light to the samples of a band.
//
// Waves come in packets of neighbours. A group of items owns a block of a tile's cells at all nodes; an item owns a row of
// 4 of them. The group skips packets that cannot reach its block, and adds up the waves of the others in their order.
// So no two groups write to the same cell, and the sum does not depend on how waves or tiles are sent.
//
// Compiled with NODES, after tile_factor_kernel.h, plane_wave_kernel.h and plane_correction_kernel.h.

#define BLOCK 16
#define ROW 4  // cells of an item
#define GROUP (BLOCK * BLOCK / ROW)
#define MOST_WIDTH 8
#define DEGREE 11
#define PADDED (MOST_WIDTH + 2 * ROW)  // weights along x, with zeros before and after them
#define TRANSPOSED 16

// Waves [first, end) that are neighbours: the box of their origins [wavelengths], and of the tiles that they light.
typedef struct {
  float x0, x1, y0, y1, depth0, depth1;
  int first, end;
  int tiles_x0, tiles_x1, tiles_y0, tiles_y1;
} PlanePacket;

// The tiles of a launch are first_tile, first_tile + 1, …, counted along rows of tiles.
typedef struct {
  int first_packet, end_packet, first_wave;  // first_wave: of those on the device
  int first_tile, tiles_across;
  int cells, middle, width;
  int is_first;  // the grids are new; otherwise waves are added to them
  PlaneSlab slab;
} SpreadJob;

// Range of x/r over origins in a box, r² = x² + rest: it grows with x, and its modulus falls with the rest.
float2 sines(float x0, float x1, float least_rest, float greatest_rest) {
  const float low = x0 * rsqrt(fma(x0, x0, x0 < 0 ? least_rest : greatest_rest));
  const float high = x1 * rsqrt(fma(x1, x1, x1 < 0 ? greatest_rest : least_rest));
  return (float2)(low, high);
}

float least_square(float a, float b) { return a <= 0 && b >= 0 ? 0 : fmin(a * a, b * b); }

// Whether waves with these sines may be spread over cells of the block that starts there.
int meets_block(float2 sine, const SpreadJob* job, float shrunk, int start) {
  const float reach = 0.5f * job->width + 1;  // and a cell for rounding
  const float low = job->middle + job->slab.cells * sine.x * (sine.x > 0 ? shrunk : 1) - reach;
  const float high = job->middle + job->slab.cells * sine.y * (sine.y < 0 ? shrunk : 1) + reach;
  return high >= start && low < start + BLOCK;
}

int packet_meets(PlanePacket p, const SpreadJob* job, int2 tile, float x, float y, int2 block) {
  if (tile.x < p.tiles_x0 || tile.x >= p.tiles_x1 || tile.y < p.tiles_y0 || tile.y >= p.tiles_y1) return 0;
  const float x0 = x - p.x1, x1 = x - p.x0, y0 = p.y0 - y, y1 = p.y1 - y;  // y down
  const float near = p.depth0 * p.depth0, far = p.depth1 * p.depth1;
  const float shrunk = fmax(1 - job->slab.cubic / near, 0.0f);  // the least 1 − c·h²/2r₀²
  const float2 across = sines(x0, x1, least_square(y0, y1) + near, fmax(y0 * y0, y1 * y1) + far);
  const float2 down = sines(y0, y1, least_square(x0, x1) + near, fmax(x0 * x0, x1 * x1) + far);
  return meets_block(across, job, shrunk, block.x) && meets_block(down, job, shrunk, block.y);
}

// Numbers the items with a flag, in their order; returns how many there are.
int number_flags(__local int* flags, int flag, int item, int* before) {
  flags[item] = flag;
  barrier(CLK_LOCAL_MEM_FENCE);
  int count = 0;
  *before = 0;
  for (int i = 0; i < GROUP; ++i) {
    *before += i < item ? flags[i] : 0;
    count += flags[i];
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  return count;
}

// Weight of cell l: a polynomial in the fraction. coefficients[power][cell].
float cell_weight(__global const float* coefficients, int l, float fraction) {
  float weight = coefficients[DEGREE * MOST_WIDTH + l];
  for (int k = DEGREE - 1; k >= 0; --k) weight = fma(weight, fraction, coefficients[k * MOST_WIDTH + l]);
  return weight;
}

__kernel __attribute__((reqd_work_group_size(GROUP, 1, 1))) void spread_waves(
    SpreadJob job, __global const DeviceWave* waves, __global const PlanePacket* packets,
    __global const float* coefficients, __global const FloatPair* column_references,
    __global const FloatPair* row_references, __global float2* grids) {
  __local int flags[GROUP], chosen[GROUP];
  __local int2 first[GROUP];
  __local float2 fractions[GROUP], values[GROUP * NODES];
  __local float x_weights[GROUP * PADDED], y_weights[GROUP * MOST_WIDTH];

  const int item = get_local_id(0), blocks = (job.cells + BLOCK - 1) / BLOCK;
  const int tile_index = job.first_tile + get_global_id(1);
  const int2 tile = (int2)(tile_index % job.tiles_across, tile_index / job.tiles_across);
  const int2 block = (int2)(get_group_id(0) % blocks, get_group_id(0) / blocks) * BLOCK;
  const FloatPair x = column_references[tile.x], y = row_references[tile.y];
  const int column = block.x + item % (BLOCK / ROW) * ROW, row = block.y + item / (BLOCK / ROW);
  const size_t node = (size_t)job.cells * job.cells;
  __global float2* const cells = grids + get_global_id(1) * NODES * node + (size_t)row * job.cells + column;

  float4 re[NODES], im[NODES];
#pragma unroll
  for (int q = 0; q < NODES; ++q) {
    float2 old[ROW];
#pragma unroll
    for (int c = 0; c < ROW; ++c)
      old[c] = !job.is_first && row < job.cells && column + c < job.cells ? cells[q * node + c] : (float2)(0.0f);
    re[q] = (float4)(old[0].x, old[1].x, old[2].x, old[3].x);
    im[q] = (float4)(old[0].y, old[1].y, old[2].y, old[3].y);
  }
  for (int i = item; i < GROUP * PADDED; i += GROUP) x_weights[i] = 0;

  for (int start = job.first_packet; start < job.end_packet; start += GROUP) {
    const int p = min(start + item, job.end_packet - 1);
    const int may_meet =
        start + item < job.end_packet && packet_meets(packets[p], &job, tile, x.high, y.high, block);
    int place;
    const int packets_here = number_flags(flags, may_meet, item, &place);
    if (may_meet) chosen[place] = p;
    barrier(CLK_LOCAL_MEM_FENCE);

    for (int i = 0; i < packets_here; ++i) {
      const int wave_first = packets[chosen[i]].first, wave_end = packets[chosen[i]].end;
      // The waves of the packet that light the whole tile and are spread over cells of the block, in their order.
      const DeviceWave wave = waves[min(wave_first + item, wave_end - 1) - job.first_wave];
      const PlaneWave plane = plane_wave(wave_from_tile(wave, x, y), job.slab);
      const PlaneCells across = plane_cells(plane.x, job.width, job.middle);
      const PlaneCells down = plane_cells(plane.y, job.width, job.middle);
      const int meets = wave_first + item < wave_end && tile.x >= wave.x0 && tile.x < wave.x1 && tile.y >= wave.y0 &&
                        tile.y < wave.y1 && across.first < block.x + BLOCK && across.first + job.width > block.x &&
                        down.first < block.y + BLOCK && down.first + job.width > block.y;
      int k;
      const int count = number_flags(flags, meets, item, &k);
      if (meets) {
        first[k] = (int2)(across.first, down.first);
        fractions[k] = (float2)(across.fraction, down.fraction);
        for (int q = 0; q < NODES; ++q)
          values[k * NODES + q] = (float2)(plane.value.re, plane.value.im) * node_weight(job.slab, NODES, q, plane.tau);
      }
      barrier(CLK_LOCAL_MEM_FENCE);
      for (int j = item; j < count * MOST_WIDTH; j += GROUP) {
        const int wave_here = j / MOST_WIDTH, l = j % MOST_WIDTH;
        x_weights[wave_here * PADDED + ROW + l] = cell_weight(coefficients, l, fractions[wave_here].x);
        y_weights[j] = cell_weight(coefficients, l, fractions[wave_here].y);
      }
      barrier(CLK_LOCAL_MEM_FENCE);

      for (int j = 0; j < count; ++j) {
        const int to_right = column - first[j].x, to_lower = row - first[j].y;
        if (to_lower < 0 || to_lower >= job.width || to_right <= -ROW || to_right >= job.width) continue;
        const float4 weights =
            y_weights[j * MOST_WIDTH + to_lower] * vload4(0, x_weights + j * PADDED + ROW + to_right);
#pragma unroll
        for (int q = 0; q < NODES; ++q) {
          re[q] = MULTIPLY_ADD(weights, (float4)(values[j * NODES + q].x), re[q]);
          im[q] = MULTIPLY_ADD(weights, (float4)(values[j * NODES + q].y), im[q]);
        }
      }
      barrier(CLK_LOCAL_MEM_FENCE);
    }
  }

  if (row >= job.cells) return;
#pragma unroll
  for (int q = 0; q < NODES; ++q) {
    const float2 sums[ROW] = {(float2)(re[q].x, im[q].x), (float2)(re[q].y, im[q].y), (float2)(re[q].z, im[q].z),
                              (float2)(re[q].w, im[q].w)};
#pragma unroll
    for (int c = 0; c < ROW; ++c)
      if (column + c < job.cells) cells[q * node + c] = sums[c];
  }
}

// A band of samples: its size, and the first of its rows on the panel.
typedef struct {
  int slab, first_tile, tiles_across, tile;  // tile: side
  int columns, rows, top;
  int is_corrected;
  float pitch;  // [m]
} AddJob;

// Adds the light of a slab's nodes. The terms are [tile][node][column][row]; chirps[slab][node][pixel] are the curvatures,
// over φ̂; moments[pixel] those of the gridding kernel.
__kernel __attribute__((reqd_work_group_size(TRANSPOSED, TRANSPOSED, 1))) void add_nodes(
    AddJob job, __global const struct Correction* corrections, __global const float2* chirps,
    __global const float2* moments, __global const float2* wave, __global const float2* f, __global const float2* g,
    __global const float2* cross, __global const float2* difference, __global float2* samples) {
  __local float2 turned[TRANSPOSED][TRANSPOSED + 1];
  const int x = get_local_id(0), y = get_local_id(1), side = job.tile, left = get_group_id(0) * TRANSPOSED,
            top = get_global_id(1) - y;
  const int i = left + y, j = top + x;  // column and row: along the rows, neighbours are in memory
  float2 light = (float2)(0.0f);
  if (i < side && j < side) {
    const float u = (i - side / 2) * job.pitch, v = (j - side / 2) * job.pitch;
    for (int q = 0; q < NODES; ++q) {
      const size_t at = (((size_t)get_global_id(2) * NODES + q) * side + i) * side + j;
      const int node = job.slab * NODES + q;
      float2 sum = wave[at];
      if (job.is_corrected) {
        const struct CorrectionTerms of_cells = {f[at], g[at], cross[at], difference[at]};
        const struct CorrectionTerms terms =
            terms_of_waves(of_cells, sum, moments[i].x, moments[j].x, moments[i].y, moments[j].y);
        sum += correction_at(corrections[node], terms, u, v);
      }
      light += product(product(chirps[node * side + i], chirps[node * side + j]), sum);
    }
  }
  turned[y][x] = light;
  barrier(CLK_LOCAL_MEM_FENCE);
  const int tile_index = job.first_tile + get_global_id(2);
  const int in_x = left + x, in_y = top + y;
  const int column = tile_index % job.tiles_across * side + in_x;
  const int row = tile_index / job.tiles_across * side + in_y - job.top;
  if (in_x >= side || in_y >= side || column >= job.columns || row < 0 || row >= job.rows) return;
  samples[(size_t)row * job.columns + column] += turned[x][y];
}
