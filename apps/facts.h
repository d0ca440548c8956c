#pragma once

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

#include "holotrace/base/printable.h"

namespace holotrace {

using Json = nlohmann::ordered_json;

/// Prints facts, one line each with name and value; or as JSON.
inline void print_facts(const Json& facts, bool is_json) {
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

/// A number as JSON; null if it is infinite, such as the PSNR of equal images.
inline Json number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

}  // namespace holotrace
