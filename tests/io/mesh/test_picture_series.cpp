#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <string>

#include "holotrace/io/files/series.h"
#include "holotrace/io/mesh/mesh_file.h"
#include "holotrace/io/mesh/picture_mesh.h"
#include "holotrace/io/picture/animation.h"
#include "holotrace/io/picture/formats/formats.h"
#include "holotrace/io/picture/image_file.h"
#include "holotrace/io/scene/scene_file.h"
#include "support/error_of.h"
#include "support/temporary.h"

// Series of meshes and pictures, and films, as what moves in a scene.

namespace holotrace {
namespace {

using test::make_file;
using test::temporary;

Image grey(int nx, int ny, float value) {
  Image image(ny, nx, 1);
  std::fill(image.values.begin(), image.values.end(), value);
  return image;
}

// A picture whose number is that of its bright column.
Image bar(int column, int channels = 3) {
  Image image(16, 32, channels);
  for (int j = 0; j < image.ny; ++j)
    for (int i = 4 * column; i < 4 * column + 4; ++i)
      for (int c = 0; c < channels; ++c) image(j, i, c) = 1;
  return image;
}

// File k is there from k/fps on; times k/fps are not exact in binary: 0.29 · 100 is below 29.
TEST(Series, AFileIsThereFromItsTimeOn) {
  std::string folder;
  for (int k = 0; k < 99; ++k)
    folder = std::filesystem::path(make_file(fmt::format("k_{:02}.txt", k), "")).parent_path();
  const auto number_at = [&](const SeriesTime& time) {
    return std::stoi(std::filesystem::path(file_at(folder + "/k_##.txt", time).path).stem().string().substr(2));
  };
  EXPECT_EQ(number_at({0.7, 10}), 7);
  EXPECT_EQ(number_at({0.29, 100}), 29);
  EXPECT_EQ(number_at({0.69, 10}), 6);
  EXPECT_EQ(number_at({-3, 10}), 0);
  EXPECT_EQ(number_at({999, 10}), 98);
  EXPECT_EQ(number_at({99.95, 10, true}), 9);  // 999 = 10·99 + 9
  EXPECT_EQ(number_at({-0.05, 10, true}), 98);
}

TEST(Series, BeginsAtAnyNumberAndHasNoGap) {
  const std::string folder = std::filesystem::path(make_file("m_098.txt", "")).parent_path();
  for (const char* name : {"m_099.txt", "m_100.txt", "m_0101.txt", "m_1x1.txt", "mm_101.txt", "m_101.txt.old"})
    make_file(name, "");
  const std::string series = folder + "/m_###.txt";
  EXPECT_EQ(file_at(series, {0, 2}).path, folder + "/m_098.txt");
  EXPECT_EQ(file_at(series, {1, 2}).path, folder + "/m_100.txt");
  EXPECT_EQ(file_at(series, {1, 2}).end, 1.5);  // three files of 1/2 s
  EXPECT_EQ(file_at(folder + "/m_098.txt", {}).end, std::nullopt);
  std::filesystem::remove(folder + "/m_099.txt");
  EXPECT_EQ(error_of([&] { file_at(series, {}); }),
            series + ": expected a series without gaps, but " + folder + "/m_099.txt is missing");
  EXPECT_EQ(
      error_of([&] { file_at(folder + "/n_##.txt", {}); }),
      folder + "/n_##.txt: expected files with a number in place of the #, such as " + folder + "/n_01.txt, got none");
}

// A file of that very name is no series: scenes and models may have # in their names.
TEST(Series, AFileOfThatNameGoesFirst) {
  const std::string path = make_file("part##2.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  EXPECT_EQ(file_at(path, {1, 2}).path, path);
  EXPECT_FALSE(file_at(path, {1, 2}).end);
  EXPECT_EQ(load_meshes(path).meshes.size(), 1U);
}

// A picture is shown from its own time to that of the next one, on a clock that begins with the first; the last is as long as the others
// in the mean: 4 pictures in 5 s, 5 · 4/3 s.
TEST(Films, PicturesHaveTheirOwnTimes) {
  const FilmFacts film{{1, 1.25, 1.5, 6}, 0.5};
  EXPECT_EQ(film.number_at(-1, false), 0u);
  EXPECT_EQ(film.number_at(0.24, false), 0u);
  EXPECT_EQ(film.number_at(0.25, false), 1u);
  EXPECT_EQ(film.number_at(4.9, false), 2u);
  EXPECT_EQ(film.number_at(5, false), 3u);
  EXPECT_EQ(film.number_at(100, false), 3u);
  EXPECT_DOUBLE_EQ(film.end(), 20 / 3.0);
  EXPECT_EQ(film.number_at(20 / 3.0 + 0.3, true), 1u);
  EXPECT_EQ((FilmFacts{{0}, 0}.end()), 0);
}

// Triangle k has its corner at x = k.
TEST(Series, MeshesAreAnAnimation) {
  std::string folder;
  for (int k = 1; k <= 3; ++k) {
    const std::string x = std::to_string(k);
    folder = std::filesystem::path(make_file("wave_0" + x + ".obj", "v " + x + " 0 0\nv 9 0 0\nv 0 9 0\nf 1 2 3\n"))
                 .parent_path();
  }
  const std::string scene = make_file("scene.toml",
                                      "wavelength = \"532 nm\"\n[[object]]\ntype = \"mesh\"\nfile = \"wave_##.obj\"\n"
                                      "series_fps = 4\nscale = 0.001\nposition = \"0 0 -300 mm\"\n");
  const auto corner = [&](double time) {
    return load_job(scene, Outside::refused, {}, "", time).scene.meshes.at(0).positions.at(0).x * 1e3;
  };
  EXPECT_DOUBLE_EQ(corner(0), 1);
  EXPECT_DOUBLE_EQ(corner(0.3), 2);
  EXPECT_DOUBLE_EQ(corner(0.5), 3);
  EXPECT_DOUBLE_EQ(corner(7), 3);
  EXPECT_EQ(load_job(scene).last_key, 0.75);
  // By itself a series is placed as its first model: the second one has its corner, 1 of 9 wide, elsewhere.
  ModelParams params;
  params.series_fps = 4;
  params.rotation = {"y 0 deg"};
  const auto alone = [&](double time) { return load_job(folder + "/wave_##.obj", Outside::refused, params, "", time); };
  const auto at = [&](double time, size_t i) { return alone(time).scene.meshes.at(0).positions.at(i); };
  EXPECT_EQ(alone(0).last_key, 0.75);
  EXPECT_LT(length(at(0, 1) - at(0.3, 1)), 1e-15);
  EXPECT_NEAR(length(at(0, 0) - at(0.3, 0)) / length(at(0, 2) - at(0, 1)), 1 / std::hypot(9, 9), 1e-12);
}

// A flat picture of 32 × 16 pixels, 8 mm wide, is a rectangle of 8 × 4 mm whose upper left corner has the texture's.
TEST(Pictures, APictureIsARectangleThatShines) {
  const std::string path = temporary("bar.png");
  save_image(path, bar(2), 1, 8);
  const LoadedModel model = load_picture({path}, 8e-3);
  ASSERT_EQ(model.meshes.size(), 1U);
  const Mesh& mesh = model.meshes[0];
  ASSERT_EQ(mesh.triangles.size(), 2U);
  for (size_t i = 0; i < 4; ++i) {
    const Vec2 uv = mesh.texture_coordinates[i];
    EXPECT_LT(length(mesh.positions[i] - Vec3{8e-3 * (uv.x - 0.5), 4e-3 * (uv.y - 0.5), 0}), 1e-18);
  }
  const auto& [a, b, c] = mesh.triangles[0];
  EXPECT_GT(cross(mesh.positions[b] - mesh.positions[a], mesh.positions[c] - mesh.positions[a]).z, 0);  // faces +z
  EXPECT_EQ(model.materials.at(0).emission, (Vec3{1, 1, 1}));
  EXPECT_EQ(model.materials[0].emission_texture->values, bar(2).values);
  EXPECT_FALSE(model.last_key.has_value());
}

// Grey 0, 0.4, 0.8, 1 of 8 bits between black at 200 mm and white at 100 mm; each pixel is a square of 1 mm.
TEST(Pictures, DepthsPlaceEachPixel) {
  const std::string picture = temporary("p_01.exr"), depth = temporary("d_01.png");
  save_image(picture, grey(2, 2, 0.5F), 1, 8);
  Image depths(2, 2, 1);
  const double greys[] = {0, 102.0 / 255, 204.0 / 255, 1};
  for (size_t i = 0; i < 4; ++i) depths.values[i] = float(srgb_decode(greys[i]));
  save_image(depth, depths, 1, 8);
  const std::string scene = make_file("scene.toml",
                                      "wavelength = \"532 nm\"\n[[object]]\ntype = \"picture\"\nfile = \"p_##.exr\"\n"
                                      "depth = \"d_##.png\"\nnear = \"100 mm\"\nfar = \"200 mm\"\nwidth = \"2 mm\"\n");
  const Job job = load_job(scene);
  const Mesh& mesh = job.scene.meshes.at(0);
  ASSERT_EQ(mesh.triangles.size(), 8U);
  EXPECT_EQ(job.last_key, 1 / 25.0);
  for (size_t i = 0; i < 4; ++i) {
    const Vec3 low = mesh.positions[4 * i], high = mesh.positions[4 * i + 2];
    EXPECT_NEAR(-low.z, 0.2 - 0.1 * greys[i], 2e-8);  // depths are floats
    EXPECT_LT(length(low - Vec3{i % 2 == 0 ? -1e-3 : 0, i < 2 ? 0 : -1e-3, low.z}), 1e-18) << i;
    EXPECT_LT(length(high - low - Vec3{1e-3, 1e-3, 0}), 1e-18);
  }
  std::filesystem::copy_file(depth, std::filesystem::path(depth).parent_path() / "d_02.png");
  EXPECT_NE(error_of([&] { load_job(scene); }).find("expected depths for as long as the pictures"), std::string::npos);
}

// By itself a film fills 0.8 of the view in its middle, 300 mm behind pluto, in three colours, and ends with its last picture.
// Bars of 4 pixels survive the compression: the one that is lit has more than half of the light.
TEST(Pictures, AFilmShowsItsPictures) {
  if (std::system("ffmpeg -version > /dev/null 2>&1") != 0) GTEST_SKIP() << "ffmpeg is not installed";
  for (const char* name : {"bars.mp4", "bars.webm", "bars.gif"}) {
    const std::string path = temporary(name);
    save_film(path, {8, [](size_t i) { return bar(int(i)); }}, 10);
    for (const int k : {0, 3, 7}) {
      const Job job = load_job(path, Outside::refused, {}, "", (k + 0.5) / 10);
      const Image& seen = *job.scene.materials.at(0).emission_texture;
      ASSERT_EQ(seen.nx, 32);
      EXPECT_GT(seen(8, 4 * k + 1, 1), 0.5F) << name << k;
      for (int other = 0; other < 8; ++other) EXPECT_TRUE(other == k || seen(8, 4 * other + 1, 1) < 0.2F) << name << k;
      EXPECT_EQ(job.wavelengths.size(), 3U);
      EXPECT_NEAR(*job.last_key, 0.8, 1e-9);
      const Vec3 corner = job.scene.meshes.at(0).positions.at(1);
      EXPECT_LT(length(corner - Vec3{0.4 * job.slm.grid.width(), -0.2 * job.slm.grid.width(), -0.3}), 1e-15);
    }
  }
  EXPECT_NE(error_of([&] { load_job(make_file("no.mp4", "no film")); }).find("expected a film that ffprobe can read"),
            std::string::npos);
}

TEST(Pictures, WithoutFfmpegItSaysWhatToInstall) {
  const std::string path = make_file("film.mp4", "");
  const std::string before = std::getenv("PATH");
  setenv("PATH", std::string(std::filesystem::path(path).parent_path()).c_str(), 1);
  const std::string error = error_of([&] { load_image_at(path, {}); });
  setenv("PATH", before.c_str(), 1);
  EXPECT_EQ(error,
            "expected the program ffprobe to read " + path +
                " with, got \"No such file or directory\"; install it (Debian: ffmpeg), or give a series of pictures");
}

}  // namespace
}  // namespace holotrace
