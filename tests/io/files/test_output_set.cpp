#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <set>

#include "holotrace/base/error.h"
#include "holotrace/io/files/file.h"
#include "holotrace/io/files/folders.h"
#include "holotrace/io/files/output.h"
#include "holotrace/io/files/output_set.h"
#include "support/temporary.h"

namespace holotrace {
namespace {

namespace fs = std::filesystem;

class OutputSetIn : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = test::temporary("folder");
    fs::create_directory(folder_);
  }
  std::string in(const std::string& name) const { return folder_ + "/" + name; }

  // Writes files with these names and texts in place of those of an earlier call; the first is the main one.
  std::vector<std::string> write(const std::vector<std::pair<std::string, std::string>>& files) {
    FileRecord record;
    const auto notes = write_together(in(files.front().first), earlier_, [&](const OutputSet& set) {
      for (size_t i = files.size(); i-- > 0;) write_text(set.path(files[i].first), files[i].second);
      record = set.record();
    });
    earlier_ = record;
    return notes;
  }
  std::map<std::string, std::string> content() const {
    std::map<std::string, std::string> files;
    for (const auto& entry : fs::directory_iterator(folder_))
      files[entry.path().filename().string()] = read_text(entry.path().string());
    return files;
  }

  std::string folder_;
  FileRecord earlier_;
};

using Content = std::map<std::string, std::string>;

TEST_F(OutputSetIn, ReplacesTheFilesOfTheEarlierCall) {
  EXPECT_TRUE(write({{"v.png", "1"}, {"v_2.png", "2"}, {"v_3.png", "3"}}).empty());
  EXPECT_TRUE(write({{"v.png", "one"}, {"v_2.png", "two"}}).empty());
  EXPECT_EQ(content(), (Content{{"v.png", "one"}, {"v_2.png", "two"}}));
}

TEST_F(OutputSetIn, KeepsFilesThatItDidNotWrite) {
  write_text(in("v_3.png"), "mine");
  write_text(in("v_4.png"), "mine, too");
  write({{"v.png", "1"}, {"v_2.png", "2"}});
  EXPECT_EQ(read_text(in("v_3.png")), "mine");
  // A file that it would have to replace is set aside, a second one beside the first.
  const auto notes = write({{"v.png", "1"}, {"v_3.png", "3"}});
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_EQ(notes[0],
            in("v_3.png") + " was not written by an earlier call of this command; it is kept as " + in("v_3.png~"));
  write_text(in("v_3.png"), "mine again");
  write({{"v.png", "1"}, {"v_3.png", "3"}});
  EXPECT_EQ(content(), (Content{{"v.png", "1"},
                                {"v_3.png", "3"},
                                {"v_3.png~", "mine"},
                                {"v_3.png~2~", "mine again"},
                                {"v_4.png", "mine, too"}}));
}

// A file of another size under a recorded name was put there since.
TEST_F(OutputSetIn, KeepsAFileThatTookTheNameOfOneOfItsOwn) {
  write({{"v.png", "1"}, {"v_2.png", "2"}});
  write_text(in("v_2.png"), "a picture of mine");
  write({{"v.png", "1"}});
  EXPECT_EQ(read_text(in("v_2.png")), "a picture of mine");
}

TEST_F(OutputSetIn, AFailureLeavesAllAsItWas) {
  write({{"v.png", "1"}, {"v_2.png", "2"}});
  const Content before = content();
  const std::string error = error_of([&] {
    write_together(in("v.png"), earlier_, [&](const OutputSet& set) {
      write_text(set.path("v_2.png"), "new");
      fail("expected to write {}, got a full disk", set.path("v.png"));
    });
  });
  EXPECT_EQ(error, "expected to write " + in("v.png") + ", got a full disk");
  EXPECT_EQ(content(), before);
}

TEST_F(OutputSetIn, ItsRecordComesBackFromJson) {
  const FileRecord record{{"a.png", 1}, {"b \"c\".png", 1ULL << 40}};
  EXPECT_EQ(record_from(record_json(record)), record);
  // Names that lead elsewhere are no files of this folder.
  EXPECT_TRUE(record_from_text(R"([{"name": "../a.png", "bytes": 1}, {"name": "/etc/passwd", "bytes": 1}])").empty());
  for (const char* wrong :
       {"", "{", "7", "[7]", "[{}]", R"([{"name": 1, "bytes": 2}])", R"([{"name": "a", "bytes": -1}])"})
    EXPECT_TRUE(record_from_text(wrong).empty()) << wrong;
}

TEST_F(OutputSetIn, AFolderIsForOneProgramAtATime) {
  {
    const FolderLock lock(folder_);
    EXPECT_NE(error_of([&] { FolderLock second(folder_); }).find("another run writes into it"), std::string::npos);
  }
  EXPECT_EQ(error_of([&] { FolderLock again(folder_); }), "no error");
}

TEST_F(OutputSetIn, NoFileIsInputAndOutputOfOneCommand) {
  const std::string a = in("a.png"), b = in("b.png"), link = in("link.png");
  write_text(a, "a");
  fs::create_symlink(a, link);
  check_file_exists(a, "a picture");  // without a command, any order is allowed
  check_output(a);
  {
    const CommandFiles files;
    check_file_exists(a, "a picture");
    const std::string sentence = "got the same file; choose another name for the output";
    EXPECT_NE(error_of([&] { check_output(a); }).find(sentence), std::string::npos);
    EXPECT_NE(error_of([&] { check_output(folder_ + "/../folder/a.png"); }).find(sentence), std::string::npos);
    EXPECT_NE(error_of([&] { check_output(link); }).find(sentence), std::string::npos);
    check_output(b);
    EXPECT_NE(error_of([&] { check_output(b); }).find("a file for each output"), std::string::npos);
    write_text(b, "b");
    EXPECT_NE(error_of([&] { check_file_exists(b, "a picture"); }).find(sentence), std::string::npos);
    // Of its own records, a command removes no file that it reads.
    earlier_ = {{"a.png", 1}};
    write({{"v.png", "1"}});
    EXPECT_TRUE(fs::exists(a));
  }
  check_output(a);
}

}  // namespace
}  // namespace holotrace
