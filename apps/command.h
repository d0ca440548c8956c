#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

// Commands and their flags. CLI11 does the work in command.cpp; it takes a compiler seconds, so no other header has it.

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace holotrace {

/// A flag or an argument of a command. Each call returns the option itself.
class Option {
 public:
  explicit Option(CLI::Option* option) : option_(option) {}

  Option* required();
  Option* type_name(const std::string& name);  ///< what the help text calls the value
  Option* group(const std::string& heading);   ///< of the help text; "": hidden
  Option* excludes(Option* other);
  Option* excludes(const std::string& flag);
  Option* delimiter(char between);  ///< of the values in one text
  /// @param problem  what is wrong with a text; "" if nothing is
  Option* check(const std::function<std::string(const std::string&)>& problem, const std::string& type = "",
                const std::string& name = "");

 private:
  CLI::Option* option_;
};

/// A command or a subcommand. What options write to must live as long as the command.
class Command {
 public:
  explicit Command(CLI::App& app);
  ~Command();
  Command(const Command&) = delete;
  Command& operator=(const Command&) = delete;

  Command* add_subcommand(const std::string& name, const std::string& help);
  void require_subcommand(int count);

  /// @param name  "-o,--output" of a flag, or "field" of an argument
  Option* add_option(const std::string& name, std::string& value, const std::string& help = "");
  Option* add_option(const std::string& name, std::vector<std::string>& value, const std::string& help = "");
  Option* add_option(const std::string& name, int& value, const std::string& help = "");
  Option* add_option(const std::string& name, double& value, const std::string& help = "");
  Option* add_option(const std::string& name, std::optional<int>& value, const std::string& help = "");
  Option* add_option(const std::string& name, std::optional<int64_t>& value, const std::string& help = "");
  Option* add_option(const std::string& name, std::optional<uint32_t>& value, const std::string& help = "");
  Option* add_flag(const std::string& name, bool& value, const std::string& help);
  /// A flag whose text goes to a function.
  Option* add_option_function(const std::string& name, const std::function<void(const std::string&)>& take,
                              const std::string& help = "");

  /// From here on --help shows the examples and these flags only, and --help-all shows all flags.
  void shorten_help(const std::vector<std::string>& examples, const std::vector<std::string>& flags);

  /// What the command does.
  void callback(const std::function<void()>& action);

  /// How often a flag was given.
  size_t count(const std::string& flag) const;

 private:
  Option* keep(CLI::Option* option);

  CLI::App& app_;
  std::vector<std::unique_ptr<Option>> options_;
  std::vector<std::unique_ptr<Command>> subcommands_;
};

/// Wrong usage that only a command itself can see. The program then prints the sentence and ends with 2.
[[noreturn]] void fail_as_missing(const std::string& what);
[[noreturn]] void fail_as_extra(const std::vector<std::string>& arguments);
[[noreturn]] void fail_as_excluded(const std::string& flag, const std::string& other);

}  // namespace holotrace
