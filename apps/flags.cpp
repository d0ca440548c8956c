#include "flags.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <sstream>
#include <vector>

#include "console.h"
#include "holotrace/base/message_text.h"
#include "holotrace/data/params/renamed.h"

namespace holotrace {

std::string with_bounds(const std::string& help, const Range& range, Quantity quantity) {
  const bool is_plain = range.low == 0 && !range.is_low_open && !std::isfinite(range.high);
  const std::string bounds = bounds_text(range, quantity);
  return is_plain || bounds.empty() ? help : fmt::format("{} ({})", help, bounds);
}

namespace {

template <class Format>
std::string joined(const std::vector<double>& values, const Format& format) {
  std::string text;
  for (const double value : values) text += (text.empty() ? "" : ", ") + format(value);
  return text;
}

}  // namespace

std::string format_lengths(const std::vector<double>& metres) { return joined(metres, format_length); }
std::string format_times(const std::vector<double>& seconds) { return joined(seconds, format_time); }

std::string dashed(std::string name) {
  std::replace(name.begin(), name.end(), '_', '-');
  return name == "distances" ? "--distance" : "--" + name;
}

void check_flag(const char* flag, double value, const Range& range, Quantity quantity) {
  read_flag(flag, [&] { check_range(value, range, quantity); });
}

double parse_length_flag(const char* flag, const std::string& text, const Range& range) {
  return read_flag(flag, [&] { return value_within(text, range, flag, Quantity::length); });
}

double parse_angle_flag(const char* flag, const std::string& text, const Range& range) {
  return read_flag(flag, [&] { return value_within(text, range, flag, Quantity::angle); });
}

double parse_time_flag(const char* flag, const std::string& text) {
  return read_flag(flag, [&] { return value_within(text, range::any, flag, Quantity::time); });
}

double parse_size_flag(const char* flag, const std::string& text) {
  return read_flag(flag, [&] { return parse_size(text); });
}

double parse_wavelength_flag(const std::string& text) {
  return read_flag("--wavelength",
                   [&] { return value_within(text, range::positive, "--wavelength", Quantity::wavelength); });
}

std::vector<double> parse_wavelengths_flag(const std::string& text) {
  return read_flag("--wavelength",
                   [&] { return values_within(text, range::positive, "--wavelength", Quantity::wavelength); });
}

void Flags::add_flag(CLI::App& command, const std::string& name, const FlagText& text, const std::string& group,
                     const std::map<std::string, std::string>& from) {
  const std::string other = name == "distances" ? ",--distances" : "";
  const auto keep = [this, name](const std::string& given) { texts_[name] = given; };
  const auto origin = from.find(name);
  const std::string value = origin == from.end() ? text.value : origin->second + ", or " + text.value;
  CLI::Option* option =
      command.add_option_function<std::string>(flag_of(name) + other, keep, text.help + " [" + value + "]");
  option->type_name(text.kind);
  if (!group.empty()) option->group(group);
  if (const char* before = name_before(name)) add_old_name(command, name, before);
}

// The flag with its old name; the help text leaves it out. Its callback is called after that of the new one.
void Flags::add_old_name(CLI::App& command, const std::string& name, const std::string& before) {
  const auto keep = [this, name, before](const std::string& given) {
    if (has(name)) throw CLI::ExcludesError(dashed(before), dashed(name));
    texts_[name] = given;
    say("warning: {}\n", renamed_message(dashed(before), dashed(name)));
  };
  command.add_option_function<std::string>(dashed(before), keep)->group("");
}

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

// Of a command of commands: the argument behind its name, where none of them was named; else "".
std::string word_after(const CLI::App* command, const CLI::App& app, int argc, const char* const* argv) {
  if (command == &app || subcommands_of(command).empty()) return "";
  const std::vector<std::string> arguments(argv + std::min(argc, 1), argv + argc);
  const auto name = std::find(arguments.begin(), arguments.end(), command->get_name());
  return name == arguments.end() || name + 1 == arguments.end() ? "" : *(name + 1);
}

const CLI::Option* option_named(const CLI::App* command, const std::string& name) {
  for (; command != nullptr; command = command->get_parent())
    if (const CLI::Option* option = command->get_option_no_throw(name)) return option;
  return nullptr;
}

}  // namespace

std::vector<std::string> with_bare_flags(const CLI::App& app, int argc, const char* const* argv) {
  const std::vector<std::string> truths{"true", "false", "yes", "no", "on", "off", "1", "0"};
  std::vector<std::string> arguments(argv + std::min(argc, 1), argv + argc);
  const CLI::App* command = &app;
  for (size_t i = 0; i < arguments.size(); ++i) {
    std::string& argument = arguments[i];
    for (const CLI::App* sub : command->get_subcommands({}))
      if (sub->get_name() == argument) {
        command = sub;
        break;
      }
    if (argument == "--") break;  // names of files follow
    if (!argument.starts_with("--")) continue;
    const CLI::Option* option = option_named(command, argument);
    if (option == nullptr || option->get_type_name() != "BOOL") continue;
    std::string next = i + 1 < arguments.size() ? arguments[i + 1] : "";
    std::transform(next.begin(), next.end(), next.begin(), [](unsigned char c) { return char(std::tolower(c)); });
    const bool has_value = std::find(truths.begin(), truths.end(), next) != truths.end();
    if (!has_value) argument += "=true";
  }
  return arguments;
}

std::string usage_message(const CLI::App& app, const CLI::ParseError& error, int argc, const char* const* argv) {
  const CLI::App* command = command_of(app);
  const std::string text = error.what();
  if (const std::string word = word_after(command, app, argc, argv); !word.empty() && !is_flag(word))
    return unknown_name_message("command", word, subcommands_of(command));
  if (const std::string unknown = first_unknown(app, error, argc, argv); !unknown.empty()) {
    const std::string first = argc > 1 ? argv[1] : "";
    if (command == &app && !first.empty() && !is_flag(first))
      return unknown_name_message("command", first, subcommands_of(command));
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
