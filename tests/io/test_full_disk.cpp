// A disk that is full at any byte: each writer says so, leaves no part of a file, and keeps the old one.

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>

#include <filesystem>
#include <functional>

#include "holotrace/io/calibration/calibration_files.h"
#include "holotrace/io/field/field_file.h"
#include "holotrace/io/field/hologram_file.h"
#include "holotrace/io/field/light_field_file.h"
#include "holotrace/io/field/sources_file.h"
#include "holotrace/io/files/file.h"
#include "holotrace/io/picture/animation.h"
#include "holotrace/io/picture/chart_file.h"
#include "holotrace/io/picture/image_file.h"
#include "holotrace/io/run_folder.h"
#include "support/panels.h"
#include "support/temporary.h"

namespace holotrace {
namespace {

namespace fs = std::filesystem;

// While it exists, files end at `bytes`: a write beyond fails with EFBIG, as one to a full disk does with ENOSPC.
class FullDisk {
 public:
  explicit FullDisk(rlim_t bytes) {
    signal(SIGXFSZ, SIG_IGN);
    getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit limit{bytes, before_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FullDisk() { setrlimit(RLIMIT_FSIZE, &before_); }
  FullDisk(const FullDisk&) = delete;

 private:
  rlimit before_{};
};

using Save = std::function<void(const std::string& path)>;

struct Writer {
  const char* name;  // of the file
  Save save;
};

Image picture(int channels) {
  Image image(24, 32, channels);
  for (size_t i = 0; i < image.values.size(); ++i)
    image.values[i] = float((i * 7919) % 251) / 251;  // does not compress
  return image;
}

Field field() {
  Field field;
  field.grid = {32, 24, 8e-6};
  field.wavelength = 532e-9;
  field.samples = Array2D<std::complex<float>>(24, 32);
  for (size_t i = 0; i < field.samples.size(); ++i) field.samples.values[i] = {float((i * 7919) % 251), 1};
  return field;
}

Hologram hologram() {
  Hologram hologram;
  hologram.grid = {32, 24, 8e-6};
  hologram.wavelength = 532e-9;
  hologram.level = Array2D<uint16_t>(24, 32);
  for (size_t i = 0; i < hologram.level.size(); ++i) hologram.level.values[i] = uint16_t((i * 7919) % 251);
  return hologram;
}

Sources sources() {
  Sources sources;
  sources.wavelength = 532e-9;
  sources.waves.assign(50, {{0, 0, -0.1}, 1, 0});
  return sources;
}

Chart chart() {
  Chart chart;
  chart.title = "title";
  chart.x_label = chart.y_label = "length";
  chart.series = {{.name = "a", .x = {1, 2, 3}, .y = {1, 4, 9}}};
  return chart;
}

FocalStack stack() {
  FocalStack stack;
  stack.grid = {32, 24, 8e-6};
  stack.distances = {0.1, 0.2};
  stack.pictures = {picture(3), picture(3)};
  return stack;
}

void save_sweep(const std::string& path) { save_animation(path, {picture(3), picture(1)}, 1, 1); }

bool has_program(const std::string& name) { return std::system((name + " > /dev/null 2>&1").c_str()) == 0; }

std::vector<Writer> writers() {
  return {
      {"picture_8.png", [](const std::string& path) { save_image(path, picture(3), 1, 8); }},
      {"picture_16.png", [](const std::string& path) { save_image(path, picture(1), 1, 16); }},
      {"picture.exr", [](const std::string& path) { save_image(path, picture(3), 1, 8); }},
      {"picture.jpg", [](const std::string& path) { save_image(path, picture(3), 1, 8); }},
      {"sweep.gif", save_sweep},
      {"sweep.webp", save_sweep},
      {"sweep.mp4", save_sweep},
      {"chart.svg", [](const std::string& path) { save_chart(path, chart()); }},
      {"chart.png", [](const std::string& path) { save_chart(path, chart()); }},
      {"hologram.png", [](const std::string& path) { save_hologram(path, hologram()); }},
      {"field.npy", [](const std::string& path) { save_field(path, field()); }},
      {"field.h5", [](const std::string& path) { save_field(path, field()); }},
      {"field.exr", [](const std::string& path) { save_field(path, field()); }},
      {"stack.h5", [](const std::string& path) { save_focal_stack(path, stack()); }},
      {"sources.ply", [](const std::string& path) { save_sources(path, sources()); }},
      {"report.json",
       [](const std::string& path) {
         save_report(path, {}, {{"view.png", 7}});
       }},
      {"panel.toml", [](const std::string& path) { save_panel(path, make_panel(32, 24)); }},
  };
}

// For the names of tests.
void PrintTo(const Writer& writer, std::ostream* out) { *out << writer.name; }

class FullDiskFor : public ::testing::TestWithParam<Writer> {};

TEST_P(FullDiskFor, AnyByteLeavesTheOldFileAndSaysWhy) {
  const fs::path folder = test::temporary("folder");
  fs::create_directory(folder);
  const std::string path = (folder / GetParam().name).string();
  if (std::string(GetParam().name).starts_with("chart") && !has_program("gnuplot --version"))
    GTEST_SKIP() << "gnuplot draws the charts";
  if (std::string(GetParam().name) == "sweep.mp4" && !has_program("ffmpeg -version"))
    GTEST_SKIP() << "ffmpeg writes the films";
  GetParam().save(path);
  const std::string whole = read_text(path);
  const size_t files = size_t(std::distance(fs::directory_iterator(folder), {}));
  // The first and last bytes one by one, and 20 places between.
  const size_t step = std::max<size_t>(1, whole.size() / 20);
  for (size_t at = 0; at < whole.size();
       at += at < 3 || at + 3 >= whole.size() ? 1 : std::min(step, whole.size() - 3 - at)) {
    std::string error;
    {
      const FullDisk disk(at);
      error = error_of([&] { GetParam().save(path); });
    }
    EXPECT_NE(error.find("expected"), std::string::npos) << at << ": " << error;
    EXPECT_NE(error.find(GetParam().name), std::string::npos) << at << ": " << error;
    EXPECT_EQ(error.find(".holotrace-"), std::string::npos) << at << ": " << error;
    EXPECT_TRUE(read_text(path) == whole) << at;
    EXPECT_EQ(size_t(std::distance(fs::directory_iterator(folder), {})), files) << at;
  }
  GetParam().save(path);  // and the next one succeeds
  EXPECT_TRUE(read_text(path) == whole);
}

INSTANTIATE_TEST_SUITE_P(Writers, FullDiskFor, ::testing::ValuesIn(writers()), [](const auto& info) {
  std::string name = info.param.name;
  for (char& c : name)
    if (c == '.') c = '_';
  return name;
});

}  // namespace
}  // namespace holotrace
