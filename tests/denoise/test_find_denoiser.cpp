#include <gtest/gtest.h>

#include <filesystem>

#include "holotrace/denoise/denoise.h"
#include "support/build_paths.h"
#include "support/denoiser.h"
#include "support/error_of.h"
#include "support/temporary.h"

namespace holotrace::test {
namespace {

// Light in every pixel, of a size that is denoised.
Image grey() {
  Image image(32, 32, 3);
  for (float& value : image.values) value = 0.5F;
  return image;
}

bool is_broken() {
  try {
    find_denoiser();
  } catch (const NoDenoiser& none) {
    return none.is_broken;
  }
  return false;
}

TEST(FindDenoiser, WithoutTheLibraryASentenceSaysWhereItWasLookedFor) {
  const Environment nowhere("HOLOTRACE_OIDN", "/nowhere/libOpenImageDenoise.so.2");
  const std::string sentence = error_of([] { denoise(grey()); });
  EXPECT_EQ(sentence.find("expected Open Image Denoise 2 in HOLOTRACE_OIDN, got \"/nowhere/libOpenImageDenoise.so.2: "),
            0U)
      << sentence;
  EXPECT_TRUE(is_broken());
  const Environment folder("HOLOTRACE_OIDN", std::filesystem::temp_directory_path().string());
  EXPECT_NE(error_of([] { find_denoiser(); }).find("/libOpenImageDenoise.so.2: "), std::string::npos);
}

TEST(FindDenoiser, RefusesLibrariesOfOtherVersions) {
  const Environment fake("HOLOTRACE_OIDN", HOLOTRACE_FAKE_OIDN);
  const auto error_for = [](const char* version) {
    const Environment of("FAKE_OIDN_VERSION", version);
    EXPECT_TRUE(is_broken() || std::string(version) == "20300");
    return error_of([] { find_denoiser(); });
  };
  const std::string start = "expected Open Image Denoise 2.3 or a later 2.x in " HOLOTRACE_FAKE_OIDN ", got ";
  EXPECT_EQ(error_for("30000").find(start + "version 3.0.0; "), 0U) << error_for("30000");
  EXPECT_EQ(error_for("20299").find(start + "version 2.2.99; "), 0U) << error_for("20299");
  EXPECT_EQ(error_for("0").find(start + "one without a device for processors (\"the filter is a fake\"); "), 0U);
  EXPECT_EQ(error_for("20300"), "no error");
  const Environment other("HOLOTRACE_OIDN", "libm.so.6");
  EXPECT_NE(error_of([] { find_denoiser(); }).find("got a library without oidnNewDevice; "), std::string::npos);
}

TEST(FindDenoiser, SaysWhatTheLibraryReports) {
  const Environment fake("HOLOTRACE_OIDN", HOLOTRACE_FAKE_OIDN);
  const Environment of("FAKE_OIDN_VERSION", "29999");
  EXPECT_EQ(find_denoiser(), "Open Image Denoise 2.99.99");
  EXPECT_EQ(
      error_of([] { denoise(grey()); }),
      "expected Open Image Denoise to denoise a picture of 32 x 32 pixels, got \"the filter is a fake\"; use denoise "
      "= none");
}

TEST(FindDenoiser, LooksInTheFolderThatWasNamed) {
  const std::string folder = temporary("library");
  std::filesystem::create_directories(folder);
  std::filesystem::copy_file(HOLOTRACE_FAKE_OIDN, folder + "/libOpenImageDenoise.so.2");
  const Environment anywhere("HOLOTRACE_OIDN", "");
  const Environment of("FAKE_OIDN_VERSION", "20399");
  look_for_denoiser_in(folder);
  EXPECT_EQ(find_denoiser(), "Open Image Denoise 2.3.99");
  look_for_denoiser_in("");
}

}  // namespace
}  // namespace holotrace::test
