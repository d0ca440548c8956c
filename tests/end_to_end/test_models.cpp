// A file of meshes in place of a scene, by the command line.

#include <gtest/gtest.h>

#include "holotrace/io/picture/image_file.h"
#include "support/program.h"

namespace holotrace::test {
namespace {

// A square of 10 mm in the middle of the picture, of the grey 0.8 of meshes without a material. Around it is the
// uniform light of radiance 0.3.
TEST(Models, AModelAloneIsLitFromAllAroundAndByItsLamp) {
  const Workplace work;
  work.write("m.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n");
  const Outcome outcome = work.run({"render", "m.obj", "-o", "m.exr", "--rows", "32", "--columns", "32"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const Image image = load_image(work.path("m.exr"));
  EXPECT_FLOAT_EQ(image(0, 0), 0.3F);
  double sum = 0;
  for (int row = 12; row < 20; ++row)
    for (int column = 12; column < 20; ++column) sum += image(row, column) / 64;
  // 0.8·(0.3 + 0.7·cos) for a square that faces the panel, with the lamp at (-80, 100, 150) mm from it:
  // cos = 150/197. The lamp has a size: from its edges the distance is longer and the angle steeper, by at most
  // (60 mm/197 mm)² = 9 %, and by half of this for the whole lamp.
  EXPECT_NEAR(sum, 0.8 * (0.3 + 0.7 * 150 / 197), 0.05 * 0.8 * 0.7);
  EXPECT_LT(sum, 0.8 * (0.3 + 0.7));
}

TEST(Models, FilesBesideAModelAreFoundFromAnywhere) {
  const Workplace work;
  std::filesystem::create_directory(work.path("models"));
  work.write("models/m.mtl", "newmtl black\nKd 0 0 0\n");
  work.write("models/m.obj", "mtllib m.mtl\nusemtl black\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n");
  ASSERT_EQ(work.run({"render", "models/m.obj", "-o", "m.exr", "--rows", "16", "--columns", "16"}).exit_code, 0);
  EXPECT_EQ(load_image(work.path("m.exr"))(8, 8), 0);
}

}  // namespace
}  // namespace holotrace::test
