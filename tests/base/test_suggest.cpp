#include <gtest/gtest.h>

#include "holotrace/base/message_text.h"

namespace holotrace {
namespace {

TEST(Suggest, AMisspeltNameFindsItsNeighbour) {
  EXPECT_EQ(nearest_name("wavelenght", {"levels", "wavelength", "pitch"}), "wavelength");
  EXPECT_EQ(nearest_name("pluot", {"gaea", "ideal", "pluto"}), "pluto");
}

// One exchange of neighbours is one mistake, so that it is found in a name of three letters.
TEST(Suggest, ExchangedLettersAreOneMistake) {
  EXPECT_EQ(nearest_name("rnu", {"run", "render"}), "run");
  EXPECT_EQ(nearest_name("urx", {"run", "render"}), "");
}

TEST(Suggest, OneLetterIsNotNearToAnother) { EXPECT_EQ(nearest_name("h", {"none", "x", "y"}), ""); }

TEST(Suggest, ANameFarFromAllHasNoNeighbour) { EXPECT_EQ(nearest_name("temperature", {"pitch", "rows"}), ""); }

// More than a third of its letters would have to change.
TEST(Suggest, AnotherWordIsNoMistake) { EXPECT_EQ(nearest_name("--rotation", {"--iterations", "--version"}), ""); }

TEST(Suggest, AWordOfOtherProgramsFindsItsMeaning) {
  const std::vector<std::string> materials{"diffuse", "conductor", "dielectric", "metallic-roughness"};
  EXPECT_EQ(nearest_name("glass", materials), "dielectric");
  EXPECT_EQ(nearest_name("mirror", materials), "conductor");
  EXPECT_EQ(nearest_name("mirror", {"pitch", "rows"}), "");  // only where the meaning is known
}

TEST(Suggest, ATextOfAFileCostsNoMemory) {
  const std::string text(100'000'000, 'x');  // a table of distances would need gigabytes
  EXPECT_EQ(nearest_name(text, {"pitch", "rows"}), "");
}

TEST(Suggest, MessagesNameTheNearestOrListAll) {
  EXPECT_EQ(unknown_name_message("key", "ptich", {"pitch", "rows"}), "unknown key \"ptich\"; did you mean \"pitch\"?");
  EXPECT_EQ(unknown_name_message("key", "temperature", {"pitch", "rows"}),
            "unknown key \"temperature\"; known: pitch, rows");
  EXPECT_EQ(unknown_name_message("material", "red", {}), "unknown material \"red\"; none is defined");
}

}  // namespace
}  // namespace holotrace
