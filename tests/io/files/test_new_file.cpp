#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <set>

#include "holotrace/io/files/file.h"
#include "holotrace/io/files/new_file.h"
#include "support/temporary.h"

namespace holotrace {
namespace {

namespace fs = std::filesystem;

std::string fresh_folder() {
  const std::string folder = test::temporary("folder");
  fs::create_directory(folder);
  return folder;
}

std::set<std::string> names_in(const std::string& folder) {
  std::set<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder)) names.insert(entry.path().filename().string());
  return names;
}

TEST(NewFile, HasItsNameOnlyWhenItIsFinished) {
  const std::string folder = fresh_folder(), path = folder + "/a.bin";
  {
    NewFile file(path);
    EXPECT_TRUE(file.put("half", 4));
    EXPECT_FALSE(fs::exists(path));
    EXPECT_EQ(names_in(folder).size(), 1U);
  }
  EXPECT_TRUE(names_in(folder).empty()) << "an unfinished file stays nowhere";
  NewFile file(path);
  file.put("whole", 5);
  file.seek(0);
  file.put("W", 1);
  EXPECT_EQ(file.tell(), 1);
  file.finish();
  EXPECT_EQ(read_text(path), "Whole");
  EXPECT_EQ(names_in(folder), std::set<std::string>{"a.bin"});
}

// 16 hexadecimal digits of entropy: nobody can lay a link there beforehand.
TEST(NewFile, HasARandomNameWithTheSameExtension) {
  const std::string folder = fresh_folder();
  const NewFile one(folder + "/a.png"), other(folder + "/a.png");
  EXPECT_NE(one.temporary(), other.temporary());
  for (const NewFile* file : {&one, &other}) {
    const std::string name = fs::path(file->temporary()).filename();
    EXPECT_TRUE(name.starts_with(".holotrace-")) << name;
    EXPECT_EQ(name.size(), std::string(".holotrace-0123456789abcdef.png").size()) << name;
    EXPECT_EQ(fs::path(name).extension(), ".png");
  }
}

TEST(NewFile, AnUnwritablePlaceIsNamed) {
  const std::string folder = fresh_folder(), pipe = folder + "/pipe.png";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_EQ(error_of([&] { NewFile file(pipe); }),
            "expected a file to write at " + pipe + ", got a device or a pipe; choose another name");
  EXPECT_EQ(error_of([&] { NewFile file(folder); }),
            "expected a file to write at " + folder + ", got a folder; add a file name");
}

// What a killed program leaves is removed by the next one; what a running one writes stays.
TEST(NewFile, AbandonedFilesAndFoldersAreRemovedAndThoseInUseStay) {
  const std::string folder = fresh_folder();
  int ready[2];
  ASSERT_EQ(pipe(ready), 0);
  const pid_t child = fork();
  if (child == 0) {
    auto* file = new NewFile(folder + "/killed.npy");  // never destroyed
    file->put("half", 4);
    if (write(ready[1], "x", 1) == 1) pause();
    _exit(0);
  }
  char byte = 0;
  ASSERT_EQ(read(ready[0], &byte, 1), 1);
  close(ready[0]);
  close(ready[1]);
  const std::string dead_folder = folder + "/.holotrace-0123456789abcdef";
  fs::create_directory(dead_folder);
  write_text(dead_folder + "/view.png", "part");
  write_text(folder + "/.holotrace-notes", "mine");                 // not such a name
  write_text(folder + "/.holotrace-0123456789abcdeX.png", "mine");  // nor this
  fs::create_symlink(folder + "/kept.txt", folder + "/.holotrace-00000000000000aa.txt");
  write_text(folder + "/kept.txt", "mine");

  remove_abandoned(folder);
  EXPECT_EQ(names_in(folder).size(), 5U) << "the file of the running program stays";
  EXPECT_FALSE(fs::exists(dead_folder));
  kill(child, SIGKILL);
  waitpid(child, nullptr, 0);
  remove_abandoned(folder);
  EXPECT_EQ(names_in(folder), (std::set<std::string>{".holotrace-notes", ".holotrace-0123456789abcdeX.png",
                                                     ".holotrace-00000000000000aa.txt", "kept.txt"}));
}

}  // namespace
}  // namespace holotrace
