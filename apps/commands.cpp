#include "commands.h"

#include <fmt/format.h>

#include <filesystem>

#include "holotrace/base/error.h"
#include "holotrace/base/message_text.h"
#include "holotrace/io/files/file.h"
#include "holotrace/io/run_folder.h"

namespace holotrace {

void add_shutter(CLI::App& command, std::string& text) {
  command
      .add_option(
          "--shutter", text,
          "time for which the shutter is open, from the time of the scene on: what moves meanwhile is blurred. Or an angle: 360 deg is "
          "the interval between two times of a film, 1/fps of [animate] [the scene's, or 0 s]")
      ->type_name("TIME|ANGLE");
}

Shutter parse_shutter_flag(const std::string& text, const Job& job) {
  if (text.empty()) return job.shutter;
  try {
    return parse_shutter(text);
  } catch (const Error& e) {
    fail("--shutter: {}", e.what());
  }
}

void add_last(CLI::App& command, std::string& path) {
  command
      .add_option(
          "--last", path,
          "sgd, films: holograms of the last picture (NAME, NAME_2, …), or the folder of its run. The iterations go "
          "on from their levels, with small steps, and need a fifth of the number (--next-iterations)")
      ->type_name("HOLOGRAM.png|DIR");
}

std::vector<Hologram> load_last(const std::string& path) {
  if (path.empty()) return {};
  std::vector<std::string> paths{path};
  if (std::filesystem::is_directory(path))
    paths = list_complete_run(path).holograms;
  else if (const std::vector<std::string> series = numbered_series(path); !series.empty())
    paths = series;
  std::vector<Hologram> holograms;
  for (const std::string& one : paths) holograms.push_back(load_hologram(one));
  return holograms;
}

void print_facts(const Json& facts, bool is_json) {
  if (is_json) {
    fmt::print("{}\n", facts.dump(2, ' ', false, Json::error_handler_t::replace));
    return;
  }
  for (const auto& [name, value] : facts.items())
    fmt::print("{:<28} {}\n", printable(name),
               value.is_number_float() ? fmt::format("{:.6g}", value.get<double>())
               : value.is_null()       ? std::string("infinite")
               : value.is_string()     ? printable(value.get<std::string>())
                                       : printable(value.dump(-1, ' ', false, Json::error_handler_t::replace)));
}

}  // namespace holotrace
