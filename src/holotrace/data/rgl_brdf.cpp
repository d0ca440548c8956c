#include "holotrace/data/rgl_brdf.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "holotrace/base/error.h"
#include "holotrace/base/units.h"

namespace holotrace {
namespace {

void check_axis(const MeasuredField& axis, size_t least) {
  const bool ascends =
      std::adjacent_find(axis.values.begin(), axis.values.end(), std::greater_equal<>()) == axis.values.end() &&
      std::all_of(axis.values.begin(), axis.values.end(), [](float value) { return std::isfinite(value); });
  require(axis.shape.size() == 1 && axis.values.size() >= least && ascends,
          "expected {} ascending values or more in the field \"{}\" of a measured BRDF, got {}", least, axis.name,
          axis.values.size());
}

void check_shape(const MeasuredField& field, const std::vector<int>& before, size_t dimensions) {
  bool fits = field.shape.size() == dimensions;
  for (size_t i = 0; fits && i < before.size(); ++i) fits = field.shape[i] == before[i];
  for (size_t i = before.size(); fits && i < dimensions; ++i) fits = field.shape[i] >= 2;
  require(fits, "expected a field \"{}\" of a measured BRDF that fits its angles and wavelengths, got another shape",
          field.name);
  const auto bad = std::find_if_not(field.values.begin(), field.values.end(),
                                    [](float value) { return std::isfinite(value) && value >= 0; });
  require(bad == field.values.end(), "expected values of 0 or more in the field \"{}\" of a measured BRDF, got {}",
          field.name, bad == field.values.end() ? 0 : *bad);
}

}  // namespace

void prepare_rgl(MeasuredBrdf& brdf) {
  auto& fields = brdf.fields;
  check_axis(fields[rgl_phi], 1);
  check_axis(fields[rgl_theta], 2);
  check_axis(fields[rgl_wavelengths], 2);
  const int phis = fields[rgl_phi].shape[0], thetas = fields[rgl_theta].shape[0];
  check_shape(fields[rgl_ndf], {}, 2);
  check_shape(fields[rgl_sigma], {}, 2);
  check_shape(fields[rgl_vndf], {phis, thetas}, 4);
  check_shape(fields[rgl_spectra], {phis, thetas, fields[rgl_wavelengths].shape[0]}, 5);

  MeasuredField& density = fields[rgl_vndf];
  const int ny = density.shape[2], nx = density.shape[3];
  fields[rgl_rows] = {"rows", density.shape, std::vector<float>(density.values.size())};
  fields[rgl_columns] = {"columns", {phis, thetas, ny}, std::vector<float>(size_t(phis) * size_t(thetas) * size_t(ny))};
  for (int slice = 0; slice < phis * thetas; ++slice) {
    float* values = density.values.data() + size_t(slice) * size_t(nx) * size_t(ny);
    float* rows = fields[rgl_rows].values.data() + size_t(slice) * size_t(nx) * size_t(ny);
    float* columns = fields[rgl_columns].values.data() + size_t(slice) * size_t(ny);
    double total = 0;
    std::vector<double> of_rows(size_t(ny), 0.0), above(size_t(ny), 0.0);
    for (int y = 0; y < ny; ++y) {
      for (int x = 1; x < nx; ++x)
        of_rows[size_t(y)] += 0.5 * (double(values[y * nx + x - 1]) + double(values[y * nx + x]));
      if (y > 0) total += 0.5 * (of_rows[size_t(y) - 1] + of_rows[size_t(y)]);
      above[size_t(y)] = total;
    }
    require(total > 0, "expected light in the field \"{}\" of a measured BRDF, got none for one direction",
            density.name);
    // In units of cells: the integral over the unit square is 1.
    for (int y = 0; y < ny; ++y) {
      double sum = 0;
      columns[y] = float(above[size_t(y)] / total);
      for (int x = 0; x < nx; ++x) {
        if (x > 0) sum += 0.5 * (double(values[y * nx + x - 1]) + double(values[y * nx + x]));
        rows[y * nx + x] = float(sum / total);
      }
    }
    for (int i = 0; i < nx * ny; ++i) values[i] = float(double(values[i]) / total);
  }

  const MeasuredField& ndf = fields[rgl_ndf];
  const auto mean_of = [&](int column) {
    double sum = 0;
    for (int row = 0; row < ndf.shape[0]; ++row) sum += double(ndf.values[size_t(row * ndf.shape[1] + column)]);
    return sum;
  };
  int column = 0;
  while (column < ndf.shape[1] - 1 && mean_of(column) > mean_of(0) / 2) ++column;
  const double u = double(column) / (ndf.shape[1] - 1), theta = u * u * pi / 2;
  brdf.alpha = std::clamp(std::tan(std::min(theta, 1.2)) / std::sqrt(std::sqrt(2.0) - 1), 0.01, 1.0);
  brdf.diffuse_share = 0.4;
}

}  // namespace holotrace
