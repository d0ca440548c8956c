#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "holotrace/io/files/folders.h"
#include "support/temporary.h"

namespace holotrace {
namespace {

namespace fs = std::filesystem;

TEST(TemporaryFolder, IsOfThisUserAloneAndGoneWithItsFiles) {
  std::string path;
  {
    const TemporaryFolder folder("holotrace_test"), other("holotrace_test");
    path = folder.path();
    EXPECT_NE(path, other.path());
    EXPECT_EQ(fs::status(path).permissions(), fs::perms::owner_all);
    std::ofstream(path + "/file") << "text";
    EXPECT_TRUE(fs::exists(path + "/file"));
  }
  EXPECT_FALSE(fs::exists(path));
}

TEST(TemporaryFolder, SaysWhereItCannotBe) {
  const char* before = std::getenv("TMPDIR");
  const std::string kept = before ? before : "";
  const std::string file = test::make_file("no_folder", "");
  setenv("TMPDIR", "/proc", 1);  // a folder in which nobody can make one
  EXPECT_EQ(error_of([] { TemporaryFolder("holotrace_test"); }),
            "expected a folder for temporary files, but /proc cannot be written; set TMPDIR to another one");
  setenv("TMPDIR", file.c_str(), 1);
  EXPECT_EQ(
      error_of([] { TemporaryFolder("holotrace_test"); }),
      "expected a folder for temporary files, but the one that TMPDIR, TMP or TEMP names cannot be written; set TMPDIR to another one");
  before ? setenv("TMPDIR", kept.c_str(), 1) : unsetenv("TMPDIR");
}

}  // namespace
}  // namespace holotrace
