#include "holotrace/calibrate/least_squares.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace holotrace {
namespace {

constexpr double noise_floor = 0.1;  // of the mean, in the weights
constexpr double first_damping = 1e-3, most_damping = 1e6;

using Slopes = Eigen::Matrix<double, Eigen::Dynamic, 4>;

Eigen::Map<const Eigen::VectorXf> values_of(const PhotoPixels& pixels) {
  return {pixels.value.data(), Eigen::Index(pixels.size())};
}

// 1/√(mean·(model + floor)); 0 where the window has no light to show.
Eigen::VectorXd weights_of(const Exposure& exposure, const Eigen::VectorXd& seen, const PhotoExposure& at) {
  const double mean = exposure.pixels.mean;
  return seen.unaryExpr([&](double s) {
    return std::isfinite(s) ? 1 / std::sqrt(mean * (std::max(0.0, at.gain * s + at.offset) + noise_floor * mean)) : 0.0;
  });
}

// A photograph as the unknowns predict it, before gain and offset.
Eigen::VectorXd prediction_of(const CalibrationBench& bench, const Exposure& exposure, const Unknowns& unknowns) {
  const Channel irradiance = bench.irradiance(*exposure.pattern, unknowns);
  return PixelMeans(exposure.pixels, unknowns.camera, irradiance).of(irradiance);
}

Eigen::VectorXd without_nan(const Eigen::VectorXd& v) {
  return v.unaryExpr([](double x) { return std::isfinite(x) ? x : 0.0; });
}

// The equations N·step = g of one photograph are added to those of all.
struct Equations {
  Eigen::MatrixXd normal;
  Eigen::VectorXd gradient;
  Eigen::MatrixXd scatter;  // Σ over blocks of g·gᵀ
  double cost = 0;
  size_t pixels = 0;
  std::vector<double> rms;
  std::vector<Eigen::VectorXd> weights;
};

// Columns of one photograph: those of `free`, then gain and offset.
Eigen::MatrixXd columns_of(const Exposure& exposure, const CalibrationBench::Response& response,
                           const std::vector<Unknown>& free, const Unknowns& unknowns, const PixelMeans& means) {
  const double gain = unknowns.exposures[exposure.number].gain;
  const Eigen::VectorXd seen = without_nan(means.of(response.irradiance));
  const Slopes slopes = means.slopes_of(response.irradiance);
  Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(seen.size(), Eigen::Index(free.size()) + 2);
  for (size_t n = 0; n < free.size(); ++n) {
    const auto column = Eigen::Index(n);
    if (free[n].kind == UnknownKind::camera)
      columns.col(column) = gain * slopes.col(Eigen::Index(free[n].index));
    else if (!response.slopes[n].values.empty())
      columns.col(column) = gain * without_nan(means.of(response.slopes[n]));
  }
  columns.col(Eigen::Index(free.size())) = seen;
  columns.col(Eigen::Index(free.size()) + 1).setOnes();
  return columns;
}

void add_scatter(const Exposure& exposure, const Eigen::MatrixXd& columns, const Eigen::VectorXd& residual,
                 const std::vector<Eigen::Index>& places, Eigen::MatrixXd& scatter) {
  Eigen::MatrixXd sums = Eigen::MatrixXd::Zero(exposure.pixels.blocks, columns.cols());
  for (Eigen::Index i = 0; i < columns.rows(); ++i)
    sums.row(exposure.pixels.block[size_t(i)]) += residual[i] * columns.row(i);
  const Eigen::MatrixXd product = sums.transpose() * sums;
  for (size_t p = 0; p < places.size(); ++p)
    for (size_t q = 0; q < places.size(); ++q)
      scatter(places[p], places[q]) += product(Eigen::Index(p), Eigen::Index(q));
}

Equations equations_at(const CalibrationBench& bench, const std::vector<Exposure>& exposures,
                       const std::vector<Unknown>& free, const Unknowns& unknowns, bool precise,
                       const Observer& observer) {
  const auto count = Eigen::Index(free.size() + 2 * exposures.size());
  Equations e{Eigen::MatrixXd::Zero(count, count),
              Eigen::VectorXd::Zero(count),
              Eigen::MatrixXd::Zero(precise ? count : 0, precise ? count : 0),
              0,
              0,
              {},
              {}};
  for (size_t p = 0; p < exposures.size(); ++p) {
    const Exposure& exposure = exposures[p];
    const CalibrationBench::Response response = bench.respond(*exposure.pattern, unknowns, free);
    const PixelMeans means(exposure.pixels, unknowns.camera, response.irradiance);
    const Eigen::VectorXd raw = means.of(response.irradiance);
    const PhotoExposure& at = unknowns.exposures[exposure.number];
    const Eigen::VectorXd weights = weights_of(exposure, raw, at), seen = without_nan(raw);
    Eigen::MatrixXd columns = columns_of(exposure, response, free, unknowns, means);
    Eigen::VectorXd residual = values_of(exposure.pixels).cast<double>() - at.gain * seen;
    residual.array() = (residual.array() - at.offset) * weights.array();
    columns.array().colwise() *= weights.array();

    std::vector<Eigen::Index> places;
    for (size_t n = 0; n < free.size(); ++n) places.push_back(Eigen::Index(n));
    places.push_back(Eigen::Index(free.size() + 2 * p));
    places.push_back(places.back() + 1);
    const Eigen::MatrixXd normal = columns.transpose() * columns;
    const Eigen::VectorXd gradient = columns.transpose() * residual;
    for (size_t i = 0; i < places.size(); ++i) {
      e.gradient[places[i]] += gradient[Eigen::Index(i)];
      for (size_t j = 0; j < places.size(); ++j)
        e.normal(places[i], places[j]) += normal(Eigen::Index(i), Eigen::Index(j));
    }
    if (precise) add_scatter(exposure, columns, residual, places, e.scatter);
    const auto used = size_t((weights.array() > 0).count());
    e.cost += residual.squaredNorm();
    e.pixels += used;
    e.rms.push_back(std::sqrt(residual.squaredNorm() / double(std::max<size_t>(1, used))));
    e.weights.push_back(weights);
    observer.progress(double(p + 1) / double(exposures.size()));
  }
  return e;
}

double cost_at(const CalibrationBench& bench, const std::vector<Exposure>& exposures, const Unknowns& unknowns,
               const std::vector<Eigen::VectorXd>& weights) {
  double cost = 0;
  for (size_t p = 0; p < exposures.size(); ++p) {
    const Exposure& exposure = exposures[p];
    const PhotoExposure& at = unknowns.exposures[exposure.number];
    const Eigen::VectorXd seen = without_nan(prediction_of(bench, exposure, unknowns));
    const Eigen::VectorXd residual = values_of(exposure.pixels).cast<double>() - at.gain * seen;
    cost += ((residual.array() - at.offset) * weights[p].array()).matrix().squaredNorm();
  }
  return cost;
}

Unknowns moved(Unknowns unknowns, const std::vector<Unknown>& along, const Eigen::VectorXd& step) {
  for (size_t n = 0; n < along.size(); ++n) value_of(unknowns, along[n]) += step[Eigen::Index(n)];
  unknowns.crosstalk = std::clamp(unknowns.crosstalk, 0.0, 2.0);
  return unknowns;
}

// Without an effect on any photograph, an unknown stays as it is.
Eigen::MatrixXd damped(const Eigen::MatrixXd& normal, double damping) {
  Eigen::MatrixXd out = normal;
  out.diagonal() += (damping * normal.diagonal().array() + 1e-12 * normal.diagonal().maxCoeff()).matrix();
  return out;
}

}  // namespace

