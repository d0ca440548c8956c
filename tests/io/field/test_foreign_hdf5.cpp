// Fields in HDF5 as other programs write them.

#include <gtest/gtest.h>
#include <hdf5.h>

#include <array>
#include <complex>
#include <string>
#include <vector>

#include "holotrace/io/field/field_file.h"
#include "support/error_of.h"
#include "support/temporary.h"

namespace holotrace {
namespace {

using test::make_file;
using test::temporary;

struct ForeignFile {
  std::string path;
  hid_t file;
  explicit ForeignFile(const std::string& name)
      : path(temporary(name)), file(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT)) {}
  ~ForeignFile() { close(); }
  void close() {
    if (file >= 0) H5Fclose(file);
    file = -1;
  }

  // Complex numbers of those names; the k-th value is k + 1 + 100i·(k + 1).
  void add_complex(const char* name, std::array<hsize_t, 2> shape, const char* real, const char* imaginary,
                   bool is_of_matlab = false) {
    const hid_t type = H5Tcreate(H5T_COMPOUND, 16), space = H5Screate_simple(2, shape.data(), nullptr);
    H5Tinsert(type, real, 0, H5T_IEEE_F64LE);
    H5Tinsert(type, imaginary, 8, H5T_IEEE_F64LE);
    const hid_t data = H5Dcreate2(file, name, type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    std::vector<std::complex<double>> values;
    for (hsize_t k = 0; k < shape[0] * shape[1]; ++k) values.emplace_back(double(k + 1), 100.0 * double(k + 1));
    H5Dwrite(data, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
    if (is_of_matlab) {
      const hid_t text = H5Tcopy(H5T_C_S1), one = H5Screate(H5S_SCALAR);
      H5Tset_size(text, 6);
      const hid_t attribute = H5Acreate2(data, "MATLAB_class", text, one, H5P_DEFAULT, H5P_DEFAULT);
      H5Awrite(attribute, text, "double");
      H5Aclose(attribute), H5Sclose(one), H5Tclose(text);
    }
    H5Dclose(data), H5Sclose(space), H5Tclose(type);
  }

  // A variable of 1 × n numbers.
  void add_numbers(const char* name, const std::vector<double>& values) {
    const hsize_t shape[] = {1, values.size()};
    const hid_t space = H5Screate_simple(2, shape, nullptr);
    const hid_t data = H5Dcreate2(file, name, H5T_IEEE_F64LE, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    H5Dwrite(data, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
    H5Dclose(data), H5Sclose(space);
  }
};

TEST(ForeignHdf5, NamesOfRealAndImaginaryPartsAreRead) {
  for (const auto& [real, imaginary] : {std::pair("r", "i"), std::pair("real", "imag"), std::pair("re", "im")}) {
    ForeignFile file("foreign.h5");
    file.add_complex("field", {2, 3}, real, imaginary);
    file.close();
    make_file("foreign.h5.json", R"({"pitch_m": 8e-6, "wavelengths_m": [532e-9]})");  // where the file has no metadata
    const FieldDouble field = load_field_double(file.path);
    EXPECT_EQ(field.grid.nx, 3);
    EXPECT_EQ(field.grid.pitch, 8e-6);
    EXPECT_EQ(field.wavelength, 532e-9);
    EXPECT_EQ(field.samples(1, 0), std::complex<double>(4, 400)) << real;
  }
}

// MATLAB keeps a matrix column by column and writes its dimensions in reverse; save -v7.3 writes variables as datasets.
TEST(ForeignHdf5, AFileOfMatlabIsReadWithItsVariables) {
  ForeignFile file("x.mat");
  file.add_complex("u", {2, 3}, "real", "imag", true);
  file.add_numbers("pitch_m", {8e-6});
  file.add_numbers("wavelengths_m", {633e-9});
  file.add_numbers("z_m", {-0.1});
  file.close();
  const FieldDouble field = load_field_double(file.path);
  EXPECT_EQ(field.grid.nx, 2);  // a matrix of 3 rows and 2 columns
  EXPECT_EQ(field.grid.ny, 3);
  EXPECT_EQ(field.samples(0, 1), std::complex<double>(4, 400));
  EXPECT_EQ(field.samples(2, 0), std::complex<double>(3, 300));
  EXPECT_EQ(field.wavelength, 633e-9);
  EXPECT_EQ(field.z, -0.1);
}

TEST(ForeignHdf5, WhatIsMissingIsNamedWithPlacesForIt) {
  ForeignFile file("bare.h5");
  file.add_complex("field", {2, 3}, "real", "imag");
  file.close();
  EXPECT_EQ(
      error_of([&] { load_field(file.path); }),
      file.path +
          ": expected the key \"wavelengths_m\", which is missing; add it in SI units, as an attribute of \"field\", as "
          "a variable beside it or as a key of " +
          file.path + ".json");
  ForeignFile two("two.mat");
  two.add_complex("a", {2, 3}, "real", "imag");
  two.add_complex("b", {2, 3}, "real", "imag");
  two.close();
  EXPECT_NE(error_of([&] { load_field(two.path); }).find("expected a dataset \"field\", which is missing"),
            std::string::npos);
}

TEST(ForeignHdf5, AnOlderFileOfMatlabIsNamed) {
  const std::string path = make_file("old.mat", "MATLAB 5.0 MAT-file, Platform: GLNXA64" + std::string(200, ' '));
  EXPECT_EQ(error_of([&] { load_field(path); }),
            path + ": expected an HDF5 file, got a MATLAB file of an older version; save it there with -v7.3");
}

}  // namespace
}  // namespace holotrace
