// JSON: metadata and reports.
#include <nlohmann/json.hpp>

#include "../reader.h"
#include "holotrace/base/message_text.h"
#include "holotrace/io/files/text.h"

using namespace holotrace;

int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const std::string text(fuzz::text_of(data, size));
  fuzz::read([&] { parse_json(text, "report.json").dump(); });
  if (printable(text).find(char(27)) != std::string::npos) std::abort();
  return 0;
}
