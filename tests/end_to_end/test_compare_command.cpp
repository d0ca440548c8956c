// holotrace compare: a picture and its photograph.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "end_to_end/scenes.h"
#include "holotrace/data/image.h"
#include "holotrace/io/picture/image_file.h"
#include "holotrace/view/register/register.h"
#include "support/program.h"

namespace holotrace::test {
namespace {

// A function known at every position [pixels from the centre, y up], between 0.05 and 0.65.
double picture(double x, double y) {
  return 0.35 + 0.1 * (std::sin(x / 3) + std::sin(0.21 * x + 0.13 * y + 1) + std::sin(y / 11 - x / 40 + 2));
}

// Saves gain·picture at p, q = scale·R(angle)·p + shift, as an 8-bit PNG.
void save_photograph(const std::string& path, int ny, int nx, double scale, double angle, double shift_x,
                     double shift_y, double gain) {
  Image image(ny, nx, 1);
  const double c = std::cos(angle) / scale, s = std::sin(angle) / scale;
  for (int j = 0; j < ny; ++j)
    for (int i = 0; i < nx; ++i) {
      const double x = i - (nx - 1) / 2.0 - shift_x, y = (ny - 1) / 2.0 - j - shift_y;
      image(j, i) = float(gain * picture(c * x + s * y, -s * x + c * y));
    }
  save_image(path, image, 1, 8);
}

TEST(CompareCommand, RegistersAPhotographWithASimulation) {
  const Workplace work;
  save_photograph(work.path("simulated.png"), 128, 160, 1, 0, 0, 0, 1);
  save_photograph(work.path("capture.png"), 180, 200, 1.2, 0.2, 7, -4, 0.5);
  const Outcome outcome = work.run({"compare", "--register", "capture.png", "simulated.png", "-o", "aligned.png",
                                    "--difference", "difference.png", "--profile", "profile.svg", "--json"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(outcome.err, "");
  const auto facts = nlohmann::json::parse(outcome.out);
  // A tenth of a pixel in the centre and 100 pixels from it, which is 1e-3 and 0.057°.
  EXPECT_NEAR(facts["magnification"].get<double>(), 1.2, 1e-3);
  EXPECT_NEAR(facts["rotation_deg"].get<double>(), 0.2 * 180 / M_PI, 0.057);
  EXPECT_NEAR(facts["shift_x_pixels"].get<double>(), 7, 0.1);
  EXPECT_NEAR(facts["shift_y_pixels"].get<double>(), -4, 0.1);
  EXPECT_NEAR(facts["gain"].get<double>(), 0.5, 0.005);
  EXPECT_GT(facts["psnr_unscaled_db"].get<double>(), 35);  // 8-bit steps and resampling: 1 % of the maximum is 40 dB
  EXPECT_GT(facts["ssim"].get<double>(), 0.98);
  EXPECT_GT(facts["difference_at_full_colour"].get<double>(), 0);
  const Image aligned = load_image(work.path("aligned.png")), difference = load_image(work.path("difference.png"));
  EXPECT_EQ(aligned.nx, 160);
  EXPECT_EQ(aligned.ny, 128);
  EXPECT_NEAR(aligned(64, 80), picture(0.5, -0.5), 0.02);
  EXPECT_EQ(difference.nx, facts["compared_columns"].get<int>());
  EXPECT_EQ(difference.ny, facts["compared_rows"].get<int>());
  EXPECT_NE(bytes_of(work.path("profile.svg")).find("x [pixels]"), std::string::npos);
}

TEST(CompareCommand, DrawsDifferenceAndProfileWithoutRegistering) {
  const Workplace work;
  save_photograph(work.path("a.png"), 40, 64, 1, 0, 0, 0, 1);
  save_photograph(work.path("b.png"), 40, 64, 1, 0, 0, 0, 0.5);
  const Outcome outcome = work.run({"compare", "a.png", "b.png", "--difference", "d.png", "--difference-range", "0.1",
                                    "--profile", "p.png", "--json"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(nlohmann::json::parse(outcome.out)["difference_at_full_colour"].get<double>(), 0.1);
  EXPECT_EQ(load_image(work.path("d.png")).nx, 64);
  EXPECT_EQ(load_image(work.path("p.png")).nx, 1200);
}

// The photograph shows a part off the centre; the row in the title and the positions are the simulation's own.
TEST(CompareCommand, ProfilesAPhotographOfAPartAtTheSimulationsOwnPlaces) {
  const Workplace work;
  Image simulated(128, 160, 1);
  for (int j = 0; j < simulated.ny; ++j)
    for (int i = 0; i < simulated.nx; ++i)  // with a spot: sines alone look the same upside down
      simulated(j, i) = float(picture(i, -j) + 0.3 * std::exp(-(std::pow(i - 110, 2) + std::pow(j - 60, 2)) / 80));
  save_image(work.path("simulated.png"), simulated, 1, 8);
  save_image(work.path("capture.png"), cropped(simulated, {28, 30, 100, 130}), 1, 8);
  const Outcome outcome =
      work.run({"compare", "--register", "capture.png", "simulated.png", "--profile", "profile.svg", "--json"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const auto facts = nlohmann::json::parse(outcome.out);
  const int row = facts["compared_first_row"].get<int>() + facts["compared_rows"].get<int>() / 2;
  EXPECT_NEAR(row, 28 + 50, 2) << outcome.out;  // without the rims, where interpolation has no neighbours
  EXPECT_NE(bytes_of(work.path("profile.svg")).find("Row " + std::to_string(row + 1) + " of 128"), std::string::npos);
}

TEST(CompareCommand, PrintsItsFiguresWhereNoChartCanBeDrawn) {
  const Workplace work;
  save_photograph(work.path("a.png"), 40, 64, 1, 0, 0, 0, 1);
  const Outcome outcome =
      work.run_under({"env", "PATH=/nowhere"}, {"compare", "a.png", "a.png", "--profile", "p.png", "--json"});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_NE(outcome.err.find("gnuplot"), std::string::npos);
  EXPECT_EQ(nlohmann::json::parse(outcome.out)["ssim"].get<double>(), 1);
}

// A run's render covers the panel's cone in square pixels and in colour; its view covers the panel at one wavelength.
TEST(CompareCommand, FindsForTheFilesOfARunWhatItsReportSays) {
  const Workplace work;
  work.write("scene.toml", scene_head() +
                               "[trace]\ncolumns = 96\nrows = 96\npaths = 4\n"
                               "[render]\nrows = 64\n"
                               "[[light]]\ntype = \"point\"\nposition = \"1 2 -20 mm\"\nintensity = 1e-3\n"
                               "[[object]]\ntype = \"sphere\"\nsize = \"0.8 mm\"\nposition = \"0 0 -30 mm\"\n");
  const Outcome run =
      work.run({"run", "scene.toml", "-o", "out", "--distance", "30 mm, 29 mm", "--exposure", "60", "--bits", "16"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto report = nlohmann::json::parse(work.read("out/report.json"));
  for (const char* name : {"view.png", "view_2.png"}) {
    const std::string view = std::string("out/") + name;
    const Image seen = load_image(work.path(view));
    ASSERT_LT(*std::max_element(seen.values.begin(), seen.values.end()), 1) << "a clipped view is another picture";
    const Outcome outcome = work.run({"compare", "out/render.png", view, "--json"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    const auto facts = nlohmann::json::parse(outcome.out);
    EXPECT_EQ(facts["placed"], "out/render.png (85 × 64 pixels) on the 256 × 192 pixels of " + view +
                                   ", each the mean over its area, by report.json");
    EXPECT_EQ(facts["colours"], "light of 532 nm");
    const Outcome exact = work.run({"compare", "out/render.exr", view, "--json"});
    EXPECT_EQ(nlohmann::json::parse(exact.out)["colours"], "light of 532 nm");
    for (const auto& stage : report["stages"])
      if (stage["stage"] == (name == std::string("view.png") ? "look at 30 mm" : "look at 29 mm")) {
        // 8-bit steps of the render: half a step is at most 0.2 % of the maximum, against an error of 20 %.
        EXPECT_NEAR(facts["psnr_db"].get<double>(), stage["psnr_db"].get<double>(), 0.1);
        EXPECT_NEAR(facts["ssim"].get<double>(), stage["ssim"].get<double>(), 0.01);
      }
  }
  // A view that was replaced since then is not that of the report.
  save_photograph(work.path("out/view.png"), 64, 85, 1, 0, 0, 0, 1);
  const Outcome replaced = work.run({"compare", "out/render.png", "out/view.png"});
  EXPECT_EQ(replaced.exit_code, 0) << replaced.err;
  EXPECT_EQ(replaced.out.find("placed"), std::string::npos) << replaced.out;
  EXPECT_NE(replaced.out.find("luminance"), std::string::npos) << replaced.out;
}

TEST(CompareCommand, BringsPicturesOfOneWindowToTheSamePixels) {
  const Workplace work;
  save_photograph(work.path("fine.png"), 160, 256, 4, 0, 0, 0, 1);
  save_photograph(work.path("coarse.png"), 40, 64, 1, 0, 0, 0, 1);
  const Outcome outcome = work.run({"compare", "fine.png", "coarse.png", "--json"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const auto facts = nlohmann::json::parse(outcome.out);
  EXPECT_EQ(facts["placed"],
            "fine.png (256 × 160 pixels) on the 64 × 40 pixels of coarse.png, each the mean over its area, as if both "
            "showed one window");
  // The finest structure, a period of 19 pixels, loses (π/19)²/6 = 0.5 % by the mean over a pixel: 46 dB.
  EXPECT_GT(facts["psnr_db"].get<double>(), 40);
  save_photograph(work.path("wide.png"), 40, 80, 1, 0, 0, 0, 1);
  EXPECT_NE(work.run({"compare", "fine.png", "wide.png"}).err.find("expected two pictures of the same shape"),
            std::string::npos);
}

TEST(CompareCommand, SaysWhatIsWrong) {
  const Workplace work;
  save_photograph(work.path("a.png"), 40, 64, 1, 0, 0, 0, 1);
  const auto error_of_run = [&](const std::vector<std::string>& arguments) {
    const Outcome outcome = work.run(arguments);
    EXPECT_EQ(outcome.exit_code, 1);
    return outcome.err;
  };
  EXPECT_EQ(error_of_run({"compare", "a.png", "a.png", "-o", "b.png"}),
            "holotrace: -o needs --register; add --register, or leave out -o\n");
  EXPECT_EQ(error_of_run({"compare", "a.png", "a.png", "--offset", "true"}),
            "holotrace: --offset needs --register; add --register, or leave out --offset\n");
  EXPECT_EQ(error_of_run({"compare", "a.png", "a.png", "--difference-range", "2"}),
            "holotrace: --difference-range needs a picture of the difference; add --difference FILE.png\n");
  EXPECT_EQ(error_of_run({"compare", "a.png", "a.png", "--difference", "d.png", "--profile", "d.png"}),
            "holotrace: expected a file for each output, got d.png for two of them; choose another name\n");
  EXPECT_NE(error_of_run({"compare", "a.png", "a.png", "--profile", "p.pdf"}).find(".svg"), std::string::npos);
}

}  // namespace
}  // namespace holotrace::test