FitResult fit(const CalibrationBench& bench, const std::vector<Exposure>& exposures, const std::vector<Unknown>& free,
              const FitEffort& effort, Unknowns& unknowns, const Observer& observer) {
  FitResult result;
  result.unknowns = free;
  for (const Exposure& exposure : exposures)
    for (const size_t k : {2 * exposure.number, 2 * exposure.number + 1})
      result.unknowns.push_back({UnknownKind::exposure, k});
  double damping = first_damping;
  Equations e;
  for (result.iterations = 0;; ++result.iterations) {
    e = equations_at(bench, exposures, free, unknowns, effort.has_covariance,
                     part_of(observer, std::min(result.iterations, effort.iterations), effort.iterations + 1));
    if (result.has_converged || result.iterations == effort.iterations) break;
    for (;; damping *= 10) {
      const Eigen::VectorXd step = damped(e.normal, damping).ldlt().solve(e.gradient);
      const Unknowns next = moved(unknowns, result.unknowns, step);
      const double cost = cost_at(bench, exposures, next, e.weights);
      if (cost < e.cost) {
        unknowns = next;
        result.has_converged = e.cost - cost < effort.tolerance * e.cost;
        damping = std::max(1e-9, damping / 10);
        break;
      }
      if (damping > most_damping || std::abs(cost - e.cost) < effort.tolerance * e.cost) {
        result.has_converged = true;
        break;
      }
    }
    if (result.has_converged && !effort.has_covariance) break;
  }
  result.misfit = {e.cost, e.pixels, e.rms};
  if (effort.has_covariance) {
    const auto factors = damped(e.normal, 0).ldlt();
    const auto count = e.normal.rows();
    const Eigen::MatrixXd inverse = factors.solve(Eigen::MatrixXd::Identity(count, count));
    result.covariance = inverse * e.scatter * inverse.transpose();
  }
  return result;
}

