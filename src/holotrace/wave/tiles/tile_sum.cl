// Sum of waves in tiles of the panel: each group of work items computes one tile, each item a block of it.
//
// A tile is a complex matrix product, samples[row][column] = Σⱼ rowⱼ·columnⱼ. A complex product (a + ib)(c + id) takes
// three real ones, ac, bd and (a + b)(c + d), whose sums are kept apart up to the end. Waves that light the tile are
// gathered GROUP at a time; the items compute their factors into local memory, BATCH waves at a time, and multiply them.
//
// Compiled with TILE_COLUMNS, TILE_ROWS, BLOCK_ROWS, BATCH. An item computes BLOCK_COLUMNS × BLOCK_ROWS samples.

#define BLOCK_COLUMNS 4
#define GROUP_COLUMNS (TILE_COLUMNS / BLOCK_COLUMNS)
#define GROUP_ROWS (TILE_ROWS / BLOCK_ROWS)
#define GROUP (GROUP_COLUMNS * GROUP_ROWS)

// The waves [first, end) and the tiles of a band: its size [samples], and the first of its rows on the panel. Each slice
// sums `share` of the waves, to samples of its own: a panel of few tiles keeps a large device busy.
typedef struct {
  int first, end, share;
  int columns, rows, top;
  int is_first;  // the samples are new; otherwise the sum is added to them
  float pitch;   // [wavelengths]
} TileJob;

// The three numbers of a factor, 0 outside [low, high).
void store_factor(__local float* to, int step, TileFactor f, int at, int low, int high) {
  const int is_lit = at >= low && at < high;
  const float re = is_lit ? f.re : 0.0f, im = is_lit ? f.im : 0.0f;
  to[0] = re;
  to[step] = im;
  to[2 * step] = re + im;
}

