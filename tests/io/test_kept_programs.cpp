#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

#include "holotrace/io/files/file.h"
#include "holotrace/io/kept_programs.h"
#include "support/temporary.h"

namespace holotrace {
namespace {

// The cache folder of one test.
class KeptPrograms : public ::testing::Test {
 protected:
  void SetUp() override {
    if (const char* before = std::getenv("XDG_CACHE_HOME")) before_ = before;
    folder_ = test::temporary("cache");
    std::filesystem::create_directories(folder_);
    setenv("XDG_CACHE_HOME", folder_.c_str(), 1);
  }
  void TearDown() override {
    if (before_.empty())
      unsetenv("XDG_CACHE_HOME");
    else
      setenv("XDG_CACHE_HOME", before_.c_str(), 1);
  }
  std::string folder_, before_;
};

TEST_F(KeptPrograms, AreFoundByTheirKey) {
  EXPECT_EQ(load_kept_program("card\n1.0\nsource"), std::nullopt);
  const std::string binary("\0ELF\n\n\0", 7);
  keep_program("card\n1.0\nsource", binary);
  EXPECT_EQ(load_kept_program("card\n1.0\nsource"), binary);
  EXPECT_EQ(load_kept_program("card\n1.1\nsource"), std::nullopt);  // another driver
  keep_program("card\n1.0\nsource", "new");
  EXPECT_EQ(load_kept_program("card\n1.0\nsource"), "new");
}

// A file with the name of one key and the content of another is what two keys with one fingerprint leave.
TEST_F(KeptPrograms, OfAnotherKeyOrDamagedAreNotTaken) {
  keep_program("one", "binary");
  std::string path;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder_))
    if (entry.path().extension() == ".bin") path = entry.path();
  ASSERT_NE(path, "");
  for (const char* content : {"", "3\ntwo\nbinary", "3\none\n", "binary"}) {
    write_text(path, content);
    EXPECT_EQ(load_kept_program("one"), std::nullopt) << content;
  }
}

TEST_F(KeptPrograms, OfARefusedKernelTheMessagesAreKept) {
  const std::string path = keep_compiler_log("error: line 1\nerror: line 2\n");
  EXPECT_EQ(read_text(path), "error: line 1\nerror: line 2\n");
  setenv("XDG_CACHE_HOME", "/dev/null", 1);
  EXPECT_EQ(keep_compiler_log("error"), "");
  keep_program("one", "binary");  // nowhere to keep it: no error
  EXPECT_EQ(load_kept_program("one"), std::nullopt);
}

}  // namespace
}  // namespace holotrace
