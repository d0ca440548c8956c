#include "holotrace/view/register/register.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "holotrace/base/error.h"
#include "holotrace/base/threads.h"
#include "holotrace/base/units.h"
#include "holotrace/data/params/parameter.h"
#include "holotrace/view/register/channel.h"
#include "holotrace/view/register/similarity_search.h"

namespace holotrace {
namespace {

constexpr double search_side = 48;        // side of the larger picture in the search [pixels]
constexpr double search_step = 0.11;      // angle [rad] and ln(scale): 1.9 pixels at half a step, at a corner
constexpr double shading_part = 1 / 12.;  // of the picture's long side: slower changes are shading
constexpr double blur = 0.8;              // σ in pixels, see reduced
constexpr double least_overlap = 0.3;     // fraction of the smaller picture
constexpr size_t most_candidates = 12, most_finalists = 3;
constexpr double finer = 1.5;  // ratio from one resolution to the next
// Standard error over the photograph's side, for the best map: 0.6 to 5 % for unrelated pictures; up to 0.3 % for
// related ones under strong speckle, below 0.1 % for other related ones.
constexpr double most_error_part = 0.004;

// Both pictures at one resolution, if `fixed` is shown `scale` times as large: pixels of pixel_fixed in `fixed` and of
// scale·pixel_fixed in `moving`.
struct Pair {
  Channel moving, fixed;
  double pixel_moving, pixel_fixed;

  Similarity to_reduced(const Similarity& s) const {
    const double k = pixel_fixed / pixel_moving;
    return {s.a * k, s.b * k, s.x / pixel_moving, s.y / pixel_moving};
  }
  Similarity from_reduced(const Similarity& s) const {
    const double k = pixel_moving / pixel_fixed;
    return {s.a * k, s.b * k, s.x * pixel_moving, s.y * pixel_moving};
  }
};

double long_side(const Channel& channel) { return std::max(channel.nx, channel.ny); }
double scale_of(const Similarity& s) { return std::hypot(s.a, s.b); }

Pair at_resolution(const Channel& moving, const Channel& fixed, double scale, double pixel_fixed) {
  const double pixel_moving = pixel_fixed * scale;
  return {reduced(moving, pixel_moving, blur), reduced(fixed, pixel_fixed, blur), pixel_moving, pixel_fixed};
}

// Extent of what counts as shading, in pixels of `fixed`, if `fixed` is shown `scale` times as large.
double shading_extent(const Channel& moving, const Channel& fixed, double scale) {
  return shading_part * std::max(long_side(moving) / scale, long_side(fixed));
}

// The pictures to compare: amplitudes without shading. With amplitudes, speckle, whose spread grows with the light,
// does not dominate in bright places.
Pair structure_of(Pair pair, double extent) {
  for (Channel* channel : {&pair.moving, &pair.fixed}) {
    for (float& value : channel->values) value = std::sqrt(std::max(0.0F, value));
    *channel = without_shading(*channel, extent / pair.pixel_fixed);
  }
  return pair;
}

struct Candidate {
  Similarity map;  // in the pictures' own pixels
  double score = 0, pixel_fixed = 0;
  size_t scale_step = 0, angle_step = 0, angles = 1;

