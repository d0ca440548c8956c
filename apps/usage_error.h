#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace holotrace {

/// What is wrong with the arguments of the program, in one sentence, with the nearest known command or flag.
std::string usage_message(const CLI::App& app, const CLI::ParseError& error, int argc, const char* const* argv);

}  // namespace holotrace
