#include "holotrace/trace/materials/dielectric_bsdf.h"

#include <map>
#include <memory>
#include <mutex>
#include <shared_mutex>
#include <utility>

#include "holotrace/trace/materials/fresnel.h"
#include "holotrace/trace/materials/microfacet.h"

namespace holotrace {
namespace {

/// 1 − the mean, over visible microfacets, of the light that each one sends to a side without hitting its neighbours.
double loss_at(double cosine, double index, double alpha) {
  const Vec3 o{std::sqrt(1 - cosine * cosine), 0, cosine};
  const double masking = smith_masking(o, alpha);
  return mean_over_visible_normals<32>(o, alpha, [&](Vec3 h) {
    const double cosine_h = std::fmin(1, dot(o, h));
    if (cosine_h <= 0) return 1.0;
    const double reflected = reflectance_dielectric(cosine_h, index);
    const Vec3 back = reflect(o, h);
    double kept = back.z > 0 ? reflected * smith_masking_shadowing(o, back, alpha) / masking : 0;
    if (reflected < 1)
      if (const Vec3 on = refract(o, h, index); on.z < 0) kept += (1 - reflected) * smith_masking(on, alpha);
    return 1 - kept;
  });
}

BoundaryLoss::Side side_of(double index, double alpha) {
  BoundaryLoss::Side side;
  for (int i = 0; i < BoundaryLoss::size; ++i) {
    const double s = double(i) / (BoundaryLoss::size - 1);
    side.losses[size_t(i)] = loss_at(std::fmax(1e-6, s * s), index, alpha);
  }
  side.mean = mean_over_hemisphere(BoundaryLoss::size, [&](int i) { return side.losses[size_t(i)]; });
  for (int i = 0; i < BoundaryLoss::size; ++i)
    side.shares[size_t(i)] = mean_over_hemisphere(BoundaryLoss::size, i, [&](int j) { return side.losses[size_t(j)]; });
  if (side.mean > 0)
    for (double& share : side.shares) share /= side.mean;
  return side;
}

/// Mean reflectance 2∫F·μ dμ of a smooth boundary.
double mean_reflectance(double index) {
  constexpr int steps = 256;
  double sum = 0;
  for (int i = 0; i < steps; ++i) {
    const double cosine = (i + 0.5) / steps;
    sum += 2 * cosine * reflectance_dielectric(cosine, index) / steps;
  }
  return sum;
}

BoundaryLoss make(double index, double alpha) {
  BoundaryLoss loss{side_of(index, alpha), side_of(1 / index, alpha)};
  if (loss.thin.mean < 1e-6 || loss.dense.mean < 1e-6) return loss;
  const double most = loss.dense.mean * index * index / loss.thin.mean;  // here all light passes from the other side
  loss.through = std::fmin(1 - mean_reflectance(index), most);
  return loss;
}

}  // namespace

const BoundaryLoss& boundary_loss(double exact_index, double alpha) {
  const double index = float(exact_index);  // rounded, so that n and 1/(1/n) are one boundary
  struct Entry {
    double index = 0, alpha = 0;
    const BoundaryLoss* loss = nullptr;
  };
  thread_local Entry last;  // neighbouring paths often meet the same glass
  if (last.loss && last.index == index && last.alpha == alpha) return *last.loss;
  static std::shared_mutex mutex;
  static std::map<std::pair<double, double>, std::unique_ptr<const BoundaryLoss>> known;
  const std::pair key(index, alpha);
  {
    const std::shared_lock lock(mutex);
    if (const auto found = known.find(key); found != known.end()) last = {index, alpha, found->second.get()};
  }
  if (!last.loss || last.index != index || last.alpha != alpha) {
    const std::unique_lock lock(mutex);
    std::unique_ptr<const BoundaryLoss>& loss = known[key];
    if (!loss) loss = std::make_unique<const BoundaryLoss>(make(index, alpha));
    last = {index, alpha, loss.get()};
  }
  return *last.loss;
}

DielectricBsdf make_dielectric_bsdf(const SurfacePoint& point, const RefractiveIndex& index, const Lines& lines,
                                    double alpha, bool is_thin) {
  const auto relative = [&](size_t line) {
    const double n = index_at(index, lines.of_glass(line)).real();
    return point.is_front || is_thin ? n : 1 / n;
  };
  const auto hero = size_t(lines.hero);
  DielectricBsdf b = make_dielectric_bsdf(point.normal, point.geometric_normal, relative(hero), alpha, is_thin);
  if (index.samples.size() > 1) b.indices = {relative(0), relative(1), relative(2)};
  b.hero = hero;
  return b;
}

}  // namespace holotrace