  bool is_near(const Candidate& other) const {
    const size_t away = angle_step > other.angle_step ? angle_step - other.angle_step : other.angle_step - angle_step;
    return std::max(scale_step, other.scale_step) - std::min(scale_step, other.scale_step) <= 1 &&
           std::min(away, angles - away) <= 1;
  }
};

// Whether two maps differ by less than a tenth of the picture at every corner, so that they lead to one solution.
bool are_alike(const Similarity& p, const Similarity& q, const Channel& fixed) {
  const double radius = std::hypot(fixed.nx, fixed.ny) / 2;
  return std::hypot(p.a - q.a, p.b - q.b) * radius + std::hypot(p.x - q.x, p.y - q.y) <
         0.2 * radius * std::max(scale_of(p), scale_of(q));
}

// The best maps that differ by more than a step, each refined at the resolution of the search.
std::vector<Candidate> search(const Channel& moving, const Channel& fixed, double smallest, double largest,
                              const Observer& observer) {
  const size_t steps = 1 + size_t(std::ceil(std::log(largest / smallest) / search_step));
  std::vector<Candidate> all;
  std::vector<Pair> pairs;
  for (size_t n = 0; n < steps; ++n) {
    const double scale = steps == 1 ? smallest : smallest * std::pow(largest / smallest, double(n) / double(steps - 1));
    const double pixel_fixed =
        std::max({long_side(moving) / scale / search_side, long_side(fixed) / search_side, 1 / scale, 1.0});
    pairs.push_back(
        structure_of(at_resolution(moving, fixed, scale, pixel_fixed), shading_extent(moving, fixed, scale)));
    const Pair& pair = pairs.back();
    const auto matches = coarse_search(pair.moving, pair.fixed, search_step, least_overlap);
    for (size_t k = 0; k < matches.size(); ++k)
      if (matches[k].score > 0) all.push_back({matches[k].map, matches[k].score, pixel_fixed, n, k, matches.size()});
    observer.progress(0.8 * double(n + 1) / double(steps));
  }
  std::stable_sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.score > b.score; });
  std::vector<Candidate> best;
  for (const Candidate& c : all) {
    if (best.size() == most_candidates) break;
    if (std::none_of(best.begin(), best.end(), [&](const auto& b) { return b.is_near(c); })) best.push_back(c);
  }
  for (Candidate& c : best) {
    const Pair& pair = pairs[c.scale_step];
    const Fit fit = refine(pair.moving, pair.fixed, c.map, 15);
    c.map = pair.from_reduced(fit.map);
    const double change = scale_of(fit.map);
    c.score = change > 0.8 && change < 1.25 ? fit.score() : 0;  // a larger change than one step means divergence
  }
  std::stable_sort(best.begin(), best.end(), [](const auto& a, const auto& b) { return a.score > b.score; });
  std::vector<Candidate> distinct;
  for (const Candidate& c : best)
    if (c.score > 0 &&
        std::none_of(distinct.begin(), distinct.end(), [&](const auto& d) { return are_alike(c.map, d.map, fixed); }))
      distinct.push_back(c);
  return distinct;
}

// Both pictures at one resolution, and the map fitted to them.
struct Laid {
  Pair pair;
  Fit fit;
  Similarity map;  // in the pictures' own pixels
  bool is_finest = false;

  double error() const { return fit.uncertainty * pair.pixel_moving; }
};

// Fits the pictures in pixels of pixel_fixed, or in pixels of the coarser picture if these are larger.
Laid lay(const Channel& moving, const Channel& fixed, const Similarity& start, double pixel_fixed) {
  const double scale = scale_of(start), finest = std::max(1.0, 1 / scale);
  Laid laid;
  laid.is_finest = pixel_fixed <= finest;
  laid.pair = structure_of(at_resolution(moving, fixed, scale, std::max(finest, pixel_fixed)),
                           shading_extent(moving, fixed, scale));
  laid.fit = refine(laid.pair.moving, laid.pair.fixed, laid.pair.to_reduced(start), 40);
  laid.map = laid.pair.from_reduced(laid.fit.map);
  return laid;
}

// Goes from the resolution of the search to the finest, and returns the one of the least standard error: the finest has
// the most structure, but also the most noise.
Laid refine_best(const Channel& moving, const Channel& fixed, const std::vector<Candidate>& candidates) {
  Laid laid;
  double pixel_fixed = 0;
  for (size_t n = 0; n < std::min(candidates.size(), most_finalists); ++n) {
    Laid next = lay(moving, fixed, candidates[n].map, candidates[n].pixel_fixed / finer);
    if (n > 0 && next.fit.score() <= laid.fit.score()) continue;
    laid = std::move(next);
    pixel_fixed = candidates[n].pixel_fixed / finer;
  }
  Laid best = laid;
  while (!laid.is_finest && laid.fit.pixels > 0) {
    laid = lay(moving, fixed, laid.map, pixel_fixed /= finer);
    if (laid.fit.pixels > 0 && laid.error() < best.error()) best = laid;
  }
  return best;
}

