#include <gtest/gtest.h>
#include <hdf5.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <vector>

#include "holotrace/io/describe_file.h"
#include "holotrace/io/field/light_field_file.h"
#include "support/temporary.h"

namespace holotrace {
namespace {

using test::temporary;

/// Three columns and two rows of views of 4 × 5 pixels; every value differs.
LightField some_light_field(int channels) {
  LightField field{.panel = {},
                   .lens = {3, 2, 1e-3, 0.5e-3, 0},
                   .lens_z = 0.25,
                   .columns = 3,
                   .rows = 2,
                   .plane = {4, 5, 50e-6, 0, 1e-3},
                   .distance = 0.3,
                   .views = {}};
  for (int k = 0; k < 6; ++k) {
    Image& view = field.views.emplace_back(5, 4, channels);
    for (size_t i = 0; i < view.values.size(); ++i) view.values[i] = 0.1f * float(i) + 100 * float(k);
  }
  return field;
}

TEST(LightFieldFile, ALightFieldComesBackAsSaved) {
  for (const int channels : {1, 3}) {
    const LightField field = some_light_field(channels);
    const std::string path = temporary("light.h5");
    save_light_field(path, field);
    EXPECT_TRUE(is_light_field_file(path));
    EXPECT_FALSE(is_focal_stack_file(path));
    const LightField loaded = load_light_field(path);
    EXPECT_EQ(loaded.lens, field.lens);
    EXPECT_EQ(loaded.plane, field.plane);
    EXPECT_EQ(loaded.columns, 3);
    EXPECT_EQ(loaded.rows, 2);
    EXPECT_EQ(loaded.lens_z, field.lens_z);
    EXPECT_EQ(loaded.distance, field.distance);
    ASSERT_EQ(loaded.views.size(), 6u);
    for (size_t k = 0; k < 6; ++k) EXPECT_EQ(loaded.views[k].values, field.views[k].values) << "every bit";
    const auto facts = describe_file(path);
    EXPECT_EQ(facts["kind"], "light field");
    EXPECT_EQ(facts["views"], "3x2");
    EXPECT_EQ(facts["cell"], "1 mm");
  }
}

/// A file as h5py writes it, of doubles.
std::string write_light_field(const std::vector<hsize_t>& shape, const std::vector<double>& samples,
                              const std::vector<std::pair<const char*, double>>& attributes) {
  const std::string path = temporary("others.h5");
  const hid_t file = H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
  const hid_t space = H5Screate_simple(int(shape.size()), shape.data(), nullptr);
  const hid_t data = H5Dcreate2(file, "light_field", H5T_IEEE_F64LE, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  if (!samples.empty()) H5Dwrite(data, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, samples.data());
  const hid_t scalar = H5Screate(H5S_SCALAR);
  for (const auto& [name, value] : attributes) {
    const hid_t attribute = H5Acreate2(data, name, H5T_NATIVE_DOUBLE, scalar, H5P_DEFAULT, H5P_DEFAULT);
    H5Awrite(attribute, H5T_NATIVE_DOUBLE, &value);
    H5Aclose(attribute);
  }
  for (const hid_t id : {scalar, space}) H5Sclose(id);
  H5Dclose(data);
  H5Fclose(file);
  return path;
}

TEST(LightFieldFile, OfOtherProgramsNeedsCellPitchAndDistance) {
  const std::vector<std::pair<const char*, double>> all{{"cell_m", 2e-3}, {"pitch_m", 1e-4}, {"distance_m", 0.4}};
  const LightField field = load_light_field(write_light_field({1, 2, 1, 3}, {1, 2, 3, 4, 5, 6}, all));
  EXPECT_EQ(field.lens_z, 0) << "on the panel";
  EXPECT_EQ(field.cell_width(), 2e-3);
  EXPECT_EQ(field.plane, (Grid{3, 1, 1e-4}));
  EXPECT_EQ(field.views[1].values, (std::vector<float>{4, 5, 6})) << "the right view";
  for (size_t left_out = 0; left_out < 3; ++left_out) {
    auto some = all;
    some.erase(some.begin() + long(left_out));
    const std::string path = write_light_field({1, 1, 1, 1}, {1}, some);
    EXPECT_EQ(error_of([&] { load_light_field(path); }),
              path + ": expected the key \"" + all[left_out].first +
                  "\", which is missing; add it in SI units, as an attribute of \"light_field\"");
  }
}

TEST(LightFieldFile, BadFilesAreRefused) {
  const std::vector<std::pair<const char*, double>> all{{"cell_m", 2e-3}, {"pitch_m", 1e-4}, {"distance_m", 0.4}};
  const auto error = [](const std::string& path) { return error_of([&] { load_light_field(path); }); };
  for (const std::vector<hsize_t>& shape : {std::vector<hsize_t>{1}, {2, 2}, {1, 1, 1}, {1, 1, 1, 1, 2}, {0, 1, 1, 1}})
    EXPECT_NE(
        error(write_light_field(shape, {}, all)).find("expected the shape (rows, columns, pixel rows, pixel columns)"),
        std::string::npos);
  EXPECT_NE(
      error(write_light_field({1, 2, 1, 1}, {1, -1}, all))
          .find("expected finite radiance of 0 or more in the view of column 2 and row 1 of the light field, got -1"),
      std::string::npos);
  const auto with = [&](const char* name, double value) {
    auto some = all;
    for (auto& [key, number] : some)
      if (std::string(key) == name) number = value;
    if (std::string(name) == "lens_z_m") some.push_back({name, value});
    return error(write_light_field({1, 1, 1, 1}, {1}, some));
  };
  EXPECT_NE(with("lens_z_m", -0.1).find("expected the cells of the light field on the panel or in front of it"),
            std::string::npos);
  EXPECT_NE(with("distance_m", 0).find("in a plane other than that of its lens"), std::string::npos);
  EXPECT_NE(with("distance_m", std::nan("")).find("distance_m"), std::string::npos);
  EXPECT_NE(with("cell_m", 0).find("expected cells wider than 0 m in the light field, got 0 m"), std::string::npos);
}

TEST(LightFieldFile, OnlyWholeLightFieldsAreSaved) {
  LightField field = some_light_field(1);
  EXPECT_EQ(error_of([&] { save_light_field(temporary("light.npy"), field); }).find("expected .h5 for a light field"),
            0u);
  field.views.pop_back();
  EXPECT_EQ(error_of([&] { save_light_field(temporary("light.h5"), field); }),
            "expected a light field with a picture for each of its 3 × 2 cells, got 5");
}

}  // namespace
}  // namespace holotrace
