#include "holotrace/trace/shared/ray.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <mutex>
#include <utility>

#include "holotrace/base/threads.h"
#include "holotrace/data/smooth_reflectance.h"

namespace holotrace {

namespace {

constexpr double darkest = 1e-3;  // from here down to black a colour keeps the shape of its spectrum

// Brightness at a place of the raster, which is fine near black and white, and the place of a brightness.
double brightness_at(double place) { return place * place * (3 - 2 * place); }
double place_of_brightness(double brightness) { return 0.5 - std::sin(std::asin(1 - 2 * brightness) / 3); }

// The largest of the components, and the two that follow it, over it.
struct Shade {
  size_t largest = 0;
  double brightness = 0, second = 0, third = 0;
};

Shade shade_of(Vec3 rgb) {
  const std::array<double, 3> parts{std::clamp(rgb.x, 0.0, 1.0), std::clamp(rgb.y, 0.0, 1.0),
                                    std::clamp(rgb.z, 0.0, 1.0)};
  Shade shade;
  shade.largest = size_t(std::max_element(parts.begin(), parts.end()) - parts.begin());
  shade.brightness = parts[shade.largest];
  if (shade.brightness == 0) return shade;
  shade.second = parts[(shade.largest + 1) % 3] / shade.brightness;
  shade.third = parts[(shade.largest + 2) % 3] / shade.brightness;
  return shade;
}

Vec3 colour_of(const Shade& shade) {
  std::array<double, 3> parts;
  parts[shade.largest] = shade.brightness;
  parts[(shade.largest + 1) % 3] = shade.second * shade.brightness;
  parts[(shade.largest + 2) % 3] = shade.third * shade.brightness;
  return {parts[0], parts[1], parts[2]};
}

}  // namespace

ReflectanceTable::ReflectanceTable(const std::array<double, 3>& wavelengths)
    : values_(size_t(3) * levels * ratios * ratios) {
  parallel_for(0, int64_t(3) * levels, [&](int64_t row) {
    Shade shade;
    shade.largest = size_t(row / levels);
    shade.brightness = std::max(darkest, brightness_at(double(row % levels) / (levels - 1)));
    for (int j = 0; j < ratios; ++j)
      for (int k = 0; k < ratios; ++k) {
        shade.second = double(j) / (ratios - 1);
        shade.third = double(k) / (ratios - 1);
        const SmoothReflectance spectrum = fit_reflectance(colour_of(shade));
        const Vec3 values{spectrum.at(wavelengths[0]), spectrum.at(wavelengths[1]), spectrum.at(wavelengths[2])};
        values_[(size_t(row) * ratios + size_t(j)) * ratios + size_t(k)] = values * (1 / shade.brightness);
      }
  });
}

Vec3 ReflectanceTable::at(Vec3 rgb) const {
  const Shade shade = shade_of(rgb);
  const auto cell_of = [](double place, int size) { return std::min(int(place * (size - 1)), size - 2); };
  const int level = cell_of(place_of_brightness(shade.brightness), levels), j = cell_of(shade.second, ratios),
            k = cell_of(shade.third, ratios);
  const double below = brightness_at(double(level) / (levels - 1)),
               above = brightness_at(double(level + 1) / (levels - 1));
  const std::array<double, 2> up{(above - shade.brightness) / (above - below),
                                 (shade.brightness - below) / (above - below)};
  const double second = shade.second * (ratios - 1) - j, third = shade.third * (ratios - 1) - k;
  Vec3 sum;
  for (const int i : {0, 1}) {
    const Vec3* row =
        &values_[((shade.largest * levels + size_t(level + i)) * ratios + size_t(j)) * ratios + size_t(k)];
    sum += up[size_t(i)] * ((1 - second) * ((1 - third) * row[0] + third * row[1]) +
                            second * ((1 - third) * row[ratios] + third * row[ratios + 1]));
  }
  return shade.brightness * sum;
}

const ReflectanceTable& reflectance_table(const std::array<double, 3>& wavelengths) {
  static std::mutex mutex;
  static std::map<std::array<double, 3>, ReflectanceTable> tables;
  const std::lock_guard lock(mutex);
  return tables.try_emplace(wavelengths, wavelengths).first->second;
}

}  // namespace holotrace
