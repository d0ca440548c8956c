#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <vector>

#include "holotrace/base/machine.h"
#include "holotrace/wave/propagate/transfer_row.h"

namespace holotrace {
namespace {

TEST(TransferRow, IsTheTransferFunctionInSinglePrecision) {
  // Against long double, up to the edge of the evanescent waves. Odd counts leave lanes over.
  const long double pi = 3.14159265358979323846L;
  for (const double wavelength : {450e-9, 632.8e-9})
    for (const double z : {-0.3, 1e-6, 0.05, 2.0})
      for (const double part : {0.0, 0.02, 0.9}) {
        const double k = 1 / wavelength, u = part * k;
        const long double cycles_of_z = (long double)z * (1 / (long double)wavelength);
        const double start = double(cycles_of_z - std::floor(cycles_of_z));
        std::vector<double> v, v2;
        for (int j = 0; j < 37; ++j) v.push_back(std::sqrt(1 - part * part) * k * j / 37);
        for (const double of_v : v) v2.push_back(of_v * of_v);
        std::vector<std::complex<float>> row(v.size());
        transfer_row({u * u, k, z, start}, v2.data(), v2.size(), row.data());
        for (size_t j = 0; j < v.size(); ++j) {
          const long double q = (long double)u * u + (long double)v[j] * v[j], exact_k = 1 / (long double)wavelength;
          const long double cycles = (long double)start - z * q / (exact_k + std::sqrt(exact_k * exact_k - q));
          const long double angle = 2 * pi * (cycles - std::floor(cycles));
          // 4e-7 for the cosine and the sine in floats, and the cycles in doubles: 8 roundings of 1.1e-16 each.
          const double tolerance = 4e-7 + 2 * 3.1416 * 8 * 1.1e-16 * double(std::abs(cycles));
          ASSERT_NEAR(row[j].real(), double(std::cos(angle)), tolerance) << z << ' ' << part << ' ' << j;
          ASSERT_NEAR(row[j].imag(), double(std::sin(angle)), tolerance) << z << ' ' << part << ' ' << j;
        }
      }
}

TEST(KernelRow, IsTheRayleighSommerfeldKernelOnEveryInstructionSet) {
  // h = (1/2π)·(z/r²)·(1/r − ik)·exp(ikr) in long double, its conjugate for z < 0. Odd counts leave lanes over.
  using Exact = long double;
  const Exact pi = 3.14159265358979323846L, wavelength = 532e-9, k = 2 * pi / wavelength;
  for (const std::string& name : instruction_sets()) {
    const OnInstructionSet on(name);
    for (const double z : {-0.25, 1e-4, 0.003, 1.5})
      for (const double y : {0.0, -4.1e-3}) {
        const Exact depth = std::abs(Exact(z)), cycles_of_z = depth / wavelength;
        std::vector<double> x;
        for (int i = 0; i < 37; ++i) x.push_back((i - 11) * 3.7e-4);
        std::vector<std::complex<double>> row(x.size());
        rayleigh_sommerfeld_row({y, double(wavelength), z, double(cycles_of_z - std::floor(cycles_of_z)), 2.5},
                                x.data(), x.size(), row.data());
        for (size_t i = 0; i < x.size(); ++i) {
          const Exact rho2 = Exact(x[i]) * x[i] + Exact(y) * y, r = std::sqrt(rho2 + depth * depth);
          const Exact beyond = rho2 / (r + depth);  // r − depth, which would cancel
          const Exact modulus = 2.5L * depth / (2 * pi * r * r);
          const Exact whole = k * beyond + 2 * pi * (cycles_of_z - std::floor(cycles_of_z));
          const Exact re = modulus * (std::cos(whole) / r + k * std::sin(whole));
          const Exact im = modulus * (std::sin(whole) / r - k * std::cos(whole)) * (z < 0 ? -1 : 1);
          // Cycles beyond the axis are rounded a few times (1.1e-16 each); so are the cosine and the modulus.
          const double cycles = double(beyond / wavelength);
          const double tolerance = (2 * 3.1416 * 8 * 1.1e-16 * (1 + cycles) + 1e-15) * double(modulus * k);
          ASSERT_NEAR(row[i].real(), double(re), tolerance) << name << ' ' << z << ' ' << y << ' ' << i;
          ASSERT_NEAR(row[i].imag(), double(im), tolerance) << name << ' ' << z << ' ' << y << ' ' << i;
        }
      }
  }
}

}  // namespace
}  // namespace holotrace
