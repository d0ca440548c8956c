#include "holotrace/trace/shared/ray.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <mutex>
#include <utility>

#include "holotrace/base/threads.h"
#include "holotrace/data/smooth_reflectance.h"

namespace holotrace {

ReflectanceTable::ReflectanceTable(const std::array<double, 3>& wavelengths) : values_(size_t(size) * size * size) {
  constexpr double step = 1.0 / (size - 1);
  parallel_for(0, size, [&](int64_t i) {
    for (int j = 0; j < size; ++j)
      for (int k = 0; k < size; ++k) {
        const SmoothReflectance spectrum = fit_reflectance({double(i) * step, j * step, k * step});
        values_[(size_t(i) * size + size_t(j)) * size + size_t(k)] = {
            spectrum.at(wavelengths[0]), spectrum.at(wavelengths[1]), spectrum.at(wavelengths[2])};
      }
  });
}

const ReflectanceTable& reflectance_table(const std::array<double, 3>& wavelengths) {
  static std::mutex mutex;
  static std::map<std::array<double, 3>, ReflectanceTable> tables;
  const std::lock_guard lock(mutex);
  return tables.try_emplace(wavelengths, wavelengths).first->second;
}

Vec3 ReflectanceTable::at(Vec3 rgb) const {
  const auto cell_of = [](double value) {
    const double place = std::clamp(value, 0.0, 1.0) * (size - 1);
    const int cell = std::min(int(place), size - 2);
    return std::pair{cell, place - cell};
  };
  const auto red = cell_of(rgb.x), green = cell_of(rgb.y), blue = cell_of(rgb.z);
  Vec3 sum;
  for (const int i : {0, 1})
    for (const int j : {0, 1})
      for (const int k : {0, 1}) {
        const double share = (i ? red.second : 1 - red.second) * (j ? green.second : 1 - green.second) *
                             (k ? blue.second : 1 - blue.second);
        sum +=
            share * values_[(size_t(red.first + i) * size + size_t(green.first + j)) * size + size_t(blue.first + k)];
      }
  return sum;
}

}  // namespace holotrace
