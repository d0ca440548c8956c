#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>

#include "holotrace/io/files/file.h"
#include "holotrace/io/user_cache.h"
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
  std::string path_of_only_program() const {
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder_))
      if (entry.path().extension() == ".bin") return entry.path();
    return "";
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
TEST_F(KeptPrograms, OfAnotherKeyAreNotTaken) {
  keep_program("two", "binary");
  const std::string other = read_text(path_of_only_program());
  std::filesystem::remove(path_of_only_program());
  keep_program("one", "binary");
  write_text(path_of_only_program(), other);
  EXPECT_EQ(load_kept_program("one"), std::nullopt);
}

// A driver that gets a damaged program may abort.
TEST_F(KeptPrograms, ThatAreDamagedAtAnyByteAreNotTaken) {
  keep_program("one", "binary");
  const std::string path = path_of_only_program(), whole = read_text(path);
  for (size_t at = 0; at < whole.size(); ++at) {
    std::string damaged = whole;
    damaged[at] ^= 1;
    write_text(path, damaged);
    EXPECT_EQ(load_kept_program("one"), std::nullopt) << damaged;
    write_text(path, whole.substr(0, at));
    EXPECT_EQ(load_kept_program("one"), std::nullopt) << "the first " << at << " bytes";
  }
  write_text(path, whole + "\n");
  EXPECT_EQ(load_kept_program("one"), std::nullopt);
  write_text(path, whole);
  EXPECT_EQ(load_kept_program("one"), "binary");
}

// Programs of drivers run in this process.
TEST_F(KeptPrograms, ThatOthersCouldHaveWrittenAreNotTaken) {
  keep_program("one", "binary");
  const std::string path = path_of_only_program(), folder = std::filesystem::path(path).parent_path();
  std::filesystem::permissions(folder, std::filesystem::perms::all);
  EXPECT_EQ(load_kept_program("one"), "binary");  // an older version made the folder
  EXPECT_EQ(std::filesystem::status(folder).permissions(), std::filesystem::perms::owner_all);
  std::filesystem::rename(path, folder_ + "/elsewhere");
  std::filesystem::create_symlink(folder_ + "/elsewhere", path);
  EXPECT_EQ(load_kept_program("one"), std::nullopt);
  std::filesystem::rename(folder_ + "/elsewhere", path);
  EXPECT_EQ(load_kept_program("one"), "binary");
  if (geteuid() != 0) GTEST_SKIP() << "only root can give files away";
  ASSERT_EQ(chown(path.c_str(), 1, 1), 0);
  EXPECT_EQ(load_kept_program("one"), std::nullopt);
  ASSERT_EQ(chown(path.c_str(), 0, 0), 0);
  EXPECT_EQ(load_kept_program("one"), "binary");
  ASSERT_EQ(chown(folder.c_str(), 1, 1), 0);
  EXPECT_EQ(load_kept_program("one"), std::nullopt);
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
