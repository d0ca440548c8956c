#include "usage_error.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <sstream>
#include <vector>

#include "holotrace/base/suggest.h"

namespace holotrace {
namespace {

// The command that was given, such as `calibrate fit`.
const CLI::App* command_of(const CLI::App& app) {
  const CLI::App* command = &app;
  while (!command->get_subcommands().empty()) command = command->get_subcommands().front();
  return command;
}

std::string name_of(const CLI::App* command) {
  std::string name = "holotrace";
  std::vector<std::string> parts;
  for (; command->get_parent() != nullptr; command = command->get_parent()) parts.push_back(command->get_name());
  for (auto part = parts.rbegin(); part != parts.rend(); ++part) name += " " + *part;
  return name;
}

std::vector<std::string> flags_of(const CLI::App* command) {
  std::vector<std::string> names;
  for (; command != nullptr; command = command->get_parent())
    for (const CLI::Option* option : command->get_options()) {
      if (option->get_group().empty()) continue;  // an old name
      for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
      for (const std::string& name : option->get_snames()) names.push_back("-" + name);
    }
  return names;
}

bool is_flag(const std::string& argument) { return argument.size() > 1 && argument.front() == '-'; }

// The first argument that nothing takes; "" if there is none. CLI11 keeps such arguments, or names them in its message. A
// flag goes first: the word after it may be its value, and may also stand elsewhere as the value of a known flag.
std::string first_unknown(const CLI::App& app, const CLI::ParseError& error, int argc, const char* const* argv) {
  std::vector<std::string> unknown = app.remaining(true);
  if (dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr) {
    const std::string text = error.what();
    std::istringstream words(text.substr(std::min(text.find(": "), text.size() - 1) + 1));
    for (std::string word; words >> word;) unknown.push_back(word);
  }
  const auto is_unknown = [&](const std::string& argument) {
    return std::find(unknown.begin(), unknown.end(), argument) != unknown.end();
  };
  const std::vector<std::string> arguments(argv + std::min(argc, 1), argv + argc);
  auto found = std::find_if(arguments.begin(), arguments.end(),
                            [&](const std::string& argument) { return is_flag(argument) && is_unknown(argument); });
  if (found == arguments.end()) found = std::find_if(arguments.begin(), arguments.end(), is_unknown);
  return found == arguments.end() ? "" : *found;
}

std::vector<std::string> subcommands_of(const CLI::App* command) {
  std::vector<std::string> names;
  for (const CLI::App* sub : command->get_subcommands({})) names.push_back(sub->get_name());
  return names;
}

std::string unknown_flag(const CLI::App* command, const std::string& argument) {
  const std::string flag = argument.substr(0, argument.find('='));
  const std::vector<std::string> known = flags_of(command);
  if (std::find(known.begin(), known.end(), flag) != known.end())
    return fmt::format("expected {} after the command, got it before; write `{} … {}`", flag, name_of(command), flag);
  const std::string nearest = flag.starts_with("--") ? nearest_name(flag, known) : "";
  if (nearest.empty())
    return fmt::format("unknown flag \"{}\"; `{} {}` lists the flags", flag, name_of(command),
                       command->get_help_all_ptr() == nullptr ? "--help" : "--help-all");
  return fmt::format("unknown flag \"{}\"; did you mean \"{}\"?", flag, nearest);
}

// The value that an option takes, as its help text says it.
std::string value_of(const CLI::Option* option) {
  const std::string type = option->get_type_name();
  const std::string name = option->get_positional() ? option->get_single_name() : option->get_name();
  return option->get_positional() ? fmt::format("{} ({})", type, name) : fmt::format("{} {}", name, type);
}

// What the text of an option's value must be.
std::string kind_of(const CLI::Option* option) {
  const std::string type = option->get_type_name();
  if (type.empty()) return "no value";
  return type == "N" ? "a whole number" : type;
}

// What is missing, of the arguments that a command needs.
std::string missing(const CLI::App* command, const std::string& message) {
  for (const CLI::Option* option : command->get_options())
    if (option->get_required() && option->count() == 0) return fmt::format("expected {}, got none", value_of(option));
  const std::vector<std::string> names = subcommands_of(command);
  if (!names.empty()) return fmt::format("expected a command, got none; known: {}", fmt::join(names, ", "));
  const std::string what = message.substr(0, message.rfind(" is required"));  // of a command that checks it itself
  return fmt::format("expected {}, got none", what);
}

const CLI::Option* option_named(const CLI::App* command, const std::string& name) {
  for (; command != nullptr; command = command->get_parent())
    if (const CLI::Option* option = command->get_option_no_throw(name)) return option;
  return nullptr;
}

}  // namespace

std::string usage_message(const CLI::App& app, const CLI::ParseError& error, int argc, const char* const* argv) {
  const CLI::App* command = command_of(app);
  const std::string text = error.what();
  if (const std::string unknown = first_unknown(app, error, argc, argv); !unknown.empty()) {
    if (is_flag(unknown)) return unknown_flag(command, unknown);
    if (const auto names = subcommands_of(command); !names.empty())
      return unknown_name_message("command", unknown, names);
    return fmt::format("expected no further argument, got \"{}\"; `{} --help` lists the arguments", unknown,
                       name_of(command));
  }
  const std::string conversion = "Could not convert: ";
  const size_t begin = text.starts_with(conversion) ? conversion.size() : 0;
  const size_t end = begin > 0 ? text.find(" = ", begin) : text.find(':');
  const CLI::Option* option =
      end == std::string::npos ? nullptr : option_named(command, text.substr(begin, end - begin));
  if (dynamic_cast<const CLI::RequiredError*>(&error) != nullptr) return missing(command, text);
  if (option == nullptr) return text;
  if (dynamic_cast<const CLI::ConversionError*>(&error) != nullptr)
    return fmt::format("{}: expected {}, got \"{}\"", option->get_name(), kind_of(option),
                       fmt::join(option->results(), " "));
  if (dynamic_cast<const CLI::ArgumentMismatch*>(&error) != nullptr) {
    if (option->results().size() > 1)
      return fmt::format("expected {} once, got it {} times", option->get_name(), option->results().size());
    return fmt::format("expected {}, got no value", value_of(option));
  }
  return text;
}

}  // namespace holotrace
