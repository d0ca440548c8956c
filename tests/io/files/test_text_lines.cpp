#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <vector>

#include "holotrace/base/units.h"
#include "holotrace/io/files/file.h"
#include "holotrace/io/files/file_kind.h"
#include "holotrace/io/files/text.h"
#include "holotrace/io/scene/scene_materials.h"
#include "holotrace/io/scene/slm_file.h"
#include "holotrace/io/scene/toml_table.h"
#include "support/temporary.h"

namespace holotrace {
namespace {

using namespace std::string_literals;
using test::make_file;

// A text of ASCII in UTF-16, little-endian first, with and without a mark.
std::string utf16(const std::string& text, bool is_little, bool has_mark) {
  std::string bytes = !has_mark ? "" : is_little ? "\xff\xfe" : "\xfe\xff";
  for (const char c : text) bytes += is_little ? std::string{c, '\0'} : std::string{'\0', c};
  return bytes;
}

TEST(TextLines, MarksAndLineEndsOfAllSystemsAreTheSame) {
  for (const std::string& bytes :
       {"one\n\ntwo\n"s, "one\r\n\r\ntwo\r\n"s, "one\r\rtwo\r"s, "\xef\xbb\xbfone\r\n\rtwo\n"s})
    EXPECT_EQ(as_lines(bytes, "f"), "one\n\ntwo\n");
  EXPECT_EQ(as_lines("\r", "f"), "\n");
  EXPECT_EQ(as_lines("", "f"), "");
  const std::string text = "one\n\ntwo";
  std::string_view rest = text, line;
  std::vector<std::string> lines;
  while (next_line(rest, line)) lines.emplace_back(line);
  EXPECT_EQ(lines, (std::vector<std::string>{"one", "", "two"}));
}

TEST(TextLines, OtherEncodingsAreNamed) {
  for (const bool is_little : {true, false})
    for (const bool has_mark : {true, false})
      EXPECT_EQ(error_of([&] { as_lines(utf16("v 1 2", is_little, has_mark), "f"); }),
                "f: expected text in UTF-8, got UTF-16; save it again as UTF-8");
  EXPECT_EQ(error_of([&] { as_lines("\xff\xfe\0\0v\0\0\0"s, "f"); }),
            "f: expected text in UTF-8, got UTF-32; save it again as UTF-8");
}

TEST(TextLines, CommentsEndLinesAndNamesMayHoldTheirSign) {
  EXPECT_EQ(without_comment("1 2 3 # 4"), "1 2 3 ");
  EXPECT_EQ(without_comment("# all"), "");
  EXPECT_EQ(name_without_comment("  oak wood # of the floor\t"), "oak wood");
  EXPECT_EQ(name_without_comment("wood #2"), "wood #2");
  EXPECT_EQ(name_without_comment("wood#2.png"), "wood#2.png");
}

TEST(TextLines, AllTextsOfPeopleAreReadByIt) {
  const auto save = [](const std::string& name, std::string text) {
    for (size_t at = 0; (at = text.find('\n', at)) != std::string::npos;) text[at] = '\r';
    return make_file(name, "\xef\xbb\xbf" + text);
  };
  const RefractiveIndex index = load_index_table(save("n.txt", "# nm n k\n450 nm 1.5 0 # blue\n650 nm, 1.4, 0\n"));
  ASSERT_EQ(index.samples.size(), 2u);
  EXPECT_EQ(index.samples[1].n, 1.4);
  const auto levels = load_calibration(save("c.csv", "level,phase_rad # of the maker\n0, 0\n1, 3 # last\n"), 2);
  ASSERT_EQ(levels.size(), 2u);
  EXPECT_EQ(levels[1].phase, 3);
  EXPECT_EQ(parse_toml(save("s.toml", "a = 1 # one\nb = 2\n"), "a scene")["b"].value<int>(), 2);
  EXPECT_NE(error_of([&] { load_index_table(make_file("n.txt", utf16("450 nm 1.5 0\n", true, true))); }).find("UTF-16"),
            std::string::npos);
}

TEST(FindBeside, AuthorsPathsLeadToTheFileBesideTheModel) {
  const std::string model = make_file("m.obj", ""), folder = std::filesystem::path(model).parent_path().string();
  make_file("Wood.PNG", "");
  std::filesystem::create_directory(folder + "/Maps");
  std::ofstream(folder + "/Maps/stone.png") << "";
  const auto find = [&](const std::string& name) {
    const std::string found = find_beside(name, model, Outside::refused);
    return found.starts_with(folder + "/") ? found.substr(folder.size() + 1) : found;
  };
  for (const char* name :
       {"Wood.PNG", "wood.png", "./WOOD.png", "C:\\Users\\me\\My Maps\\wood.png", "/home/me/wood.png",
        "\\\\server\\share\\Wood.png", "file:///C:/maps/Wood.PNG", "../textures/wood.png"})
    EXPECT_EQ(find(name), "Wood.PNG") << name;
  EXPECT_EQ(find("D:\\work\\maps\\Stone.png"), "Maps/stone.png");
  EXPECT_EQ(find("stone.png"), "");  // in a folder that is not named
  EXPECT_EQ(find("Maps"), "");       // a folder
  EXPECT_EQ(find("maps/"), "");
  EXPECT_EQ(find(""), "");
  EXPECT_EQ(find(std::string(300, 'n')),
            "");  // longer than a name may be: the system reports an error, not a missing file
  EXPECT_EQ(find("C:\\" + std::string(300, 'n') + "\\wood.png"), "Wood.PNG");
}

TEST(FindBeside, AFileOutsideIsTakenWithPermissionOnly) {
  const std::string out = make_file("out.png", "");
  const std::string folder = test::temporary("inner"), model = folder + "/m.obj";
  std::filesystem::create_directory(folder);
  EXPECT_NE(error_of([&] { find_beside(out, model, Outside::refused); }).find("give --allow-outside"),
            std::string::npos);
  EXPECT_EQ(find_beside(out, model, Outside::allowed), out);
  std::ofstream(folder + "/out.png") << "";
  EXPECT_EQ(find_beside(out, model, Outside::refused), folder + "/out.png");  // the one inside needs none
}

TEST(FileKind, FilesOfOtherProgramsAreNamedWithWhatToDo) {
  const auto kind = [](const std::string& bytes) { return kind_of_file(make_file("f", bytes)); };
  EXPECT_EQ(kind("BLENDER-v293"), "a Blender file; export it from Blender as glTF (.glb)");
  EXPECT_TRUE(kind("PXR-USDC\x00\x09"s).starts_with("a USD scene; export"));
  EXPECT_TRUE(kind("#usda 1.0\n").starts_with("a USD scene; export"));
  EXPECT_TRUE(kind("# a room\nLookAt 0 0 5 0 0 0 0 1 0\nWorldBegin\n").starts_with("a pbrt scene; name its meshes"));
  EXPECT_TRUE(
      kind("<?xml version=\"1.0\"?>\n<scene version=\"3.0.0\">").starts_with("a Mitsuba scene; name its meshes"));
  EXPECT_EQ(kind("PK\x03\x04"), "a ZIP archive; unpack it");
  EXPECT_TRUE(kind("\xef\xbb\xbf<?xml version=\"1.0\"?><COLLADA>").starts_with("a COLLADA file, a model"));
  EXPECT_TRUE(kind("1 2 3 255 0 0\n4 5 6 0 0 255\n").starts_with("points as text; save them as PLY"));
  EXPECT_TRUE(kind("//X,Y,Z\n1.5,2,-3e2\n").starts_with("points as text"));
  EXPECT_EQ(kind("1 2\n3 4\n"), "another kind of file");
  EXPECT_TRUE(kind("\xff\xfev\0 \0"s).starts_with("a text in UTF-16"));
}

TEST(FileKind, APointerOfGitLfsIsNamedByEveryReader) {
  for (const char* name : {"m.obj", "m.ply", "m.glb", "s.toml", "f.npy", "i.png", "n.txt"}) {
    const std::string path =
        make_file(name, "version https://git-lfs.github.com/spec/v1\noid sha256:abc\nsize 12345\n");
    EXPECT_EQ(error_of([&] { check_file_exists(path, "a thing"); }),
              path + ": expected a thing, got a pointer of Git LFS in its place; fetch it by `git lfs pull`");
  }
}

}  // namespace
}  // namespace holotrace