constexpr float uncovered = std::numeric_limits<float>::quiet_NaN();

// `moving` resampled at the pixels of `fixed`, `uncovered` beyond it.
Channel laid_upon(const Channel& moving, const Channel& fixed, const Similarity& map) {
  Channel out(fixed.ny, fixed.nx);
  parallel_for(0, fixed.ny, [&](int64_t row) {
    for (int column = 0; column < fixed.nx; ++column) {
      const auto [x, y] = map(column - fixed.u_centre(), double(row) - fixed.v_centre());
      const double at_column = x + moving.u_centre(), at_row = y + moving.v_centre();
      const bool is_covered = holds_cubic(moving, at_column, at_row);
      out(int(row), column) = is_covered ? float(sample_cubic(moving, at_column, at_row).value) : uncovered;
    }
  });
  return out;
}

// Gain and offset between the pictures, from their overlap.
//
// Without an offset the gain is Σm/Σf, which noise and speckle of mean 1 do not change. With an offset, it is the slope
// cov(m, f')/cov(f, f') over blocks of 8 × 8 pixels. f' is the mean of a block's neighbours, whose speckle is
// independent.
void find_gain(const Channel& moving, const Channel& fixed, bool fits_offset, Registration& r) {
  double m_sum = 0, f_sum = 0;
  for (size_t i = 0; i < fixed.values.size(); ++i)
    if (std::isfinite(moving.values[i])) m_sum += moving.values[i], f_sum += fixed.values[i];
  r.gain = m_sum / f_sum;
  if (!fits_offset) return;
  constexpr int side = 8;
  const int nx = fixed.nx / side, ny = fixed.ny / side;
  // A block that is partly outside the overlap is NaN: in m from its uncovered pixels, in f set below.
  std::vector<double> m(size_t(nx) * size_t(ny)), f = m;
  for (int j = 0; j < ny; ++j)
    for (int i = 0; i < nx; ++i) {
      const size_t at = size_t(j) * size_t(nx) + size_t(i);
      for (int y = 0; y < side; ++y)
        for (int x = 0; x < side; ++x) {
          m[at] += moving(j * side + y, i * side + x);
          f[at] += fixed(j * side + y, i * side + x);
        }
      if (!std::isfinite(m[at])) f[at] = uncovered;
    }
  double n = 0, sm = 0, sf = 0, sz = 0, mz = 0, fz = 0;
  for (int j = 1; j + 1 < ny; ++j)
    for (int i = 1; i + 1 < nx; ++i) {
      const size_t at = size_t(j) * size_t(nx) + size_t(i);
      const double z = f[at - 1] + f[at + 1] + f[at - size_t(nx)] + f[at + size_t(nx)];
      if (!std::isfinite(z + f[at])) continue;
      n += 1, sm += m[at], sf += f[at], sz += z, mz += m[at] * z, fz += f[at] * z;
    }
  require(n > 2 && n * fz - sf * sz > 0,
          "expected pictures whose brightness varies on a scale of more than 8 pixels, which the fit of the offset "
          "needs, got none; leave out the offset");
  r.gain = (n * mz - sm * sz) / (n * fz - sf * sz);
  r.offset = (sm - r.gain * sf) / n / (side * side);
}

