#include "holotrace/trace/geometry/first_hits.h"

#include <algorithm>
#include <cmath>

#include "holotrace/base/error.h"
#include "holotrace/base/units.h"
#include "holotrace/data/acceptance.h"

namespace holotrace {

namespace {

/// Nodes in (0, 1) and weights of the 16-point Gauss-Legendre rule on [−1, 1] (Abramowitz and Stegun, 25.4.30);
/// the rule is symmetric.
constexpr double gauss_nodes[8] = {0.0950125098376374, 0.2816035507792589, 0.4580167776572274, 0.6178762444026438,
                                   0.7554044083550030, 0.8656312023878318, 0.9445750230732326, 0.9894009349916499};
constexpr double gauss_weights[8] = {0.1894506104550685, 0.1826034150449236, 0.1691565193950025, 0.1495959888165767,
                                     0.1246289712555339, 0.0951585116824928, 0.0622535239386479, 0.0271524594117541};

template <class Function>
double integrate(double from, double to, const Function& function) {
  const double middle = (from + to) / 2, half = (to - from) / 2;
  double sum = 0;
  for (int i = 0; i < 8; ++i)
    sum += gauss_weights[i] * (function(middle - half * gauss_nodes[i]) + function(middle + half * gauss_nodes[i]));
  return sum * half;
}

/// Sample number for the pairing. The samples of all frames share seed and frame; no sample has this number.
constexpr uint64_t pairing_sample = ~uint64_t(0);

}  // namespace

double wave_power(double depth, double x0, double x1, double y0, double y1) {
  return depth * depth * integrate(std::asinh(x0 / depth), std::asinh(x1 / depth), [&](double t) {
           const double reach = depth * std::cosh(t);  // √(d² + x²)
           return std::atan(y1 / reach) - std::atan(y0 / reach);
         });
}

double raster_tangent(double field_of_view, const Grid& panel, double wavelength) {
  require(field_of_view >= 0 && field_of_view < pi / 2,
          "expected a field_of_view from 0 to less than 90 deg, got {} deg", field_of_view * 180 / pi);
  if (field_of_view > 0) return std::tan(field_of_view);
  const double tangent = acceptance_tangent(wavelength, panel.pitch);
  require(std::isfinite(tangent),
          "expected a field_of_view for a panel of pitch {} at {}: it accepts light from all sides, so set the half "
          "angle of the view",
          format_length(panel.pitch), format_length(wavelength));
  return tangent;
}

bool is_accepted(Vec3 direction, const Grid& panel, double wavelength) {
  const double s = acceptance_sine(wavelength, panel.pitch), x = direction.x, y = direction.y;
  return x * x < s * s * (1 - y * y) && y * y < s * s * (1 - x * x);
}

std::optional<Vec3> accepted_direction(double x, double y, const Grid& panel, double wavelength) {
  const double limit = acceptance_sine(wavelength, panel.pitch);
  x *= limit;
  y *= limit;
  if (!is_accepted({x, y, 0}, panel, wavelength)) return std::nullopt;
  return Vec3{x, y, -std::sqrt(1 - x * x - y * y)};
}

FirstHits::FirstHits(const TraceParams& params, const Grid& panel, double wavelength)
    : pattern_(params.pattern),
      panel_(panel),
      wavelength_(wavelength),
      columns_(raster_columns(params)),
      rows_(raster_rows(params)),
      count_(pattern_ == Pattern::grid ? int64_t(columns_) * rows_ : params.samples),
      pairing_(std::max<int64_t>(count_, 1), CounterRandom(uint64_t(params.seed), 0, pairing_sample)) {
  if (pattern_ == Pattern::grid) {
    require(columns_ >= 1 && rows_ >= 1, "expected a raster of at least 1 × 1 first hits, got columns = {}, rows = {}",
            columns_, rows_);
    tangent_ = raster_tangent(params.field_of_view, panel, wavelength);
  } else {
    constexpr int64_t most = int64_t(1) << 40;
    require(count_ >= 1 && count_ <= most, "expected 1 to {} samples, got {}", most, count_);
  }
}

std::optional<Ray> FirstHits::ray(int64_t index, CounterRandom& random) const {
  return pattern_ == Pattern::grid ? raster_ray(index) : random_ray(index, random);
}

std::optional<Ray> FirstHits::raster_ray(int64_t index) const {
  const int64_t row = index / columns_, column = index % columns_;
  const double x = (2 * double(column) + 1) / columns_ - 1, y = 1 - (2 * double(row) + 1) / rows_;
  return Ray{{}, view_direction(x * tangent_, y * tangent_)};
}

std::optional<Ray> FirstHits::random_ray(int64_t index, CounterRandom& random) const {
  const double u0 = random.uniform(), v0 = random.uniform(), u1 = random.uniform(), v1 = random.uniform();
  const Vec2 sines = stratum(index, count_, u0, v0), place = stratum(pairing_(index), count_, u1, v1);
  const auto direction = accepted_direction(2 * sines.x - 1, 2 * sines.y - 1, panel_, wavelength_);
  if (!direction) return std::nullopt;
  return Ray{{(place.x - 0.5) * panel_.width(), (0.5 - place.y) * panel_.height(), 0}, *direction};
}

AstigmaticWave::Lit WaveShape::lit(double tangent) const {
  if (astigmatic) return astigmatic->lit(tangent);
  const double depth = std::abs(origin.z), radius = depth * tangent;
  return {{origin.x, origin.y, 0}, radius, radius, {.xx = 1 / depth, .yy = 1 / depth}, tangent};
}

double WaveShape::modulus(Vec3 place) const {
  return astigmatic ? astigmatic->at(place).modulus : std::abs(origin.z) / length(place - origin);
}

double FirstHits::squared_amplitude(const Ray& ray, const WaveShape& shape, double wavelength) const {
  const PixelBox whole{0, panel_.nx, 0, panel_.ny};
  return squared_amplitude(ray, shape, wavelength, {&whole, 1});
}

double FirstHits::squared_amplitude(const Ray& ray, const WaveShape& shape, double wavelength,
                                    std::span<const PixelBox> visible) const {
  if (pattern_ == Pattern::grid) {
    const double cell = 2 * tangent_ / columns_ * (2 * tangent_ / rows_), cosine = -ray.direction.z;
    const double modulus = shape.astigmatic ? shape.modulus(ray.origin) : cosine;
    return cell * std::pow(cosine, 4) / (modulus * modulus);
  }
  if (!is_accepted(ray.direction, panel_, wavelength)) return 0;
  const double limit = acceptance_sine(wavelength_, panel_.pitch);
  const double etendue = panel_.width() * panel_.height() * 4 * limit * limit;
  double power = 0;
  for (const PixelBox& part : visible) power += power_on(shape, wavelength, part);
  return power > 0 ? etendue / double(count_) / power : 0;
}

/// Power of a wave of unit amplitude on a part of the panel, inside its box [m²].
double FirstHits::power_on(const WaveShape& shape, double wavelength, const PixelBox& part) const {
  const AstigmaticWave::Lit lit = shape.lit(acceptance_tangent(wavelength, panel_.pitch));
  const auto& [foot, reach_x, reach_y, slopes, tangent] = lit;
  const double edge = panel_.pitch / 2;
  const double x0 = std::max(panel_.x(part.x0) - edge - foot.x, -reach_x);
  const double x1 = std::min(panel_.x(part.x1 - 1) + edge - foot.x, reach_x);
  const double y0 = std::max(panel_.y(part.y1 - 1) - edge - foot.y, -reach_y);
  const double y1 = std::min(panel_.y(part.y0) + edge - foot.y, reach_y);
  if (!(x1 > x0 && y1 > y0)) return 0;
  if (!shape.astigmatic) return wave_power(std::abs(shape.origin.z), x0, x1, y0, y1);
  return integrate(x0, x1, [&](double x) {
    const auto [from, to] = AstigmaticWave::intersect(lit.along_y(x), {y0, y1});
    if (!(to > from)) return 0.0;
    return integrate(from, to, [&](double y) { return std::pow(shape.modulus({foot.x + x, foot.y + y, 0}), 2); });
  });
}

}  // namespace holotrace