Misfit misfit_of(const CalibrationBench& bench, const std::vector<Exposure>& exposures, Unknowns& unknowns) {
  Misfit misfit;
  for (const Exposure& exposure : exposures) {
    const Eigen::VectorXd raw = prediction_of(bench, exposure, unknowns);
    const Eigen::VectorXd seen = without_nan(raw), value = values_of(exposure.pixels).cast<double>();
    PhotoExposure& at = unknowns.exposures[exposure.number];
    // The weights need a brightness: the ratio of the means.
    const Eigen::VectorXd weights = weights_of(exposure, raw, {value.sum() / std::max(1e-30, seen.sum()), 0});
    Eigen::Matrix<double, Eigen::Dynamic, 2> columns(seen.size(), 2);
    columns << seen.cwiseProduct(weights), weights;
    const Eigen::VectorXd weighted = value.cwiseProduct(weights);
    const Eigen::Vector2d best = (columns.transpose() * columns).ldlt().solve(columns.transpose() * weighted);
    at = {best[0], best[1]};
    const double cost = (weighted - columns * best).squaredNorm();
    const auto used = size_t((weights.array() > 0).count());
    misfit.cost += cost;
    misfit.pixels += used;
    misfit.rms.push_back(std::sqrt(cost / double(std::max<size_t>(1, used))));
  }
  return misfit;
}

double correlation_of(const CalibrationBench& bench, const Exposure& exposure, const Unknowns& unknowns) {
  const Eigen::VectorXd raw = prediction_of(bench, exposure, unknowns);
  double n = 0, s = 0, v = 0, ss = 0, sv = 0, vv = 0;
  for (Eigen::Index i = 0; i < raw.size(); ++i) {
    if (!std::isfinite(raw[i])) continue;
    const double x = std::sqrt(raw[i] > 0 ? raw[i] : 0),
                 y = std::sqrt(std::max(0.0F, exposure.pixels.value[size_t(i)]));
    n += 1, s += x, v += y, ss += x * x, sv += x * y, vv += y * y;
  }
  return (sv - s * v / n) / std::sqrt(std::max(1e-300, (ss - s * s / n) * (vv - v * v / n)));
}

}  // namespace holotrace
