#include "holotrace/trace/materials/brushed_loss.h"

#include <map>
#include <memory>
#include <mutex>
#include <utility>

#include "holotrace/base/units.h"

namespace holotrace {
namespace {

double brushed_loss_at(double cosine, double along, Vec2 alpha) {
  const double sine = std::sqrt(1 - cosine * cosine);
  const Vec3 o{sine * along, sine * std::sqrt(1 - along * along), cosine};
  const double masking = smith_masking(o, alpha);
  constexpr int azimuths = 48, heights = 48;  // as mean_over_visible_normals, but all around
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

BrushedLoss make_brushed_loss(Vec2 alpha) {
  BrushedLoss table;
  for (int i = 0; i < BrushedLoss::cosines; ++i) {
    const double s = double(i) / (BrushedLoss::cosines - 1);
    for (int j = 0; j < BrushedLoss::turns; ++j)
      table.losses[size_t(i)][size_t(j)] =
          float(brushed_loss_at(std::fmax(1e-6, s * s), double(j) / (BrushedLoss::turns - 1), alpha));
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

const BrushedLoss& brushed_loss(Vec2 alpha) {
  struct Last {
    Vec2 alpha{};
    const BrushedLoss* loss = nullptr;
  };
  thread_local Last last;  // neighbouring paths often meet the same metal
  if (last.loss && last.alpha.x == alpha.x && last.alpha.y == alpha.y) return *last.loss;
  static std::mutex mutex;
  static std::map<std::pair<double, double>, std::unique_ptr<const BrushedLoss>> known;
  const std::pair key(alpha.x, alpha.y);
  const auto find = [&]() -> const BrushedLoss* {
    const std::lock_guard lock(mutex);
    const auto found = known.find(key);
    return found == known.end() ? nullptr : found->second.get();
  };
  const BrushedLoss* loss = find();
  if (!loss) {  // made without the lock, so that threads make theirs at the same time
    auto made = std::make_unique<const BrushedLoss>(make_brushed_loss(alpha));
    const std::lock_guard lock(mutex);
    loss = known.try_emplace(key, std::move(made)).first->second.get();
  }
  last = {alpha, loss};
  return *loss;
}

}  // namespace holotrace
