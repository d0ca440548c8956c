#include "holotrace/trace/materials/measured_bsdf.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "holotrace/base/units.h"
#include "holotrace/data/rgl_brdf.h"

namespace holotrace {
namespace {

// Two neighbouring cells of an axis and the share of the second; the axis ends or wraps around.
struct Between {
  int first, second;
  double share;
};

Between between(double place, int count, bool wraps) {
  const double floor = std::floor(place - 0.5);
  const int cell = int(floor);
  const auto at = [&](int i) { return wraps ? (i % count + count) % count : std::clamp(i, 0, count - 1); };
  return {at(cell), at(cell + 1), place - 0.5 - floor};
}

Vec3 eval_merl(const MeasuredBrdf& brdf, Vec3 outgoing, Vec3 incoming) {
  const MeasuredField& table = brdf.fields.front();
  const Vec3 h = normalize(outgoing + incoming);
  const double sine = std::hypot(h.x, h.y), cos_phi = sine > 0 ? h.x / sine : 1, sin_phi = sine > 0 ? h.y / sine : 0;
  const double theta_h = std::atan2(sine, h.z), theta_d = std::acos(std::clamp(dot(h, incoming), 0.0, 1.0));
  // The light's direction in the frame of the half vector.
  const double x = dot(incoming, {h.z * cos_phi, h.z * sin_phi, -sine}), y = dot(incoming, {-sin_phi, cos_phi, 0});
  double phi_d = std::atan2(y, x);
  if (phi_d < 0) phi_d += pi;  // the light and the viewer may be exchanged
  const Between a = between(std::sqrt(theta_h / (pi / 2)) * merl_theta_h, merl_theta_h, false);
  const Between b = between(theta_d / (pi / 2) * merl_theta_d, merl_theta_d, false);
  const Between c = between(phi_d / pi * merl_phi_d, merl_phi_d, true);
  std::array<double, 3> sum{};
  for (const auto& [i, of_i] : {std::pair{a.first, 1 - a.share}, {a.second, a.share}})
    for (const auto& [j, of_j] : {std::pair{b.first, 1 - b.share}, {b.second, b.share}})
      for (const auto& [k, of_k] : {std::pair{c.first, 1 - c.share}, {c.second, c.share}})
        for (size_t channel = 0; channel < 3; ++channel)
          sum[channel] += of_i * of_j * of_k * merl_value(table, channel, i, j, k);
  return {sum[0], sum[1], sum[2]};
}

// A place between the entries of a list, and the share of the second.
struct Place {
  size_t first, second;
  double share;
};

Place place_in(const std::vector<float>& list, double value) {
  if (list.size() == 1 || value <= double(list.front())) return {0, 0, 0};
  if (value >= double(list.back())) return {list.size() - 1, list.size() - 1, 0};
  const auto second = size_t(std::upper_bound(list.begin(), list.end(), float(value)) - list.begin());
  const size_t next = std::clamp<size_t>(second, 1, list.size() - 1);
  return {next - 1, next, (value - double(list[next - 1])) / double(list[next] - list[next - 1])};
}

// The cell of a place in the unit square, and the place in it.
struct Cell {
  int column, row;
  double x, y;

  Cell(Vec2 square, int nx, int ny) {
    const double u = std::clamp(square.x, 0.0, 1.0) * (nx - 1), v = std::clamp(square.y, 0.0, 1.0) * (ny - 1);
    column = std::min(int(u), nx - 2), row = std::min(int(v), ny - 2);
    x = u - column, y = v - row;
  }

