// Path expressions, and lengths and angles with units.
#include "holotrace/data/path_expression.h"

#include "../reader.h"
#include "holotrace/base/units.h"

using namespace holotrace;

int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const std::string text(fuzz::text_of(data, size));
  fuzz::read([&] { const PathAutomaton automaton({text}); });
  fuzz::read([&] { parse_lengths(text); });
  fuzz::read([&] { parse_angle(text); });
  fuzz::read([&] { parse_size(text); });
  return 0;
}
