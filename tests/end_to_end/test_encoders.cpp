// A picture is encoded as a hologram and shown again, by the command line alone.

#include <gtest/gtest.h>

#include <map>
#include <nlohmann/json.hpp>

#include "holotrace/estimate/picture_quality.h"
#include "holotrace/io/picture/image_file.h"
#include "support/program.h"

namespace holotrace::test {
namespace {

const char* panel = R"(columns = 192
rows = 128
pitch = "8 um"
levels = 256
fill_factor = 1
)";

std::vector<std::string> encode_arguments(const std::string& method) {
  return {"encode",   "picture.png", "--slm", "panel.toml", "--wavelength",     "520 nm", "--target-distances", "8 mm",
          "--method", method,        "-o",    "h.png",      "--target-columns", "160",    "--target-rows",      "96"};
}

// Quality of the picture on both sides of the panel. Floors: measured values less 2 dB, rounded down, with light
// integrated over the pixels (sgd uses only their centres, where it has 33 dB; over the pixels 27.3). An empty view
// or noise has less than 12 dB, from the variance of the picture itself.
TEST(EncodePicture, EveryEncoderShowsItOnBothSides) {
  const Workplace work;
  work.write("panel.toml", panel);
  save_image(work.write("picture.png", ""), natural_picture(160, 96), 1, 8);
  const std::map<std::string, double> floors{{"double-phase", 20},
                                             {"error-diffusion", 19},
                                             {"gerchberg-saxton", 22},
                                             {"weighted-gerchberg-saxton", 20},
                                             {"sgd", 25}};
  for (const auto& [method, floor] : floors)
    for (const char* side : {"virtual", "real"}) {
      std::vector<std::string> arguments = encode_arguments(method);
      arguments.insert(arguments.end(), {"--image", side});
      const Outcome encoded = work.run(arguments);
      ASSERT_EQ(encoded.exit_code, 0) << method << ": " << encoded.err;
      // The picture's part of the plane, 160 × 96 pixels of 8 µm.
      const Outcome shown = work.run({"show", "h.png", "--distance", "8 mm", "--width", "1.28 mm", "--height",
                                      "0.768 mm", "--bits", "16", "-o", "view.png"});
      ASSERT_EQ(shown.exit_code, 0) << method << ": " << shown.err;
      const Outcome compared = work.run({"compare", "picture.png", "view.png", "--json"});
      ASSERT_EQ(compared.exit_code, 0) << method << ": " << compared.err;
      EXPECT_GT(nlohmann::json::parse(compared.out).at("psnr_amplitude_db").get<double>(), floor)
          << method << ", " << side;
    }
}

TEST(EncodePicture, ReportsTheConvergence) {
  const Workplace work;
  work.write("panel.toml", panel);
  save_image(work.write("picture.png", ""), natural_picture(160, 96), 1, 8);
  std::vector<std::string> arguments = encode_arguments("sgd");
  arguments.insert(arguments.end(), {"--iterations", "5", "--report", "r.json", "--plot", "c.svg"});
  const Outcome outcome = work.run(arguments);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_TRUE(work.has("c.svg"));
  const auto stage = nlohmann::json::parse(work.read("r.json")).at("stages").at(0);
  EXPECT_EQ(stage.at("convergence").size(), 6U);  // before each iteration, and for the levels at the end
  EXPECT_LT(stage.at("loss_last").get<double>(), stage.at("loss_first").get<double>());
}

// Of a square picture 96 × 96 pixels fit into the target of 160 × 96: the bytes are those of a target of that size.
TEST(EncodePicture, ResamplingKeepsTheShapeOfThePicture) {
  const Workplace work;
  work.write("panel.toml", panel);
  save_image(work.write("picture.png", ""), natural_picture(64, 64), 1, 8);
  std::vector<std::string> resampled = encode_arguments("phase");
  resampled.insert(resampled.end(), {"--resample", "true"});
  ASSERT_EQ(work.run(resampled).exit_code, 0);
  const std::string fitted = work.read("h.png");
  std::vector<std::string> square = resampled;
  for (std::string& argument : square)
    if (argument == "160") argument = "96";
  ASSERT_NE(square, resampled);
  ASSERT_EQ(work.run(square).exit_code, 0);
  EXPECT_TRUE(work.read("h.png") == fitted);
}

TEST(EncodePicture, SaysWhatIsWrong) {
  const Workplace work;
  work.write("panel.toml", panel);
  save_image(work.write("picture.png", ""), natural_picture(100, 60), 1, 8);
  const Outcome other_size = work.run(encode_arguments("sgd"));
  EXPECT_EQ(other_size.exit_code, 1);
  EXPECT_NE(other_size.err.find("expected a target picture of 160 × 96 pixels"), std::string::npos) << other_size.err;
  EXPECT_NE(other_size.err.find("got 100 × 60"), std::string::npos) << other_size.err;
  std::vector<std::string> resampled = encode_arguments("phase");
  resampled.insert(resampled.end(), {"--resample", "true"});
  EXPECT_EQ(work.run(resampled).exit_code, 0);
  const Outcome no_wavelength = work.run({"encode", "picture.png", "--target-distances", "8 mm", "-o", "h.png"});
  EXPECT_EQ(no_wavelength.exit_code, 1);
  EXPECT_NE(no_wavelength.err.find("give --wavelength"), std::string::npos) << no_wavelength.err;
}

}  // namespace
}  // namespace holotrace::test
