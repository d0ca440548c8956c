#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <fstream>

#include "holotrace/base/sanitizers.h"
#include "holotrace/io/files/file.h"
#include "support/temporary.h"

namespace holotrace {
namespace {

namespace fs = std::filesystem;
using test::temporary;

size_t files_in(const fs::path& folder) {
  return size_t(std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
}

TEST(File, TextComesBackAsWritten) {
  const std::string path = temporary("text.txt"), text("one\r\ntwo\0three", 14);
  write_text(path, text);
  EXPECT_EQ(read_text(path), text);
}

TEST(File, PathsAreToldApart) {
  const std::string file = test::make_file("told", "apart"), folder = fs::path(file).parent_path().string();
  const std::string missing = temporary("missing"), too_long = folder + "/" + std::string(300, 'n');
  const auto kind = [](const std::string& path) {
    return std::string(is_there(path) ? "there " : "") + (is_file(path) ? "file " : "") +
           (is_folder(path) ? "folder" : "");
  };
  EXPECT_EQ(kind(file), "there file ");
  EXPECT_EQ(kind(folder), "there folder");
  EXPECT_EQ(kind("/dev/null"), "there ");
  EXPECT_EQ(kind(missing), "");
  EXPECT_EQ(kind(file + "/below"), "");
  EXPECT_EQ(kind(too_long), "");  // the system reports an error for it, and another one for a file that is missing
}

TEST(File, AWriteThatFailsLeavesTheOldFileAndNothingElse) {
  const std::string path = temporary("data.bin");
  write_text(path, "old");
  const size_t before = files_in(fs::path(path).parent_path());
  std::string temporary_name;
  const std::string error = error_of([&] {
    write_atomically(path, [&](const std::string& name) {
      temporary_name = name;
      std::ofstream(name) << "half";
      fail("expected to write {}, got a power cut", name);
    });
  });
  EXPECT_EQ(error, "expected to write " + path + ", got a power cut");  // with the name that the user knows
  EXPECT_EQ(read_text(path), "old");
  EXPECT_EQ(files_in(fs::path(path).parent_path()), before);
  EXPECT_EQ(fs::path(temporary_name).extension(), ".bin");
  EXPECT_EQ(fs::path(temporary_name).parent_path(), fs::path(path).parent_path());
}

TEST(File, UnwritablePathsAreNamed) {
  const std::string folder = temporary("folder");
  fs::create_directory(folder);
  EXPECT_EQ(error_of([&] { write_text(folder, ""); }),
            "expected a file to write at " + folder + ", got a folder; add a file name");
  EXPECT_EQ(error_of([&] { write_text(folder + "/none/x.txt", ""); }),
            "expected the folder " + folder + "/none to write " + folder +
                "/none/x.txt into, but it does not exist; make it first");
}

TEST(File, AFolderWithoutPermissionIsNamed) {
  if (geteuid() == 0) GTEST_SKIP() << "the superuser may write everywhere";
  const std::string folder = temporary("locked");
  fs::create_directory(folder);
  fs::permissions(folder, fs::perms::owner_read | fs::perms::owner_exec);
  EXPECT_EQ(error_of([&] { write_text(folder + "/x.txt", ""); }),
            "expected to write " + folder +
                "/x.txt, got \"Permission denied\"; choose a path in a folder with room where you may write");
  fs::permissions(folder, fs::perms::owner_all);
}

// Of many open files it says how to allow more, not to check permissions.
TEST(File, TooManyOpenFilesAreNamed) {
#if HOLOTRACE_ADDRESS_SANITIZER
  GTEST_SKIP() << "the undefined-behaviour sanitizer opens pipes to look at objects";
#endif
  const std::string path = test::make_file("x.txt", "text"), other = temporary("y.txt");
  struct rlimit before {};
  ASSERT_EQ(getrlimit(RLIMIT_NOFILE, &before), 0);
  const int next = dup(0);  // the number of the next file
  close(next);
  struct rlimit none = before;
  none.rlim_cur = rlim_t(next);
  ASSERT_EQ(setrlimit(RLIMIT_NOFILE, &none), 0);
  const std::string read = error_of([&] { read_text(path); }), written = error_of([&] { write_text(other, "text"); });
  setrlimit(RLIMIT_NOFILE, &before);
  const std::string advice =
      ", got \"Too many open files\"; raise the limit on open files (ulimit -n), or close other programs";
  EXPECT_EQ(read, "expected to read " + path + advice);
  EXPECT_EQ(written, "expected to write " + other + advice);
}

TEST(File, MissingFilesAndFoldersAreNamed) {
  const std::string path = temporary("none.txt");
  EXPECT_EQ(error_of([&] { read_text(path); }),
            "expected a file at " + path + ", but there is no such file; check the path");
  const std::string folder = fs::path(path).parent_path();
  EXPECT_EQ(error_of([&] { read_text(folder); }), "expected a file at " + folder + ", got a folder; name a file in it");
}

TEST(File, ASidecarHasTheNameOfItsFile) {
  EXPECT_EQ(sidecar_path("out/f.npy"), "out/f.npy.json");
  EXPECT_EQ(old_sidecar_path("out/f.npy"), "out/f.json");
  EXPECT_EQ(extension_of("out/F.NPY"), ".npy");
}

}  // namespace
}  // namespace holotrace
