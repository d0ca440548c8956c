#include "holotrace/trace/materials/brushed_loss.h"

#include <map>
#include <mutex>
#include <utility>

#include "holotrace/base/units.h"

namespace holotrace {
namespace {

// By midpoints over the visible normals, as mean_over_visible_normals, but all around.
double brushed_loss_at(double cosine, double along, Vec2 alpha, int azimuths, int heights) {
  const double sine = std::sqrt(1 - cosine * cosine);
  const Vec3 o{sine * along, sine * std::sqrt(1 - along * along), cosine};
  const double masking = smith_masking(o, alpha);
  double kept = 0;
  for (int j = 0; j < heights; ++j) {
    const double s = 1 - (j + 0.5) / heights, measure = 3 * s * s / (azimuths * heights);
    for (int i = 0; i < azimuths; ++i) {
      const Vec3 back = reflect(o, sample_visible_normal(o, alpha, {(i + 0.5) / azimuths, 1 - s * s * s}));
      if (back.z > 0) kept += measure * smith_masking_shadowing(o, back, alpha) / masking;
    }
  }
  return 1 - kept;
}

/// The mean over φ of a function that is linear in cosφ between its values at even steps from 0 to 1.
template <class Value>
double mean_over_turns(int size, const Value& value) {
  double sum = 0;
  for (int j = 0; j + 1 < size; ++j) {
    const double low = double(j) / (size - 1), high = double(j + 1) / (size - 1), step = high - low;
    const double turn = std::acos(low) - std::acos(high);
    const double rise =
        (std::sqrt(1 - low * low) - std::sqrt(1 - high * high) - low * turn) / step;  // ∫(cosφ − low)/step dφ
    sum += double(value(j)) * (turn - rise) + double(value(j + 1)) * rise;
  }
  return sum / (0.5 * pi);
}

BrushedLoss make_brushed_loss(Vec2 alpha, int azimuths, int heights) {
  BrushedLoss table;
  for (int i = 0; i < BrushedLoss::cosines; ++i) {
    const double s = double(i) / (BrushedLoss::cosines - 1);
    for (int j = 0; j < BrushedLoss::turns; ++j)
      table.losses[size_t(i)][size_t(j)] = float(
          brushed_loss_at(std::fmax(1e-6, s * s), double(j) / (BrushedLoss::turns - 1), alpha, azimuths, heights));
  }
  table.mean = mean_over_hemisphere(BrushedLoss::cosines, [&](int i) {
    return mean_over_turns(BrushedLoss::turns, [&](int j) { return table.losses[size_t(i)][size_t(j)]; });
  });
  double low = smooth_alpha, high = 1;
  for (int step = 0; step < 40; ++step) {
    const double middle = 0.5 * (low + high);
    (MicrofacetAlbedo(middle).mean().loss < table.mean ? low : high) = middle;
  }
  table.even_alpha = low;
  return table;
}

}  // namespace

BrushedLossBetween brushed_loss(double roughness, double anisotropy) {
  struct Kept {
    std::once_flag once;
    BrushedLoss table;
  };
  static std::mutex mutex;
  static std::map<std::pair<double, double>, Kept> known;
  const Vec2 alpha = brushed_alpha(roughness, anisotropy);
  const std::pair key(alpha.x, alpha.y);
  thread_local std::pair<std::pair<double, double>, const BrushedLoss*> last;  // paths often meet the same metal again
  if (!last.second || last.first != key) {
    const auto entry_of_key = [&]() -> Kept& {
      const std::lock_guard lock(mutex);
      return known.try_emplace(key).first->second;
    };
    Kept& entry = entry_of_key();  // the lock is not held while a table is made
    std::call_once(entry.once, [&] { entry.table = make_brushed_loss(alpha, 48, 48); });
    last = {key, &entry.table};
  }
  return {{last.second}, {1}};
}

BrushedLossBetween brushed_loss_of_texel(double roughness, double anisotropy) {
  constexpr int rows = 13, columns = 9;
  struct Kept {
    std::once_flag once;
    BrushedLoss table;
  };
  static std::array<std::array<Kept, columns>, rows> kept;
  // Losses are nearly linear in α, so in the squares.
  const auto split = [](double share, int size) {
    const double at = std::clamp(share, 0.0, 1.0) * (size - 1);
    const int first = std::min(int(at), size - 2);
    return std::pair(first, (at * at - first * first) / (2 * first + 1));
  };
  const auto [row, down] = split(roughness, rows);
  const auto [column, along] = split(anisotropy, columns);
  BrushedLossBetween between;
  for (int k = 0; k < 4; ++k) {
    const int i = row + k / 2, j = column + k % 2;
    Kept& entry = kept[size_t(i)][size_t(j)];
    std::call_once(entry.once, [&] {
      entry.table = make_brushed_loss(brushed_alpha(double(i) / (rows - 1), double(j) / (columns - 1)), 16, 24);
    });
    between.tables[size_t(k)] = &entry.table;
    between.weights[size_t(k)] = (k / 2 ? down : 1 - down) * (k % 2 ? along : 1 - along);
  }
  return between;
}

}  // namespace holotrace