// Whether a part of the border is dark: the picture stands on dark ground.
bool has_dark_ground(const Channel& channel) {
  constexpr double dark = 0.1, least_part = 0.1;  // of the mean light; of the border
  const Channel small = reduced(channel, std::max(1.0, long_side(channel) / search_side), blur);
  double mean = 0, border = 0, of_ground = 0;
  for (const float value : small.values) mean += double(value) / double(small.values.size());
  for (int j = 0; j < small.ny; ++j)
    for (int i = 0; i < small.nx; ++i)
      if (i == 0 || j == 0 || i == small.nx - 1 || j == small.ny - 1) {
        border += 1;
        of_ground += small(j, i) < dark * mean ? 1 : 0;
      }
  return of_ground > least_part * border;
}

void check_picture(const Image& image, const char* name) {
  require(image.nx >= 16 && image.ny >= 16, "expected a {} of at least 16 × 16 pixels to register, got {} × {}", name,
          image.nx, image.ny);
  const auto [low, high] = std::minmax_element(image.values.begin(), image.values.end());
  for (const float v : image.values) require(std::isfinite(v), "expected finite values in the {}, got {}", name, v);
  require(*low < *high, "expected a {} with structure to register, got the same value {} in every pixel", name, *low);
}

}  // namespace

std::array<double, 2> Registration::operator()(double x, double y) const {
  const double c = scale * std::cos(rotation), s = scale * std::sin(rotation);
  return {c * x - s * y + shift_x, s * x + c * y + shift_y};
}

Registration register_image(const Image& moving_image, const Image& fixed_image, const RegisterParams& params,
                            const Observer& observer) {
  check_picture(moving_image, "photograph");
  check_picture(fixed_image, "simulation");
  const Channel moving = mean_of_channels(moving_image), fixed = mean_of_channels(fixed_image);
  const double equal_width = long_side(moving) / long_side(fixed);
  const double smallest = params.smallest_scale > 0 ? params.smallest_scale : 0.5 * std::min(1.0, equal_width);
  const double largest = params.largest_scale > 0 ? params.largest_scale : 2 * std::max(1.0, equal_width);
  check_ranges(params);
  require(smallest <= largest, "expected scales to try above 0, the smallest no larger than the largest, got {} to {}",
          smallest, largest);
  require(largest <= 100 * smallest, "expected scales to try within a factor of 100, got {} to {}; narrow them",
          smallest, largest);

  std::vector<Candidate> candidates = search(moving, fixed, smallest, largest, observer);
  Laid laid = refine_best(moving, fixed, candidates);
  const auto& [pair, fit, map, is_finest] = laid;
  const bool has_outline = has_dark_ground(moving) && !has_dark_ground(fixed);
  const std::string what_to_do = fmt::format(
      "{}crop the photograph to what is simulated, flip it if a mirror was used, or give the scales to try, "
      "which were {:.3g} to {:.3g} pixels of the photograph per pixel of the simulation",
      has_outline ? "the photograph has a dark border that the simulation does not have: " : "", smallest, largest);
  require(fit.pixels > 0,
          "expected a photograph of what the simulation shows, with enough structure to locate it, got none "
          "that fits anywhere; {}",
          what_to_do);
  Registration r;
  r.scale = scale_of(map);
  r.rotation = -std::atan2(map.b, map.a);  // v points down, y up
  r.shift_x = map.x;
  r.shift_y = -map.y;
  r.iterations = fit.iterations;
  r.correlation = fit.correlation;
  r.overlap = fit.pixels / (double(pair.fixed.nx) * pair.fixed.ny);
  r.uncertainty = laid.error();
  const double most_error = most_error_part * long_side(moving);
  require(r.uncertainty <= most_error,
          "expected a photograph of what the simulation shows, with enough structure to locate it, got one whose best "
          "position has a standard error of {:.2g} pixels, above the limit of {:.2g}; {}",
          r.uncertainty, most_error, what_to_do);

  const Pair plain = at_resolution(moving, fixed, pair.pixel_moving / pair.pixel_fixed, pair.pixel_fixed);
  const Channel plain_moving = laid_upon(plain.moving, plain.fixed, fit.map);
  find_gain(plain_moving, plain.fixed, params.offset, r);
  require(std::isfinite(r.gain) && r.gain > 0,
          "expected light in both the photograph and the simulation, got a gain of {} between them", r.gain);
  double squares = 0, covered = 0;
  for (size_t i = 0; i < plain_moving.values.size(); ++i) {
    if (!std::isfinite(plain_moving.values[i])) continue;
    const double d = (plain_moving.values[i] - r.offset) / r.gain - plain.fixed.values[i];
    squares += d * d;
    covered += 1;
  }
  r.residual = std::sqrt(squares / covered);
  observer.progress(1);
  return r;
}

