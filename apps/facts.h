#pragma once

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

namespace holotrace {

using Json = nlohmann::ordered_json;

/// Prints facts, one line each with name and value; or as JSON.
void print_facts(const Json& facts, bool is_json);

/// A number as JSON; null if it is infinite, such as the PSNR of equal images.
inline Json number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

}  // namespace holotrace
