// holotrace examples: lists the example scenes that come with the program, or copies them into a folder.

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <memory>
#include <vector>

#include "commands.h"
#include "console.h"
#include "holotrace/base/error.h"
#include "holotrace/base/message_text.h"
#include "holotrace/io/files/file.h"
#include "holotrace/io/files/shipped_files.h"
#include "holotrace/io/files/text.h"

namespace holotrace {
namespace {

namespace fs = std::filesystem;

// The files of the example scenes, in alphabetical order.
std::vector<fs::path> example_files() {
  const std::vector<std::string> folders = shipped_folders("examples");
  require(!folders.empty(),
          "expected the folder of the example scenes beside the program, found none; install Holotrace again");
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(folders.front()))
    if (entry.is_regular_file()) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

// The first sentence of the comment that begins a scene file.
std::string first_sentence(const std::string& scene) {
  std::string comment;
  for (size_t begin = 0; begin < scene.size() && scene[begin] == '#';) {
    const size_t end = std::min(scene.find('\n', begin), scene.size());
    comment += scene.substr(begin + 1, end - begin - 1);  // with the space behind the #
    begin = end + 1;
  }
  comment.erase(0, comment.find_first_not_of(' '));
  size_t end = comment.find(". ");
  while (end != std::string::npos && std::isupper(static_cast<unsigned char>(comment[end + 2])) == 0)
    end = comment.find(". ", end + 2);  // of "Fig. 10"
  return comment.substr(0, end);
}

void list_examples() {
  for (const fs::path& file : example_files())
    if (file.extension() == ".toml")
      fmt::print("{:<30} {}\n", file.filename().string(), printable(first_sentence(read_text(file.string()))));
  fmt::print("to copy them: holotrace examples -o examples\n");
}

// Files that are there with other content are the user's.
void copy_examples(const std::string& folder) {
  const std::vector<fs::path> files = example_files();
  const auto is_changed = [&](const fs::path& file) {
    const fs::path copy = fs::path(folder) / file.filename();
    return is_there(copy.string()) && read_text(copy.string()) != read_text(file.string());
  };
  const auto changed = std::find_if(files.begin(), files.end(), is_changed);
  require(changed == files.end(), "expected a folder without changed examples, got {}; give another folder by -o",
          changed == files.end() ? "" : (fs::path(folder) / changed->filename()).string());
  make_folder(folder);
  for (const fs::path& file : files)
    if (const std::string copy = (fs::path(folder) / file.filename()).string(); !is_there(copy))
      write_text(copy, read_text(file.string()));
}

}  // namespace

void add_examples_command(CLI::App& app, const GlobalFlags& global) {
  CLI::App* command =
      app.add_subcommand("examples", "list of the example scenes that come with the program, or copies of them");
  auto folder = std::make_shared<std::string>();
  command->add_option("-o,--output", *folder, "folder for copies of all examples; files that you changed stay")
      ->type_name("DIR");
  command->callback([folder, &global] {
    if (folder->empty()) return list_examples();
    copy_examples(*folder);
    if (!global.is_quiet)
      fmt::print("written to {0}; to make the first hologram: holotrace run {0}/fig06_wireframe_cube.toml -o cube\n",
                 *folder);
  });
}

}  // namespace holotrace
