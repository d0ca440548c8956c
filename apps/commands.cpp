#include "commands.h"

#include <fmt/format.h>

#include "holotrace/base/message_text.h"

namespace holotrace {

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
