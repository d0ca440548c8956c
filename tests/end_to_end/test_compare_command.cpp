// holotrace compare: a picture and its photograph.

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "holotrace/data/image.h"
#include "holotrace/io/picture/image_file.h"
#include "holotrace/view/register/align_image.h"
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
