#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>
#include <vector>

#include "holotrace/io/field/field_file.h"
#include "holotrace/io/files/file.h"
#include "support/temporary.h"

namespace holotrace {
namespace {

using test::make_file;
using test::temporary;

template <class Real>
BasicField<Real> some_field(bool with_filter = true) {
  BasicField<Real> field({3, 2, 8e-6}, 632.8e-9, -0.3);
  for (int i = 0; i < 6; ++i) field.samples.values[size_t(i)] = {Real(0.1) * Real(i), Real(-1) / Real(i + 3)};
  field.image = ImageSide::real_image;
  if (with_filter) field.filter = SpectralFilter{31250.5, 0, 1e4, 62500};
  if (with_filter) field.label.cone_wavelength = 450.7e-9;  // otherwise its own, as in older files without this key
  return field;
}

// Equality is exact: every format keeps all bits of samples and metadata.
template <class Real>
void expect_equal(const BasicField<Real>& a, const BasicField<Real>& b) {
  EXPECT_EQ(a.grid, b.grid);
  EXPECT_EQ(a.wavelength, b.wavelength);
  EXPECT_EQ(a.z, b.z);
  EXPECT_EQ(a.image, b.image);
  EXPECT_EQ(a.filter, b.filter);
  EXPECT_EQ(a.label.cone_wavelength, b.label.cone_wavelength);
  EXPECT_EQ(a.samples.values, b.samples.values);
}

const char* const sidecar_text = R"({"pitch_m": 8e-6, "wavelengths_m": [532e-9], "z_m": 0.0, "image": "virtual"})";

// A .npy file with this dictionary and these data bytes.
std::string npy(std::string dictionary, const std::string& data) {
  dictionary += '\n';
  return std::string("\x93NUMPY\x01\x00", 8) + char(dictionary.size()) + '\0' + dictionary + data;
}

std::string make_npy(const std::string& dictionary, const std::string& data) {
  const std::string path = make_file("f.npy", npy(dictionary, data));
  make_file("f.json", sidecar_text);
  return path;
}

class FieldFile : public ::testing::TestWithParam<const char*> {};

TEST_P(FieldFile, AFieldComesBackAsSaved) {
  for (bool with_filter : {false, true}) {
    const std::string path = temporary(std::string("field") + GetParam());
    const Field field = some_field<float>(with_filter);
    save_field(path, field);
    expect_equal(load_field(path), field);
    expect_equal(load_field_double(path), convert<double>(field));  // float to double is exact
  }
}

TEST_P(FieldFile, ADoubleFieldComesBackAsSaved) {
  const std::string path = temporary(std::string("field") + GetParam());
  const FieldDouble field = some_field<double>();
  if (std::string(GetParam()) == ".exr") {
    EXPECT_EQ(error_of([&] { save_field(path, field); }),
              "expected .npy or .h5 for a field in double precision, got " + path + "; .exr holds single precision");
    return;
  }
  save_field(path, field);
  expect_equal(load_field_double(path), field);
  expect_equal(load_field(path), convert<float>(field));
}

TEST_P(FieldFile, AFieldOffTheAxisKeepsItsCentre) {
  const std::string path = temporary(std::string("shifted") + GetParam());
  Field field = some_field<float>();
  field.grid.centre_x = -1.25e-3;
  field.grid.centre_y = 3e-5;
  save_field(path, field);
  expect_equal(load_field(path), field);
  field.grid.centre_x = 0;
  field.grid.centre_y = 0;
  save_field(path, field);  // without a centre, as in older files
  expect_equal(load_field(path), field);
}

TEST_P(FieldFile, TheSameFieldGivesTheSameBytes) {
  const std::string a = temporary(std::string("a") + GetParam()), b = temporary(std::string("b") + GetParam());
  save_field(a, some_field<float>());
  save_field(b, some_field<float>());
  EXPECT_EQ(read_text(a), read_text(b));
}

TEST_P(FieldFile, SamplesThatAreNotFiniteAreRefused) {
  const std::string path = temporary(std::string("field") + GetParam());
  Field field = some_field<float>();
  field.samples(1, 2) = {std::nanf(""), 1};
  save_field(path, field);
  EXPECT_EQ(error_of([&] { load_field(path); }), path + ": expected finite samples, got nan + 1i at row 1, column 2");
}

TEST_P(FieldFile, ATruncatedFileIsRefused) {
  const std::string path = temporary(std::string("field") + GetParam());
  Field field({64, 64, 8e-6}, 532e-9);
  for (size_t i = 0; i < field.samples.size(); ++i) field.samples.values[i] = std::sin(float(i * i));
  save_field(path, field);
  std::filesystem::resize_file(path, std::filesystem::file_size(path) * 3 / 4);
  const std::string error = error_of([&] { load_field(path); });
  EXPECT_TRUE(error.starts_with(path + ": expected ")) << error;
  EXPECT_NE(error.find("truncated"), std::string::npos) << error;
}

TEST_P(FieldFile, AFileOfOtherBytesIsRefused) {
  const std::string path =
      make_file(std::string("field") + GetParam(), "not a field at all, only a text of some length");
  const std::string error = error_of([&] { load_field(path); });
  EXPECT_TRUE(error.starts_with(path + ": expected ")) << error;
}

TEST_P(FieldFile, AMissingFileIsNamed) {
  const std::string path = temporary(std::string("none") + GetParam());
  EXPECT_EQ(error_of([&] { load_field(path); }),
            "expected a field at " + path + ", but there is no such file; check the path");
}

TEST_P(FieldFile, AFieldInColourComesBackAsSaved) {
  const std::string path = temporary(std::string("field") + GetParam());
  std::vector<Field> stack(3, some_field<float>());
  for (size_t n = 0; n < 3; ++n) {
    stack[n].wavelength = (638 - 90.0 * double(n)) * 1e-9;
    stack[n].samples(1, 2) = {float(n), 7};
    stack[n].label.name = "ED*L";
    stack[n].label.frame = 5;
  }
  if (std::string(GetParam()) == ".exr") {
    EXPECT_EQ(error_of([&] { save_fields(path, stack); }),
              "expected .npy or .h5 for a field of 3 wavelengths, got " + path + "; .exr holds one");
    stack.resize(1);
  }
  save_fields(path, stack);
  const std::vector<Field> loaded = load_fields(path);
  ASSERT_EQ(loaded.size(), stack.size());
  for (size_t n = 0; n < stack.size(); ++n) {
    expect_equal(loaded[n], stack[n]);
    EXPECT_EQ(loaded[n].label.name, "ED*L");
    EXPECT_EQ(loaded[n].label.frame, 5u);
  }
  const std::vector<FieldDouble> wide = load_fields_double(path);
  ASSERT_EQ(wide.size(), stack.size());
  for (size_t n = 0; n < stack.size(); ++n) expect_equal(wide[n], convert<double>(stack[n]));
  const std::string bytes = read_text(path);
  save_fields(path, loaded);
  EXPECT_EQ(read_text(path), bytes);
  if (stack.size() > 1) {
    EXPECT_EQ(error_of([&] { load_field(path); }),
              path + ": expected a field of one wavelength, got 3; save each as its own field");
    std::filesystem::resize_file(path, std::filesystem::file_size(path) - 20);
    EXPECT_NE(error_of([&] { load_fields(path); }).find("truncated"), std::string::npos);
  }
}

INSTANTIATE_TEST_SUITE_P(Formats, FieldFile, ::testing::Values(".npy", ".h5", ".exr"),
                         [](const auto& info) { return std::string(info.param + 1); });

// numpy.save of a transposed array: the first index varies fastest (numpy.lib.format, "fortran_order").
// Fields of two runs keep to different cones; the view of each needs its own.
TEST_P(FieldFile, EveryFieldOfAStackKeepsItsOwnCone) {
  const std::string path = temporary(std::string("stack") + GetParam());
  if (path.ends_with(".exr")) return;  // holds one field
  std::vector<Field> stack{some_field<float>(), some_field<float>(), some_field<float>()};
  for (size_t n = 0; n < 3; ++n) stack[n].wavelength = (630 - 90.0 * double(n)) * 1e-9;
  stack[1].label.cone_wavelength = 0;
  stack[2].label.cone_wavelength = 449e-9;
  save_fields(path, stack);
  const std::vector<Field> again = load_fields(path);
  ASSERT_EQ(again.size(), 3u);
  for (size_t n = 0; n < 3; ++n) expect_equal(again[n], stack[n]);
}

TEST(NpyFile, InFortranOrderIsReadAsNumpyHasIt) {
  const auto sample = [](int n, int j, int i) { return std::complex<double>(100 * n + 10 * j + i, -i); };
  const auto bytes_of = [&](int count) {  // of shape (count, 2, 3)
    std::string bytes;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 2; ++j)
        for (int n = 0; n < count; ++n) {
          const std::complex<double> value = sample(n, j, i);
          bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
        }
    return bytes;
  };
  const std::string one = make_npy("{'descr': '<c16', 'fortran_order': True, 'shape': (2, 3), }", bytes_of(1));
  const FieldDouble field = load_field_double(one);
  for (int j = 0; j < 2; ++j)
    for (int i = 0; i < 3; ++i) EXPECT_EQ(field.samples(j, i), sample(0, j, i)) << j << " " << i;

