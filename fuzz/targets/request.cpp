// Requests of a browser: the head, who may ask, and the query with the settings of a view.
#include "../reader.h"
#include "holotrace/viewer/http.h"
#include "holotrace/viewer/requests.h"

using namespace holotrace;

int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const std::string text(fuzz::text_of(data, size));
  const auto end = end_of_head(text);
  const auto request = parse_head(text.substr(0, end.value_or(size)));
  if (request) {
    if (request->path.empty() || request->path.front() != '/') std::abort();
    const Access access{"secret", "127.0.0.1", 8080};
    if (access.refusal(*request).empty() && !request->path.starts_with("/secret/")) std::abort();
  }
  fuzz::read([&] {
    const Query query = parse_query(request ? request->query : text);
    show_arguments(query);
    view_state(query, {}, 3);
  });
  return 0;
}
