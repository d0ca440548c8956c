// Pictures that pupils take, and their adjoint (frames_light.h, take_picture). A transform of length × length samples is
// around the pupil's centre: place 0 is the sample nearest to it, and the last places are before it.

typedef struct {
  int length, first_x, first_y, columns;  // the sample of the window at place 0, and the columns of the window
  float scale;
} PupilJob;

int offset_of(int place, int length) { return place < (length + 1) / 2 ? place : place - length; }

int place_of(int offset, int length) {
  const int rest = offset % length;
  return rest < 0 ? rest + length : rest;
}

float2 product(float2 a, float2 b) { return (float2)(a.x * b.x - a.y * b.y, a.x * b.y + a.y * b.x); }

// Whether a place is in the pupil, whose columns of the window are span.x … span.y − 1 in this row.
int is_inside(int2 span, int column) { return column >= span.x && column < span.y; }

// wide = the light in the pupil times its factors, and 0 beside it.
__kernel void enter_pupil(PupilJob p, __global const int2* spans, __global const float2* along_x,
                          __global const float2* along_y, __global const float2* eye, __global float2* wide) {
  const int x = get_global_id(0), y = get_global_id(1);
  if (x >= p.length) return;
  const int column = p.first_x + offset_of(x, p.length), row = p.first_y + offset_of(y, p.length);
  float2 value = (float2)(0.0f);
  if (is_inside(spans[y], column))
    value = p.scale * product(product(along_x[x], along_y[y]), eye[(size_t)row * p.columns + column]);
  wide[(size_t)y * p.length + x] = value;
}

// eye += what comes back to the pupil, times the conjugate factors.
__kernel void leave_pupil(PupilJob p, __global const int2* spans, __global const float2* along_x,
                          __global const float2* along_y, __global const float2* wide, __global float2* eye) {
  const int x = get_global_id(0), y = get_global_id(1);
  if (x >= p.length) return;
  const int column = p.first_x + offset_of(x, p.length), row = p.first_y + offset_of(y, p.length);
  if (!is_inside(spans[y], column)) return;
  const float2 factor = product(along_x[x], along_y[y]);
  eye[(size_t)row * p.columns + column] +=
      p.scale * product((float2)(factor.x, -factor.y), wide[(size_t)y * p.length + x]);
}

// The samples of a picture from a transform that is stored column by column; both repeat after `length` samples.
__kernel void take_picture(int length, int nx, int ny, __global const float2* transform, __global float2* picture) {
  const int i = get_global_id(0), j = get_global_id(1);
  if (i < nx)
    picture[(size_t)j * nx + i] =
        transform[(size_t)place_of(i - nx / 2, length) * length + place_of(j - ny / 2, length)];
}

// The adjoint: picture · factor at its places, added up, and 0 beside it.
__kernel void put_picture(int length, int nx, int ny, __global const float2* picture, __global const float* factor,
                          __global float2* transform) {
  const int y = get_global_id(0), x = get_global_id(1);
  if (y >= length) return;
  float2 sum = (float2)(0.0f);
  for (int j = place_of(y + ny / 2, length); j < ny; j += length)
    for (int i = place_of(x + nx / 2, length); i < nx; i += length) {
      const size_t at = (size_t)j * nx + i;
      sum += factor[at] * picture[at];
    }
  transform[(size_t)x * length + y] = sum;
}