namespace {

// One channel, smoothed for sampling once per `scale` pixels.
Channel channel_for_scale(const Image& image, int channel, double scale) {
  Channel one(image.ny, image.nx);
  for (size_t i = 0; i < one.values.size(); ++i)
    one.values[i] = image.values[i * size_t(image.channels) + size_t(channel)];
  return scale > 1 ? reduced(one, 1, std::sqrt((scale * scale - 1) / 12)) : one;
}

// For each row, the height of the covered pixels that end there is known in each column. The largest rectangle under
// these heights is as high as one of the columns, and ends at lower columns on both sides.
PixelRectangle largest_rectangle(const std::vector<char>& is_covered, int ny, int nx) {
  PixelRectangle best;
  std::vector<int> height(size_t(nx) + 1, 0), open;  // 0 beyond the last column
  for (int row = 0; row < ny; ++row) {
    open.clear();  // columns of increasing height
    for (int column = 0; column <= nx; ++column) {
      if (column < nx)
        height[size_t(column)] = is_covered[size_t(row) * size_t(nx) + size_t(column)] ? height[size_t(column)] + 1 : 0;
      while (!open.empty() && height[size_t(open.back())] >= height[size_t(column)]) {
        const int rows = height[size_t(open.back())];
        open.pop_back();
        const int first = open.empty() ? 0 : open.back() + 1, columns = column - first;
        if (int64_t(rows) * columns > int64_t(best.rows) * best.columns) best = {row - rows + 1, first, rows, columns};
      }
      open.push_back(column);
    }
  }
  return best;
}

}  // namespace

AlignedImage align_image(const Image& moving, const Registration& registration, int ny, int nx) {
  AlignedImage aligned{Image(ny, nx, moving.channels), {}};
  std::vector<char> is_covered(size_t(nx) * size_t(ny));
  for (int channel = 0; channel < moving.channels; ++channel) {
    const Channel one = channel_for_scale(moving, channel, registration.scale);
    parallel_for(0, ny, [&](int64_t row) {
      for (int column = 0; column < nx; ++column) {
        const auto [x, y] = registration(column - (nx - 1) / 2.0, (ny - 1) / 2.0 - double(row));
        const double at_column = one.u_centre() + x, at_row = one.v_centre() - y;
        if (!holds_cubic(one, at_column, at_row)) continue;
        const double value = sample_cubic(one, at_column, at_row).value;
        aligned.image(int(row), column, channel) = float((value - registration.offset) / registration.gain);
        is_covered[size_t(row) * size_t(nx) + size_t(column)] = 1;
      }
    });
  }
  aligned.covered = largest_rectangle(is_covered, ny, nx);
  require(aligned.covered.rows >= 8 && aligned.covered.columns >= 8,
          "expected a photograph that covers 8 × 8 pixels of the simulation or more, got {} × {}; show more of it",
          aligned.covered.columns, aligned.covered.rows);
  return aligned;
}

Image cropped(const Image& image, const PixelRectangle& r) {
  Image out(r.rows, r.columns, image.channels);
  out.pitch = image.pitch;
  for (int row = 0; row < r.rows; ++row)
    for (int column = 0; column < r.columns; ++column)
      for (int c = 0; c < image.channels; ++c)
        out(row, column, c) = image(r.first_row + row, r.first_column + column, c);
  return out;
}

}  // namespace holotrace
