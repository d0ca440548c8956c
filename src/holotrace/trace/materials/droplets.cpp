#include "holotrace/trace/materials/droplets.h"

#include <map>
#include <memory>
#include <mutex>
#include <shared_mutex>
#include <utility>

#include "holotrace/data/refractive_index.h"

namespace holotrace {

MieSphere::MieSphere(double x, std::complex<double> m) : x_(x) {
  using Complex = std::complex<double>;
  const Complex y = m * x;
  const int terms = int(x + 4 * std::cbrt(x) + 2),
            start = std::max(terms, int(std::abs(y))) + 16 + int(8 * std::cbrt(std::abs(y)));
  std::vector<Complex> derivative(size_t(start) + 1);
  for (int n = start; n > 0; --n)
    derivative[size_t(n) - 1] = double(n) / y - 1.0 / (derivative[size_t(n)] + double(n) / y);
  double psi_before = std::cos(x), psi = std::sin(x), chi_before = -std::sin(x), chi = std::cos(x);
  for (int n = 1; n <= terms; ++n) {
    const double next_psi = (2 * n - 1) / x * psi - psi_before, next_chi = (2 * n - 1) / x * chi - chi_before;
    psi_before = std::exchange(psi, next_psi);
    chi_before = std::exchange(chi, next_chi);
    const Complex xi(psi, -chi), xi_before(psi_before, -chi_before);
    const Complex electric = derivative[size_t(n)] / m + n / x, magnetic = derivative[size_t(n)] * m + n / x;
    const Complex a = (electric * psi - psi_before) / (electric * xi - xi_before),
                  b = (magnetic * psi - psi_before) / (magnetic * xi - xi_before);
    const double weight = (2 * n + 1) / (n * (n + 1.0));
    sums_.push_back(weight * (a + b));
    differences_.push_back(weight * (a - b));
    extinction_ += (2 * n + 1) * (a + b).real();
    scattering_ += (2 * n + 1) * (std::norm(a) + std::norm(b));
  }
  extinction_ *= 2 / (x * x);
  scattering_ *= 2 / (x * x);
}

// S₁ ± S₂ are sums of (a_n ± b_n)·(π_n ± τ_n); at the negative cosine π_n + τ_n is (−1)^(n+1)·(π_n − τ_n).
MieSphere::Phases MieSphere::phases(const std::array<double, lanes>& cosines) const {
  using Lanes = std::array<double, lanes>;
  struct Amplitude {
    Lanes re{}, im{};
  } plus, minus, plus_behind, minus_behind;
  Lanes before{}, now;  // π_n
  now.fill(1);
  for (size_t i = 0; i < sums_.size(); ++i) {
    const double n = double(i) + 1, grown = (2 * n + 1) / n, kept = (n + 1) / n, sign = i % 2 ? -1 : 1;
    const double p = sums_[i].real(), q = sums_[i].imag(), r = differences_[i].real(), s = differences_[i].imag();
    for (size_t k = 0; k < lanes; ++k) {
      const double tau = n * cosines[k] * now[k] - (n + 1) * before[k];
      const double sum = now[k] + tau, difference = now[k] - tau;
      plus.re[k] += p * sum, plus.im[k] += q * sum;
      minus.re[k] += r * difference, minus.im[k] += s * difference;
      plus_behind.re[k] += sign * p * difference, plus_behind.im[k] += sign * q * difference;
      minus_behind.re[k] += sign * r * sum, minus_behind.im[k] += sign * s * sum;
      const double next = grown * cosines[k] * now[k] - kept * before[k];
      before[k] = std::exchange(now[k], next);
    }
  }
  Phases found;
  const double scale = 1 / (4 * pi * x_ * x_ * scattering_);
  const auto light = [&](const Amplitude& a, const Amplitude& b, size_t k) {
    return scale * (a.re[k] * a.re[k] + a.im[k] * a.im[k] + b.re[k] * b.re[k] + b.im[k] * b.im[k]);
  };
  for (size_t k = 0; k < lanes; ++k) {
    found.ahead[k] = light(plus, minus, k);
    found.behind[k] = light(plus_behind, minus_behind, k);
  }
  return found;
}

PhaseTable::PhaseTable(const MieSphere& sphere, double x) {
  const size_t cells = std::max<size_t>(360, size_t(16 * x));  // the first dark ring is at 3.8/x: 20 cells
  density_.resize(cells);
  share_.resize(cells + 1);
  for (size_t first = 0; 2 * first < cells; first += MieSphere::lanes) {
    std::array<double, MieSphere::lanes> cosines;
    for (size_t k = 0; k < cosines.size(); ++k) cosines[k] = std::cos(pi * (double(first + k) + 0.5) / double(cells));
    const MieSphere::Phases phases = sphere.phases(cosines);
    for (size_t k = 0; k < cosines.size() && first + k < cells; ++k) {
      density_[first + k] = phases.ahead[k];
      density_[cells - 1 - (first + k)] = phases.behind[k];
    }
  }
  for (size_t i = 0; i < cells; ++i) share_[i + 1] = share_[i] + 2 * pi * density_[i] * (edge(i) - edge(i + 1));
  const double all = share_.back();
  for (double& density : density_) density /= all;
  for (double& share : share_) share /= all;
}

const PhaseTable& droplet_phase(double radius, double wavelength) {
  static std::shared_mutex mutex;
  static std::map<std::pair<double, double>, std::unique_ptr<const PhaseTable>> known;
  const std::pair key(radius, wavelength);
  {
    const std::shared_lock lock(mutex);
    if (const auto found = known.find(key); found != known.end()) return *found->second;
  }
  const std::unique_lock lock(mutex);
  std::unique_ptr<const PhaseTable>& table = known[key];
  if (!table) {
    static const RefractiveIndex water = glass_index("water");
    const double x = 2 * pi * radius / wavelength;
    table = std::make_unique<const PhaseTable>(MieSphere(x, index_at(water, wavelength)), x);
  }
  return *table;
}

}  // namespace holotrace
