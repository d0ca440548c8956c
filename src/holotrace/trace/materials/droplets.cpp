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
    a_.push_back((electric * psi - psi_before) / (electric * xi - xi_before));
    b_.push_back((magnetic * psi - psi_before) / (magnetic * xi - xi_before));
    extinction_ += (2 * n + 1) * (a_.back() + b_.back()).real();
    scattering_ += (2 * n + 1) * (std::norm(a_.back()) + std::norm(b_.back()));
  }
  extinction_ *= 2 / (x * x);
  scattering_ *= 2 / (x * x);
}

double MieSphere::phase(double cosine) const {
  std::complex<double> s1, s2;
  double pi_before = 0, pi_now = 1;  // angular functions π_n
  for (size_t i = 0; i < a_.size(); ++i) {
    const double n = double(i) + 1, tau = n * cosine * pi_now - (n + 1) * pi_before;
    const double factor = (2 * n + 1) / (n * (n + 1));
    s1 += factor * (a_[i] * pi_now + b_[i] * tau);
    s2 += factor * (a_[i] * tau + b_[i] * pi_now);
    const double next = ((2 * n + 1) * cosine * pi_now - (n + 1) * pi_before) / n;
    pi_before = std::exchange(pi_now, next);
  }
  return (std::norm(s1) + std::norm(s2)) / (2 * pi * x_ * x_ * scattering_);
}

PhaseTable::PhaseTable(const MieSphere& sphere, double x) {
  const size_t cells = std::max<size_t>(360, size_t(16 * x));  // the first dark ring is at 3.8/x: 20 cells
  density_.resize(cells);
  share_.resize(cells + 1);
  for (size_t i = 0; i < cells; ++i) {
    density_[i] = sphere.phase(std::cos(pi * (double(i) + 0.5) / double(cells)));
    share_[i + 1] = share_[i] + 2 * pi * density_[i] * (edge(i) - edge(i + 1));
  }
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
