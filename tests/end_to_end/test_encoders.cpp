// A picture becomes a hologram, and the hologram the picture, by the command line alone.

#include <gtest/gtest.h>

#include "holotrace/estimate/test_picture.h"
#include "holotrace/io/image_file.h"
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

TEST(EncodePicture, EveryPhaseEncoderShowsIt) {
  const Workplace work;
  work.write("panel.toml", panel);
  const Image picture = natural_picture(160, 96);
  save_image(work.write("picture.png", ""), picture, 1, 8);
  for (const char* method : {"phase", "double-phase", "error-diffusion", "binary", "gerchberg-saxton", "sgd"}) {
    const Outcome encoded = work.run(encode_arguments(method));
    ASSERT_EQ(encoded.exit_code, 0) << method << ": " << encoded.err;
    const Outcome shown = work.run({"show", "h.png", "--distance", "8 mm", "-o", "view.png"});
    ASSERT_EQ(shown.exit_code, 0) << method << ": " << shown.err;
    EXPECT_TRUE(work.has("view.png"));
  }
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