  const std::string several = make_npy("{'descr': '<c16', 'fortran_order': True, 'shape': (4, 2, 3), }", bytes_of(4));
  make_file("f.json",
            R"({"pitch_m": 8e-6, "wavelengths_m": [1e-7, 2e-7, 3e-7, 4e-7], "z_m": 0.0, "image": "virtual"})");
  const std::vector<Field> stack = load_fields(several);
  ASSERT_EQ(stack.size(), 4u);
  for (int n = 0; n < 4; ++n)
    for (int j = 0; j < 2; ++j)
      for (int i = 0; i < 3; ++i)
        EXPECT_EQ(stack[size_t(n)].samples(j, i), std::complex<float>(sample(n, j, i))) << n << " " << j << " " << i;
}

// numpy.lib.format: magic, version 1.0, a little-endian length, and a dictionary padded so that the
// data starts at a multiple of 64 bytes.
TEST(NpyFile, TheHeaderIsNumpys) {
  const std::string path = temporary("f.npy");
  save_field(path, some_field<float>());
  const std::string bytes = read_text(path);
  const std::string dictionary = "{'descr': '<c8', 'fortran_order': False, 'shape': (2, 3), }";
  std::string expected = std::string("\x93NUMPY\x01\x00\x76\x00", 10) + dictionary;  // 0x76 = 128 − 10
  expected.resize(127, ' ');
  expected += '\n';
  EXPECT_EQ(bytes.substr(0, 128), expected);
  EXPECT_EQ(bytes.size(), 128u + 6 * 8);

  const std::string wide = temporary("g.npy");
  save_field(wide, some_field<double>());
  EXPECT_NE(read_text(wide).find("'descr': '<c16'"), std::string::npos);
}

TEST(NpyFile, TheSidecarHasTheGeometryInSiUnits) {
  const std::string path = temporary("f.npy");
  save_field(path, some_field<float>());
  const auto json = nlohmann::json::parse(read_text(sidecar_path(path)));
  EXPECT_EQ(json["pitch_m"], 8e-6);
  EXPECT_EQ(json["wavelengths_m"], nlohmann::json({632.8e-9}));
  EXPECT_EQ(json["z_m"], -0.3);
  EXPECT_EQ(json["image"], "real");
  EXPECT_EQ(json["filter"]["half_v_per_m"], 62500.0);
  save_field(path, some_field<float>(false));
  EXPECT_FALSE(nlohmann::json::parse(read_text(sidecar_path(path))).contains("filter"));
}

TEST(NpyFile, ALeadingAxisOfOneWavelengthIsTaken) {
  const Field field =
      load_field(make_npy("{'descr': '<c8', 'fortran_order': False, 'shape': (1, 2, 3), }", std::string(6 * 8, '\0')));
  EXPECT_EQ(field.grid, (Grid{3, 2, 8e-6}));
}

// Formats 2 and 3 have a length of four bytes.
TEST(NpyFile, OfLaterFormatsIsRead) {
  std::vector<std::complex<float>> samples;
  for (int i = 0; i < 6; ++i) samples.emplace_back(float(i), -0.5F);
  const std::string data(reinterpret_cast<const char*>(samples.data()), samples.size() * sizeof samples[0]);
  std::string dictionary = "{'descr': '<c8', 'fortran_order': False, 'shape': (2, 3), }";
  dictionary.resize(300, ' ');  // so that the length has more than one byte
  dictionary += '\n';
  for (const char version : {'\x02', '\x03'}) {
    const std::string head = std::string("\x93NUMPY") + version + '\0' + char(dictionary.size() & 255) +
                             char(dictionary.size() >> 8) + '\0' + '\0';
    const std::string path = make_file("f.npy", head + dictionary + data);
    make_file("f.json", sidecar_text);
    const Field field = load_field(path);
    EXPECT_TRUE(std::equal(samples.begin(), samples.end(), field.samples.values.begin())) << int(version);
  }
}

TEST(NpyFile, OtherArraysAreRefused) {
  const std::string data(6 * 8, '\0'), wide(12 * 8, '\0');
  const auto error = [](const std::string& dictionary, const std::string& data) {
    const std::string path = make_npy(dictionary, data);
    return error_of([&] { load_field(path); }).substr(path.size());
  };
  EXPECT_EQ(error("{'descr': '<f8', 'fortran_order': False, 'shape': (2, 3), }", data),
            ": expected complex64 or complex128 ('<c8' or '<c16'), got '<f8'; convert it with numpy.astype");
  EXPECT_EQ(error("{'descr': '<c8', 'fortran_order': False, 'shape': (6,), }", data),
            ": expected the shape (ny, nx) or (wavelengths, ny, nx), got (6,)");
  EXPECT_EQ(error("{'descr': '<c8', 'fortran_order': False, 'shape': (0, 3), }", ""),
            ": expected the shape (ny, nx) or (wavelengths, ny, nx), got (0, 3)");
  EXPECT_EQ(error("{'descr': '<c8', 'fortran_order': False, 'shape': (1073741823, 1073741823, 1073741823), }", wide)
                .substr(0, 10),
            ": expected");
  EXPECT_EQ(
      error("{'descr': '<c8', 'fortran_order': False, 'shape': (2, 4), }", data),
      ": expected 64 bytes of samples for shape (2, 4), got 48; the file is truncated or damaged, write it again");
  EXPECT_EQ(error("{'descr': [('a', '<c8')], 'fortran_order': False, 'shape': (2, 3), }", data).substr(0, 40),
            ": expected complex64 or complex128 ('<c8");
}

TEST(NpyFile, SidecarsAreChecked) {
  const std::string path =
      make_npy("{'descr': '<c8', 'fortran_order': False, 'shape': (2, 3), }", std::string(48, '\0'));
  const std::string sidecar = sidecar_path(path);
  const auto error = [&](const std::string& text) {
    write_text(sidecar, text);
    return error_of([&] { load_field(path); });
  };
  EXPECT_EQ(error(R"({"pitch_m": 8e-6,)"),
            sidecar + ":1: expected valid JSON, but it is truncated or wrong at byte 18; write the file again");
  EXPECT_EQ(error(R"({"wavelengths_m": [532e-9]})"),
            sidecar + ": expected the key \"pitch_m\", which is missing; add it, in SI units");
  EXPECT_EQ(error(R"({"pitch_m": "8 um", "wavelengths_m": [532e-9]})"),
            sidecar + ": expected a number for \"pitch_m\", got \"8 um\"");
  EXPECT_EQ(error(R"({"pitch_m": 8e-6, "wavelengths_m": [532e-9, 638e-9]})"),
            sidecar + ": expected 1 number(s) in \"wavelengths_m\", one per field of the stack, got 2");
  EXPECT_EQ(error(R"({"pitch_m": -8e-6, "wavelengths_m": [532e-9]})"),
            path + ": expected a pixel pitch above 0 m, got -8e-06 m; correct its metadata");
  EXPECT_EQ(error(R"({"pitch_m": 8e-6, "wavelengths_m": [0]})"),
            path + ": expected a wavelength above 0 m, got 0 m; correct its metadata");
  EXPECT_EQ(error(R"({"pitch_m": 8e-6, "wavelengths_m": [532e-9], "image": "reel"})"),
            sidecar + ": unknown image \"reel\"; did you mean \"real\"?");
  std::filesystem::remove(sidecar);
  EXPECT_EQ(error_of([&] { load_field(path); }), "no error") << "f.json, as earlier versions wrote it";
  std::filesystem::remove(old_sidecar_path(path));
  EXPECT_EQ(error_of([&] { load_field(path); }),
            "expected the field's metadata {pitch_m, wavelengths_m, z_m, image} at " + sidecar +
                ", but there is no such file; check the path");
}

TEST(NpyFile, AFieldInColourHasTheShapeOfItsWavelengths) {
  const std::string path = temporary("f.npy");
  std::vector<Field> stack(2, some_field<float>(false));
  stack[1].wavelength = 450e-9;
  save_fields(path, stack);
  EXPECT_NE(read_text(path).find("'shape': (2, 2, 3), }"), std::string::npos);
  EXPECT_EQ(nlohmann::json::parse(read_text(sidecar_path(path)))["wavelengths_m"], nlohmann::json({632.8e-9, 450e-9}));
  save_fields(path, std::vector<Field>(1, stack[0]));  // one: no leading axis
  EXPECT_NE(read_text(path).find("'shape': (2, 3), }"), std::string::npos);
}

TEST(FieldFiles, OnlyFieldsThatDifferInWavelengthMakeAStack) {
  const std::string path = temporary("f.npy");
  const std::vector<std::function<void(Field&)>> changes{
      [](Field& field) { field.grid.pitch *= 2; },
      [](Field& field) { field.z = 0; },
      [](Field& field) {
        field.image = field.image == ImageSide::real_image ? ImageSide::virtual_image : ImageSide::real_image;
      },
      [](Field& field) {
        field.filter = SpectralFilter{1, 2, 3, 4};
      },
      [](Field& field) { field.label.name += "x"; },
      [](Field& field) { ++field.label.frame; }};
  for (const auto& change : changes) {
    std::vector<Field> stack(2, some_field<float>());
    change(stack[1]);
    EXPECT_EQ(error_of([&] { save_fields(path, stack); }),
              "expected fields that differ in wavelength alone to save as " + path +
                  ", got other grids, planes, image sides, filters, names or frames; save each as its own field");
  }
  EXPECT_EQ(error_of([&] { save_fields(path, std::vector<Field>()); }),
            "expected at least one field to save as " + path + ", got none");
}

TEST(FieldFiles, OtherExtensionsAreRefused) {
  const std::string path = make_file("f.txt", "");
  EXPECT_EQ(error_of([&] { save_field(path, some_field<float>()); }),
            "expected a field file .npy, .h5 or .exr, got " + path + "; change its extension");
  EXPECT_EQ(error_of([&] { load_field(path); }),
            path + ": expected a field .npy, .h5, .mat or .exr, got an empty file");
}

}  // namespace
}  // namespace holotrace
