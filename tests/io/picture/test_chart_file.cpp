#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <limits>

#include "holotrace/io/files/file.h"
#include "holotrace/io/picture/chart_file.h"
#include "holotrace/io/picture/image_file.h"
#include "support/temporary.h"

namespace holotrace::test {
namespace {

Chart sweep() {
  Chart chart;
  chart.title = "PSNR of a focus sweep";
  chart.x_label = "distance [mm]";
  chart.y_label = "PSNR [dB]";
  for (const char* name : {"double-phase", "gerchberg_saxton", "it's $x^2 \"sgd\" `date` é µm"}) {
    Series s;
    s.name = name;
    s.has_markers = chart.series.size() == 1;
    for (int i = 0; i <= 20; ++i) {
      s.x.push_back(290 + i);
      s.y.push_back(20 + 5 * double(chart.series.size()) + 10 * std::exp(-0.1 * (i - 10) * (i - 10)));
    }
    chart.series.push_back(s);
  }
  return chart;
}

Chart of_one_series(const std::vector<double>& x, const std::vector<double>& y) {
  Chart chart;
  chart.title = "T";
  chart.series.push_back({"s", x, y});
  return chart;
}

// Number of pixels of a picture with a colour [0 … 255 per channel].
int count_of(const Image& image, int red, int green, int blue) {
  int count = 0;
  const auto code = [&](int j, int i, int c) { return int(std::lround(255 * srgb_encode(image(j, i, c)))); };
  for (int j = 0; j < image.ny; ++j)
    for (int i = 0; i < image.nx; ++i) count += code(j, i, 0) == red && code(j, i, 1) == green && code(j, i, 2) == blue;
  return count;
}

TEST(ChartFile, APngHasEveryLineInItsColourOnWhite) {
  const std::string path = temporary("sweep.png");
  save_chart(path, sweep());
  const Image image = load_image(path);
  EXPECT_EQ(image.nx, 1200);
  EXPECT_EQ(image.ny, 800);
  EXPECT_GT(count_of(image, 255, 255, 255), 1200 * 800 / 2);
  // A line across the plot is about 1000 pixels long, with at least one pixel in full colour across it.
  EXPECT_GT(count_of(image, 0x00, 0x72, 0xB2), 500);
  EXPECT_GT(count_of(image, 0xD5, 0x5E, 0x00), 500);
  EXPECT_GT(count_of(image, 0x00, 0x9E, 0x73), 500);
}

TEST(ChartFile, ASeriesMayHaveTheColourOfAnother) {
  const std::string path = temporary("same.png");
  Chart chart = sweep();
  chart.series[1].colour = 0;
  save_chart(path, chart);
  const Image image = load_image(path);
  EXPECT_GT(count_of(image, 0x00, 0x72, 0xB2), 1000) << "two lines";
  EXPECT_EQ(count_of(image, 0xD5, 0x5E, 0x00), 0);
}

TEST(ChartFile, AnSvgHasItsWordsAsTheyAre) {
  const std::string path = temporary("sweep.svg");
  save_chart(path, sweep());
  const std::string svg = read_text(path);
  for (const char* words :
       {"PSNR of a focus sweep", "distance [mm]", "PSNR [dB]", "gerchberg_saxton", "it's $x^2 \"sgd\" `date` é µm"})
    EXPECT_NE(svg.find(words), std::string::npos) << words;
}

TEST(ChartFile, TheSameChartGivesTheSameBytes) {
  for (const char* name : {"a.png", "a.svg"}) {
    const std::string path = temporary(name);
    save_chart(path, sweep());
    const std::string first = read_text(path);
    save_chart(path, sweep());
    EXPECT_EQ(read_text(path), first) << name;
  }
}

TEST(ChartFile, AFilledOutlineAndALogarithmicAxisAreDrawn) {
  Chart volume = of_one_series({0, 300, 300, 0}, {-5, -40, 40, 5});
  volume.series[0].is_filled = true;
  volume.is_equal_aspect = true;
  volume.labels = {{"a 'word'", 100, 0}};
  const std::string path = temporary("volume.png");
  save_chart(path, volume);
  // 0.15 of #0072B2 over white; the trapezium covers more than half of a box of 1000 × 270 pixels, minus its grid.
  EXPECT_GT(count_of(load_image(path), 217, 234, 243), 500 * 270 / 2);
  Chart curve = of_one_series({1, 10, 100}, {1e-9, 1e-3, 5});
  curve.is_log_x = curve.is_log_y = true;
  curve.series[0].is_dashed = true;
  save_chart(temporary("curve.png"), curve);
}

TEST(ChartFile, ASinglePointAndAConstantAreDrawn) {
  save_chart(temporary("point.png"), of_one_series({0}, {0}));
  Chart constant = of_one_series({1, 2}, {3e-7, 3e-7});
  save_chart(temporary("constant.png"), constant);
  constant.is_log_y = true;
  save_chart(temporary("log.png"), constant);
}

TEST(ChartFile, SaysWhatIsWrongWithAChart) {
  EXPECT_EQ(error_of([&] { save_chart("a.pdf", sweep()); }),
            "expected a chart file .png or .svg, got a.pdf; change its extension");
  EXPECT_EQ(error_of([&] { save_chart("a.png", Chart{}); }),
            "expected a chart with points to draw, got \"\" without any");
  EXPECT_EQ(error_of([&] {
              save_chart("a.png", of_one_series({1, 2}, {1}));
            }),
            "expected as many x as y in series 1 \"s\" of the chart \"T\", got 2 and 1");
  EXPECT_EQ(error_of([&] {
              save_chart("a.png", of_one_series({1, 2}, {1, std::numeric_limits<double>::quiet_NaN()}));
            }),
            "expected finite y in point 2 of series 1 \"s\" of the chart \"T\", got nan; leave out what has no value");
  Chart chart = of_one_series({0, 2}, {1, 1});
  chart.is_log_x = true;
  EXPECT_EQ(error_of([&] { save_chart("a.png", chart); }),
            "expected x above 0 in point 1 of series 1 \"s\" of the chart \"T\", whose axis is logarithmic, got 0");
  chart.is_log_x = false;
  chart.series[0].has_line = false;
  EXPECT_EQ(error_of([&] { save_chart("a.png", chart); }),
            "expected a line or markers in series 1 \"s\" of the chart \"T\", got neither");
}

TEST(ChartFile, WithoutGnuplotItSaysWhatToInstallAndLeavesNothing) {
  const std::string path = temporary("a.png");
  const std::string search_path = std::getenv("PATH");
  setenv("PATH", std::filesystem::path(path).parent_path().c_str(), 1);
  const std::string error = error_of([&] { save_chart(path, sweep()); });
  setenv("PATH", search_path.c_str(), 1);
  EXPECT_EQ(error, "expected the program gnuplot to draw " + path +
                       " with, got \"No such file or directory\"; install it (Debian: gnuplot-nox), or leave the "
                       "picture out");
  EXPECT_TRUE(std::filesystem::is_empty(std::filesystem::path(path).parent_path()));
}

TEST(ChartFile, PassesOnWhatGnuplotSaysWhenItFails) {
  // A program that always fails comes first in the PATH.
  const std::string path = temporary("a.png");
  const std::string folder = std::filesystem::path(path).parent_path();
  const std::string search_path = std::getenv("PATH");
  write_text(folder + "/gnuplot", "#!/bin/sh\necho '         ^' >&2; echo 'line 7: unknown colour' >&2; exit 1\n");
  std::filesystem::permissions(folder + "/gnuplot", std::filesystem::perms::owner_all);
  setenv("PATH", (folder + ":" + search_path).c_str(), 1);
  const std::string error = error_of([&] { save_chart(path, sweep()); });
  setenv("PATH", search_path.c_str(), 1);
  EXPECT_EQ(error, "expected gnuplot to draw " + path +
                       ", got \"line 7: unknown colour\"; update gnuplot, or leave the picture out");
  EXPECT_FALSE(std::filesystem::exists(path));
}

}  // namespace
}  // namespace holotrace::test