__kernel __attribute__((reqd_work_group_size(GROUP_COLUMNS, GROUP_ROWS, 1))) void sum_tiles(
    __global const DeviceWave* waves, __global const FloatPair* column_centres, __global const FloatPair* row_centres,
    TileJob job, __global float2* samples) {
  // Aligned: an item loads its columns and rows four at a time.
  __local float columns[3 * BATCH * TILE_COLUMNS] __attribute__((aligned(16)));
  __local float rows[3 * BATCH * TILE_ROWS] __attribute__((aligned(16)));
  __local TileWave lit[GROUP];
  __local int4 edges[GROUP];
  __local int is_lit[GROUP];

  const int item_column = get_local_id(0), item_row = get_local_id(1);
  const int item = item_row * GROUP_COLUMNS + item_column;
  const int row_of_tiles = get_global_id(1) / GROUP_ROWS;
  const int tile_x = get_group_id(0) * TILE_COLUMNS, tile_y = row_of_tiles * TILE_ROWS;  // in the band
  const FloatPair centre_x = column_centres[get_group_id(0)], centre_y = row_centres[row_of_tiles];

  float4 ac[BLOCK_ROWS], bd[BLOCK_ROWS], all[BLOCK_ROWS];
#pragma unroll
  for (int r = 0; r < BLOCK_ROWS; ++r) ac[r] = bd[r] = all[r] = (float4)(0.0f);

  const int slice = get_global_id(2), slice_first = job.first + slice * job.share;
  const int slice_end = min(slice_first + job.share, job.end);
  for (int start = slice_first; start < slice_end; start += GROUP) {
    // The waves that light the tile, in their order.
    DeviceWave wave = waves[min(start + item, slice_end - 1)];
    const int4 edge =
        (int4)(wave.x0 - tile_x, wave.x1 - tile_x, wave.y0 - job.top - tile_y, wave.y1 - job.top - tile_y);
    const int meets =
        start + item < slice_end && edge.x < TILE_COLUMNS && edge.y > 0 && edge.z < TILE_ROWS && edge.w > 0;
    is_lit[item] = meets;
    barrier(CLK_LOCAL_MEM_FENCE);
    int before = 0, count = 0;
    for (int i = 0; i < GROUP; ++i) {
      before += i < item ? is_lit[i] : 0;
      count += is_lit[i];
    }
    if (meets) {
      lit[before] = wave_from_tile(wave, centre_x, centre_y);
      edges[before] = edge;
    }
    barrier(CLK_LOCAL_MEM_FENCE);

    for (int first = 0; first < count; first += BATCH) {
      const int batch = min(BATCH, count - first);
      for (int i = item; i < batch * TILE_COLUMNS; i += GROUP) {
        const int k = i / TILE_COLUMNS, column = i % TILE_COLUMNS;
        const float u = (column - 0.5f * (TILE_COLUMNS - 1)) * job.pitch;
        store_factor(columns + i, BATCH * TILE_COLUMNS, column_factor(lit[first + k], u), column, edges[first + k].x,
                     edges[first + k].y);
      }
      for (int i = item; i < batch * TILE_ROWS; i += GROUP) {
        const int k = i / TILE_ROWS, row = i % TILE_ROWS;
        const float v = (0.5f * (TILE_ROWS - 1) - row) * job.pitch;
        store_factor(rows + i, BATCH * TILE_ROWS, row_factor(lit[first + k], v), row, edges[first + k].z,
                     edges[first + k].w);
      }
      barrier(CLK_LOCAL_MEM_FENCE);

      for (int k = 0; k < batch; ++k) {
        const int column = k * TILE_COLUMNS + item_column * BLOCK_COLUMNS, row = k * TILE_ROWS + item_row * BLOCK_ROWS;
        const float4 c = *(__local const float4*)(columns + column);
        const float4 d = *(__local const float4*)(columns + BATCH * TILE_COLUMNS + column);
        const float4 sum = *(__local const float4*)(columns + 2 * BATCH * TILE_COLUMNS + column);
#pragma unroll
        for (int r = 0; r < BLOCK_ROWS; ++r) {
          ac[r] = MULTIPLY_ADD((float4)(rows[row + r]), c, ac[r]);
          bd[r] = MULTIPLY_ADD((float4)(rows[BATCH * TILE_ROWS + row + r]), d, bd[r]);
          all[r] = MULTIPLY_ADD((float4)(rows[2 * BATCH * TILE_ROWS + row + r]), sum, all[r]);
        }
      }
      barrier(CLK_LOCAL_MEM_FENCE);
    }
  }

#pragma unroll
  for (int r = 0; r < BLOCK_ROWS; ++r) {
    const int row = tile_y + item_row * BLOCK_ROWS + r, column = tile_x + item_column * BLOCK_COLUMNS;
    if (row >= job.rows) continue;
    const float4 re = ac[r] - bd[r], im = all[r] - ac[r] - bd[r];
    const float2 block[BLOCK_COLUMNS] = {(float2)(re.x, im.x), (float2)(re.y, im.y), (float2)(re.z, im.z),
                                         (float2)(re.w, im.w)};
    __global float2* const to = samples + ((size_t)slice * job.rows + row) * job.columns + column;
#pragma unroll
    for (int c = 0; c < BLOCK_COLUMNS; ++c)
      if (column + c < job.columns) to[c] = job.is_first ? block[c] : to[c] + block[c];
  }
}

// Adds the samples of all slices to those of the first. Items of the second axis are rows.
__kernel void add_slices(__global float2* samples, int columns, int rows, int slices) {
  const int column = get_global_id(0);
  if (column >= columns) return;
  const size_t count = (size_t)columns * rows, i = get_global_id(1) * (size_t)columns + column;
  float2 sum = samples[i];
  for (int s = 1; s < slices; ++s) sum += samples[s * count + i];
  samples[i] = sum;
}

// For tests: the value of each wave at the offset (u, v) from a tile centred at (x, y) [wavelengths], as the two factors
// give it.
__kernel void multiply_factors(__global const DeviceWave* waves, __global const FloatPair* x,
                               __global const FloatPair* y, __global const float2* offsets, __global float2* values) {
  const size_t i = get_global_id(0);
  const TileWave t = wave_from_tile(waves[i], x[i], y[i]);
  const TileFactor a = column_factor(t, offsets[i].x), b = row_factor(t, offsets[i].y);
  values[i] = (float2)(a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re);
}
