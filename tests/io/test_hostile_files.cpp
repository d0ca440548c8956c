// Files that are damaged on purpose: each reader throws an Error with one sentence, in bounded time and memory.

#include <gtest/gtest.h>
#include <hdf5.h>
#include <sys/stat.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "holotrace/io/describe_file.h"
#include "holotrace/io/field/field_file.h"
#include "holotrace/io/field/hologram_file.h"
#include "holotrace/io/field/light_field_file.h"
#include "holotrace/io/files/file.h"
#include "holotrace/io/files/ply.h"
#include "holotrace/io/mesh/mesh_file.h"
#include "holotrace/io/picture/image_file.h"
#include "holotrace/io/scene/scene_file.h"
#include "support/fields.h"
#include "support/temporary.h"

namespace holotrace {
namespace {

using test::make_file;

// A pipe without a writer: opening it would wait for ever.
std::string make_pipe(const std::string& name) {
  const std::string path = test::temporary(name);
  EXPECT_EQ(mkfifo(path.c_str(), 0600), 0);
  return path;
}

TEST(HostileFiles, PipesAndDevicesAreNotRead) {
  const auto expect_refused = [](const std::string& path) {
    const auto expect = [&](const char* reader, const std::string& error) {
      EXPECT_NE(error.find("only files on a disk are read"), std::string::npos)
          << reader << " " << path << ": " << error;
    };
    expect("text", error_of([&] { read_text(path); }));
    expect("ply", error_of([&] { read_ply(path); }));
    expect("image", error_of([&] { load_image(path); }));
    expect("hologram", error_of([&] { load_hologram(path); }));
    expect("field", error_of([&] { load_fields(path); }));
    expect("stack", error_of([&] { load_focal_stack(path); }));
    expect("mesh", error_of([&] { load_meshes(path); }));
    expect("scene", error_of([&] { load_job(path); }));
    expect("panel", error_of([&] { load_slm(path + ".toml"); }));
    expect("info", error_of([&] { describe_file(path); }));
  };
  for (const char* name : {"p.toml", "p.obj", "p.npy", "p.h5", "p.exr", "p.png", "p.ply", "p.gltf"}) {
    const std::string pipe = make_pipe(name);
    std::filesystem::remove(pipe + ".toml");
    std::filesystem::create_symlink(pipe, pipe + ".toml");
    expect_refused(pipe);
  }
  const std::string device = test::temporary("zero.npy");
  std::filesystem::create_symlink("/dev/zero", device);
  std::filesystem::remove(device + ".toml");
  std::filesystem::create_symlink("/dev/zero", device + ".toml");
  expect_refused(device);
}

// Fields as h5py writes them: texts of variable length, in which one damaged byte crashes libhdf5.
std::string field_hdf5(const std::string& name, const std::function<void(hid_t)>& make_field = {}) {
  const std::string path = test::temporary(name);
  const hid_t file = H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
  make_field(file);
  H5Fclose(file);
  return path;
}

TEST(HostileFiles, DamagedBytesOfHdf5AreReportedOrDoNoHarm) {
  FieldDouble field;
  field.grid = {4, 4, 8e-6};
  field.wavelength = 532e-9;
  field.label.name = "a name";
  field.samples = Array2D<std::complex<double>>(4, 4);
  const std::string path = test::temporary("f.h5");
  save_field(path, field);
  const std::string whole = read_text(path);
  const size_t heap = whole.find("GCOL");  // the texts of variable length, whose lengths libhdf5 trusts
  ASSERT_NE(heap, std::string::npos);
  std::vector<size_t> places;
  for (size_t i = 0; i < whole.size(); i += 101) places.push_back(i);
  for (const size_t i : {24, 31, 52})
    places.push_back(heap + i);  // libhdf5 1.10 hangs at the first, crashes at the rest
  for (const size_t i : places) {
    std::string damaged = whole;
    damaged[i] = char(damaged[i] ^ 0xFF);
    std::ofstream(path, std::ios::binary) << damaged;
    const std::string error = error_of([&] { load_fields(path); });
    EXPECT_TRUE(error == "no error" || error.starts_with(path)) << i << ": " << error;
  }
}

TEST(HostileFiles, Hdf5WithoutSamplesForItsSizeIsRefused) {
  const std::string path = field_hdf5("f.h5", [](hid_t file) {
    const hsize_t shape[] = {1u << 20, 1u << 20}, chunk[] = {1024, 1024};
    const hid_t space = H5Screate_simple(2, shape, nullptr), properties = H5Pcreate(H5P_DATASET_CREATE),
                type = H5Tcreate(H5T_COMPOUND, 8);
    H5Tinsert(type, "r", 0, H5T_IEEE_F32LE);
    H5Tinsert(type, "i", 4, H5T_IEEE_F32LE);
    H5Pset_chunk(properties, 2, chunk);
    H5Dclose(H5Dcreate2(file, "field", type, space, H5P_DEFAULT, properties, H5P_DEFAULT));
  });
  EXPECT_EQ(error_of([&] { load_fields(path); }),
            path + ": expected 1099511627776 samples, got 0 bytes of them; the file is truncated or damaged");
}

TEST(HostileFiles, Hdf5LinksToOtherFilesNeedPermission) {
  FieldDouble field;
  field.grid = {4, 4, 8e-6};
  field.wavelength = 532e-9;
  field.samples = Array2D<std::complex<double>>(4, 4);
  const std::string other = test::temporary("other.h5");
  save_field(other, field);
  const std::string path = field_hdf5("link.h5", [&](hid_t file) {
    H5Lcreate_external(other.c_str(), "field", file, "field", H5P_DEFAULT, H5P_DEFAULT);
  });
  EXPECT_EQ(error_of([&] { load_fields(path); }),
            path +
                ": expected the dataset \"field\", got a link to another file; copy it into this one, or give "
                "--allow-outside");
  EXPECT_EQ(load_fields(path, Outside::allowed).size(), 1u);
}

// A PNG of that size without pixels.
std::string empty_png(uint32_t side) {
  const auto word = [](uint32_t v) { return std::string{char(v >> 24), char(v >> 16), char(v >> 8), char(v)}; };
  const auto chunk = [&](const std::string& kind, const std::string& data) {
    uint32_t crc = ~0u;
    for (const char c : kind + data) {
      crc ^= static_cast<unsigned char>(c);
      for (int k = 0; k < 8; ++k) crc = crc & 1 ? 0xEDB88320u ^ crc >> 1 : crc >> 1;
    }
    return word(uint32_t(data.size())) + kind + data + word(~crc);
  };
  return "\x89PNG\r\n\x1a\n" + chunk("IHDR", word(side) + word(side) + std::string("\x10\x06\0\0\0", 5)) +
         chunk("IDAT", "") + chunk("IEND", "");
}

TEST(HostileFiles, PicturesThatClaimHugeSizesAreRefused) {
  const std::string png = make_file("p.png", empty_png(60000));  // 26.8 GiB as stored
  const std::string expected =
      ": expected a picture, but its header claims 60000 × 60000 pixels of 4 channels, too many";
  EXPECT_TRUE(error_of([&] { load_image(png); }).starts_with(png + expected)) << error_of([&] { load_image(png); });
  EXPECT_TRUE(error_of([&] { load_hologram(png); }).starts_with(png + expected));
  const std::string bytes = empty_png(60000);
  EXPECT_TRUE(error_of([&] { decode_image(bytes.data(), bytes.size(), "p"); }).starts_with("p" + expected));
  const std::string hdr = make_file("p.hdr", "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 60000 +X 60000\n");
  EXPECT_NE(error_of([&] { load_image(hdr); }).find("its header claims 60000 × 60000 pixels"), std::string::npos);
}

TEST(HostileFiles, MetadataIsLimitedInDepthAndRange) {
  std::string header = "{'descr': '<c8', 'fortran_order': False, 'shape': (1, 1), }";
  header.resize(117, ' ');
  const std::string npy = std::string("\x93NUMPY\x01\x00\x76\x00", 10) + header + "\n" + std::string(8, '\0');
  const std::string path = make_file("f.npy", npy), sidecar = std::filesystem::path(path).replace_extension(".json");
  const auto with = [&](const std::string& json) {
    std::ofstream(sidecar) << json;
    return error_of([&] { load_fields(path); });
  };
  EXPECT_EQ(with(R"({"pitch_m": 8e-6, "wavelengths_m": [532e-9]})"), "no error");
  EXPECT_EQ(with("{\"pitch_m\": " + std::string(200000, '[')),
            sidecar + ":1: expected at most 64 levels of nesting, got more; write the file with fewer levels");
  EXPECT_EQ(with(R"({"pitch_m": 1e400, "wavelengths_m": [532e-9]})"),
            sidecar + ":1: expected numbers below 1.8e308, got 1e400; write the file again");
}

// Found by fuzzing: other exceptions than Error left these readers.
TEST(HostileFiles, ShortHeadersAreRefused) {
  for (const char* bytes : {"RIFF", "RIFF1", "BM", "\x89PNG", "MM", "#?RGBE"}) {
    const std::string path = make_file("p.png", bytes);
    EXPECT_TRUE(error_of([&] { load_image(path); }).starts_with(path + ": expected an image")) << bytes;
  }
  const std::string npy = make_file("f.npy", std::string("\x93NUMPY\x01\x00\x09\x00'descr':  ", 20));
  EXPECT_EQ(error_of([&] { load_fields(npy); }), npy + ": expected a type such as '<c8' in the .npy header, got none");
  std::string shape = "{'descr': '<c8', 'fortran_order': False, 'shape': (" + std::string(60000, '9') + ", 1), }";
  const std::string size{char(shape.size() & 255), char(shape.size() >> 8)};
  const std::string large = make_file("f.npy", std::string("\x93NUMPY\x01\x00", 8) + size + shape);
  EXPECT_EQ(error_of([&] { load_fields(large); }),
            large + ": expected the shape (ny, nx) or (wavelengths, ny, nx), got (-1, 1)");
}

}  // namespace
}  // namespace holotrace
