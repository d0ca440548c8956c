#include <gtest/gtest.h>
#include <hdf5.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <vector>

#include "holotrace/io/describe_file.h"
#include "holotrace/io/field/field_file.h"
#include "holotrace/io/field/light_field_file.h"
#include "holotrace/io/files/file.h"
#include "support/temporary.h"

namespace holotrace {
namespace {

using test::make_file;
using test::temporary;

FocalStack some_stack(int channels) {
  FocalStack stack{{4, 3, 8e-6}, {0.29, 0.3}, {}};
  for (int k = 0; k < 2; ++k) {
    Image& picture = stack.pictures.emplace_back(3, 4, channels);
    for (size_t i = 0; i < picture.values.size(); ++i) picture.values[i] = 0.1f * float(i) + 100 * float(k);
  }
  return stack;
}

/// A file as another program may write it: any shape, doubles, and the attributes that are given.
std::string make_hdf5(const std::vector<hsize_t>& shape, const std::vector<double>& samples,
                      const std::vector<std::pair<const char*, std::vector<double>>>& attributes) {
  const std::string path = temporary("other.h5");
  const hid_t file = H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
  const hid_t space = H5Screate_simple(int(shape.size()), shape.data(), nullptr);
  const hid_t data = H5Dcreate2(file, "focal_stack", H5T_IEEE_F64BE, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  if (!samples.empty()) H5Dwrite(data, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, samples.data());
  for (const auto& [name, values] : attributes) {
    const hsize_t count = values.size();
    const hid_t length = H5Screate_simple(1, &count, nullptr);
    const hid_t attribute = H5Acreate2(data, name, H5T_NATIVE_DOUBLE, length, H5P_DEFAULT, H5P_DEFAULT);
    H5Awrite(attribute, H5T_NATIVE_DOUBLE, values.data());
    H5Aclose(attribute);
    H5Sclose(length);
  }
  H5Dclose(data);
  H5Sclose(space);
  H5Fclose(file);
  return path;
}

TEST(FocalStackFile, AStackComesBackAsSaved) {
  for (const int channels : {1, 3}) {
    const FocalStack stack = some_stack(channels);
    const std::string path = temporary("stack.h5");
    save_focal_stack(path, stack);
    EXPECT_TRUE(is_focal_stack_file(path));
    const FocalStack loaded = load_focal_stack(path);
    EXPECT_EQ(loaded.grid, stack.grid);
    EXPECT_EQ(loaded.distances, stack.distances);
    ASSERT_EQ(loaded.pictures.size(), 2u);
    for (size_t k = 0; k < 2; ++k) {
      EXPECT_EQ(loaded.pictures[k].channels, channels);
      EXPECT_EQ(loaded.pictures[k].values, stack.pictures[k].values) << "every bit";
    }
    const auto facts = describe_file(path);
    EXPECT_EQ(facts["kind"], "focal stack");
    EXPECT_EQ(facts["distances"], "290 mm, 300 mm");
    EXPECT_EQ(facts["channels"], channels);
    EXPECT_EQ(facts["pixels"], "4x3");
  }
}

TEST(FocalStackFile, OtherProgramsMayWriteDoublesOfEitherEndWithoutAUnit) {
  const std::string path = make_hdf5({1, 1, 2, 3}, {1, 2, 3, 4, 5, 6}, {{"pitch_m", {4e-6}}, {"distances_m", {0.5}}});
  const FocalStack stack = load_focal_stack(path);
  EXPECT_EQ(stack.grid, (Grid{2, 1, 4e-6}));
  EXPECT_EQ(stack.distances, std::vector<double>{0.5});
  EXPECT_EQ(stack.pictures[0].values, (std::vector<float>{1, 2, 3, 4, 5, 6}));
}

TEST(FocalStackFile, AFieldIsNoFocalStack) {
  const std::string path = temporary("field.h5");
  save_field(path, Field({3, 2, 8e-6}, 532e-9, 0));
  EXPECT_FALSE(is_focal_stack_file(path));
  EXPECT_EQ(error_of([&] { load_focal_stack(path); }),
            path + ": expected a dataset \"focal_stack\", which is missing; is this another kind of HDF5 file?");
  EXPECT_FALSE(is_focal_stack_file(make_file("text.h5", "no HDF5")));
  EXPECT_FALSE(is_focal_stack_file(temporary("missing.h5")));
}

TEST(FocalStackFile, BadFilesAreRefused) {
  const std::vector<double> one{1};
  const auto error = [](const std::string& path) {
    const std::string text = error_of([&] { load_focal_stack(path); });
    EXPECT_EQ(text.find(path), 0u) << text;
    return text.substr(std::min(text.size(), path.size() + 2));
  };
  EXPECT_EQ(error(make_hdf5({1, 1, 1}, one, {{"distances_m", {0.3}}})),
            "expected the key \"pitch_m\", which is missing; add it in SI units, as an attribute of \"focal_stack\"");
  EXPECT_EQ(
      error(make_hdf5({1, 1, 1}, one, {{"pitch_m", {8e-6}}})),
      "expected the key \"distances_m\", which is missing; add it in SI units, as an attribute of \"focal_stack\"");
  EXPECT_EQ(error(make_hdf5({1, 1, 1}, one, {{"pitch_m", {8e-6}}, {"distances_m", {0.3, 0.4}}})),
            "expected 1 number(s) in \"distances_m\", one per plane, got 2");
  EXPECT_EQ(error(make_hdf5({1, 1, 1}, one, {{"pitch_m", {8e-6}}, {"distances_m", {0}}})),
            "expected plane 1 of the focal stack behind the panel or in front of it, got 0 m");
  for (const double value : {-1.0, std::nan(""), double(INFINITY)})
    EXPECT_NE(error(make_hdf5({1, 1, 1}, {value}, {{"pitch_m", {8e-6}}, {"distances_m", {0.3}}}))
                  .find("expected finite radiance of 0 or more in plane 1"),
              std::string::npos);
  EXPECT_NE(error(make_hdf5({3, 1, 2}, {1, 2, 0, -3, 1, 1}, {{"pitch_m", {8e-6}}, {"distances_m", {0.3, 0.4, 0.5}}}))
                .find("expected finite radiance of 0 or more in plane 2 of the focal stack, got -3"),
            std::string::npos);
  for (const std::vector<hsize_t>& shape : {std::vector<hsize_t>{1}, {2, 2}, {1, 1, 1, 2}, {1, 0, 1}, {0, 2, 2}})
    EXPECT_NE(error(make_hdf5(shape, {}, {})).find("expected the shape (planes, rows, columns)"), std::string::npos);
  // Never written samples take no room in the file.
  EXPECT_NE(error(make_hdf5({1, 1000, 1}, {}, {})).find("expected 1000 samples, got 0 bytes of them"),
            std::string::npos);
  EXPECT_NE(error(make_file("damaged.h5", "\x89HDF\r\n\x1a\n")), "");
  EXPECT_EQ(error_of([&] { load_focal_stack("/nowhere/stack.h5"); }).find("expected a focal stack"), 0u)
      << error_of([&] { load_focal_stack("/nowhere/stack.h5"); });
}

TEST(FocalStackFile, OnlyWholeStacksAreSaved) {
  FocalStack stack = some_stack(1);
  EXPECT_EQ(error_of([&] { save_focal_stack(temporary("stack.npy"), stack); }).find("expected .h5 for a focal stack"),
            0u);
  stack.pictures.pop_back();
  EXPECT_EQ(error_of([&] { save_focal_stack(temporary("stack.h5"), stack); }),
            "expected a picture for each of the 2 planes of the focal stack, got 1");
}

}  // namespace
}  // namespace holotrace