  double between(const float* table, int nx) const {
    const float* upper = table + row * nx + column;
    const float* lower = upper + nx;
    return (1 - y) * ((1 - x) * double(upper[0]) + x * double(upper[1])) +
           y * ((1 - x) * double(lower[0]) + x * double(lower[1]));
  }
};

double between(const MeasuredField& table, Vec2 square) {
  return Cell(square, table.shape[1], table.shape[0]).between(table.values.data(), table.shape[1]);
}

// The slices of a table by the viewer's angles, with their shares.
struct Slices {
  std::array<size_t, 4> index;
  std::array<double, 4> share;
};

// The place in the unit square of uniform numbers that the density maps to `square`.
Vec2 uniform_place(const MeasuredBrdf& brdf, const Slices& slices, Vec2 square) {
  const MeasuredField& density = brdf.fields[rgl_vndf];
  const int ny = density.shape[2], nx = density.shape[3];
  const Cell cell(square, nx, ny);
  double left_upper = 0, left_lower = 0, whole_upper = 0, whole_lower = 0, above = 0;
  double d00 = 0, d10 = 0, d01 = 0, d11 = 0;
  for (size_t s = 0; s < 4; ++s) {
    const double share = slices.share[s];
    if (share == 0) continue;
    const size_t first = slices.index[s] * size_t(nx) * size_t(ny), here = first + size_t(cell.row * nx);
    const float* values = density.values.data() + here + cell.column;
    const float* rows = brdf.fields[rgl_rows].values.data() + here;
    d00 += share * double(values[0]), d10 += share * double(values[1]);
    d01 += share * double(values[nx]), d11 += share * double(values[nx + 1]);
    left_upper += share * double(rows[cell.column]), left_lower += share * double(rows[nx + cell.column]);
    whole_upper += share * double(rows[nx - 1]), whole_lower += share * double(rows[2 * nx - 1]);
    above += share * double(brdf.fields[rgl_columns].values[slices.index[s] * size_t(ny) + size_t(cell.row)]);
  }
  const auto along_y = [&](double upper, double lower) { return upper + cell.y * (lower - upper); };
  const double d0 = along_y(d00, d01), d1 = along_y(d10, d11), whole = along_y(whole_upper, whole_lower);
  const double left = along_y(left_upper, left_lower) + cell.x * (d0 + 0.5 * cell.x * (d1 - d0));
  return {whole > 0 ? left / whole : 0, above + cell.y * (whole_upper + 0.5 * cell.y * (whole_lower - whole_upper))};
}

Vec3 eval_rgl(const MeasuredBrdf& brdf, Vec3 outgoing, Vec3 incoming, const Lines& lines) {
  const auto& fields = brdf.fields;
  const Vec3 h = normalize(outgoing + incoming);
  const auto column_of = [](Vec3 w) { return std::sqrt(std::acos(std::clamp(w.z, -1.0, 1.0)) * (2 / pi)); };
  const auto row_of = [](double phi) {
    const double row = phi / (2 * pi) + 0.5;
    return row - std::floor(row);
  };
  // A surface that was measured in a part of the directions is the same in the others, mirrored or turned by 180°.
  const auto& phis = fields[rgl_phi].values;
  const bool is_turned_too = is_brushed(brdf);
  const double parts = is_turned_too ? std::round(2 * pi / double(phis.back() - phis.front())) : 1;
  const double flip_y = parts >= 2 && outgoing.y > 0 ? -1 : 1;
  const double flip_x = parts >= 4 ? (outgoing.x > 0 ? -1 : 1) : flip_y;
  const double phi = std::atan2(outgoing.y * flip_y, outgoing.x * flip_x);
  const double phi_h = std::atan2(h.y * flip_y, h.x * flip_x), theta = std::acos(std::clamp(outgoing.z, 0.0, 1.0));
  const Vec2 place_h{column_of(h), row_of(is_turned_too ? phi_h : phi_h - phi)};
  const Place by_phi = is_turned_too ? place_in(phis, phi) : Place{0, 0, 0};
  const Place by_theta = place_in(fields[rgl_theta].values, theta);
  const size_t thetas = fields[rgl_theta].values.size();
  const Slices slices{{by_phi.first * thetas + by_theta.first, by_phi.first * thetas + by_theta.second,
                       by_phi.second * thetas + by_theta.first, by_phi.second * thetas + by_theta.second},
                      {(1 - by_phi.share) * (1 - by_theta.share), (1 - by_phi.share) * by_theta.share,
                       by_phi.share * (1 - by_theta.share), by_phi.share * by_theta.share}};
  const Vec2 uniform = uniform_place(brdf, slices, place_h);
  const MeasuredField& spectra = fields[rgl_spectra];
  const int ny = spectra.shape[3], nx = spectra.shape[4];
  const Cell cell(uniform, nx, ny);
  const auto& wavelengths = fields[rgl_wavelengths].values;
  const auto at = [&](double wavelength) {
    const Place by_wavelength = place_in(wavelengths, wavelength * 1e9);
    double sum = 0;
    for (size_t s = 0; s < 4; ++s)
      for (const auto& [w, share] :
           {std::pair{by_wavelength.first, 1 - by_wavelength.share}, {by_wavelength.second, by_wavelength.share}})
        if (slices.share[s] * share > 0)
          sum += slices.share[s] * share *
                 cell.between(
                     spectra.values.data() + (slices.index[s] * wavelengths.size() + w) * size_t(nx) * size_t(ny), nx);
    return sum;
  };
  const double projected = between(fields[rgl_sigma], {column_of(outgoing), row_of(phi)});
  if (!(projected > 0)) return {};
  const double density = between(fields[rgl_ndf], place_h) / (4 * projected * incoming.z);
  return Vec3{at(lines.wavelengths[0]), at(lines.wavelengths[1]), at(lines.wavelengths[2])} * density;
}

}  // namespace

Vec3 eval_measured(const MeasuredBrdf& brdf, Vec3 outgoing, Vec3 incoming, const Lines& lines) {
  return is_rgl(brdf) ? eval_rgl(brdf, outgoing, incoming, lines) : lines.from_rgb(eval_merl(brdf, outgoing, incoming));
}

}  // namespace holotrace
