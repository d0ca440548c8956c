#pragma once

#include <nlohmann/json.hpp>

namespace holotrace {

/// Speed of path tracing on a built-in chess-like scene: rays per second inside `trace`, those of Embree alone on the
/// same rays from memory and the same threads, and their ratio.
nlohmann::ordered_json bench_trace();

}  // namespace holotrace
