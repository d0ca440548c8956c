#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <vector>

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

}  // namespace
}  // namespace holotrace
