#include "command.h"

#include <CLI/CLI.hpp>
#include <algorithm>

namespace holotrace {
namespace {

// Help with examples and the common flags, where --help-all has all of them.
class ShortHelp : public CLI::Formatter {
 public:
  ShortHelp(const std::vector<std::string>& examples, const std::vector<std::string>& flags) : flags_(flags) {
    for (const std::string& example : examples) examples_ += "  " + example + "\n";
  }

  std::string make_help(const CLI::App* app, std::string name, CLI::AppFormatMode mode) const override {
    if (mode == CLI::AppFormatMode::All) return Formatter::make_help(app, name, CLI::AppFormatMode::Normal);
    const auto is_common = [&](const CLI::Option* option) {
      return std::any_of(flags_.begin(), flags_.end(),
                         [&](const std::string& flag) { return option->check_name(flag); });
    };
    return make_description(app) + make_usage(app, name) + "\nExamples:\n" + examples_ + make_positionals(app) +
           make_group("Common options", false, app->get_options(is_common)) + "\n" + make_footer(app);
  }

 private:
  std::vector<std::string> flags_;
  std::string examples_;
};

}  // namespace

Option* Option::required() {
  option_->required();
  return this;
}

Option* Option::type_name(const std::string& name) {
  option_->type_name(name);
  return this;
}

Option* Option::group(const std::string& heading) {
  option_->group(heading);
  return this;
}

Option* Option::excludes(Option* other) {
  option_->excludes(other->option_);
  return this;
}

Option* Option::excludes(const std::string& flag) {
  option_->excludes(flag);
  return this;
}

Option* Option::delimiter(char between) {
  option_->delimiter(between);
  return this;
}

Option* Option::check(const std::function<std::string(const std::string&)>& problem, const std::string& type,
                      const std::string& name) {
  option_->check(problem, type, name);
  return this;
}

Command::Command(CLI::App& app) : app_(app) {}
Command::~Command() = default;

Option* Command::keep(CLI::Option* option) { return options_.emplace_back(std::make_unique<Option>(option)).get(); }

Command* Command::add_subcommand(const std::string& name, const std::string& help) {
  return subcommands_.emplace_back(std::make_unique<Command>(*app_.add_subcommand(name, help))).get();
}

void Command::shorten_help(const std::vector<std::string>& examples, const std::vector<std::string>& flags) {
  app_.set_help_all_flag("--help-all", "Print all flags and exit");
  const auto help = std::make_shared<ShortHelp>(examples, flags);
  help->column_width(app_.get_formatter()->get_column_width());
  app_.formatter(help);
}

void Command::require_subcommand(int count) { app_.require_subcommand(count); }

Option* Command::add_option(const std::string& name, std::string& value, const std::string& help) {
  return keep(app_.add_option(name, value, help));
}

Option* Command::add_option(const std::string& name, std::vector<std::string>& value, const std::string& help) {
  return keep(app_.add_option(name, value, help));
}

Option* Command::add_option(const std::string& name, int& value, const std::string& help) {
  return keep(app_.add_option(name, value, help));
}

Option* Command::add_option(const std::string& name, double& value, const std::string& help) {
  return keep(app_.add_option(name, value, help));
}

Option* Command::add_option(const std::string& name, std::optional<int>& value, const std::string& help) {
  return keep(app_.add_option(name, value, help));
}

Option* Command::add_option(const std::string& name, std::optional<int64_t>& value, const std::string& help) {
  return keep(app_.add_option(name, value, help));
}

Option* Command::add_option(const std::string& name, std::optional<uint32_t>& value, const std::string& help) {
  return keep(app_.add_option(name, value, help));
}

Option* Command::add_flag(const std::string& name, bool& value, const std::string& help) {
  return keep(app_.add_flag(name, value, help));
}

Option* Command::add_option_function(const std::string& name, const std::function<void(const std::string&)>& take,
                                     const std::string& help) {
  return keep(app_.add_option_function<std::string>(name, take, help));
}

void Command::callback(const std::function<void()>& action) { app_.callback(action); }

size_t Command::count(const std::string& flag) const { return app_.count(flag); }

void fail_as_missing(const std::string& what) { throw CLI::RequiredError(what); }
void fail_as_extra(const std::vector<std::string>& arguments) { throw CLI::ExtrasError(arguments); }
void fail_as_excluded(const std::string& flag, const std::string& other) { throw CLI::ExcludesError(flag, other); }

}  // namespace holotrace
