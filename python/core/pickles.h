#pragma once

#include <string>
#include <string_view>

#include "holotrace/base/archive.h"
#include "holotrace/base/error.h"
#include "holotrace/data/members.h"
#include "records.h"

// Nouns as bytes, for pickle and copy.

namespace holotrace::python {

template <class Archive>
void members(Archive& archive, RunRecord& part) {
  auto& [job, report, points, radiances, eye_light] = part;  // the last is traced again
  archive(job, report, points, radiances);
}
template <class Archive>
void members(Archive& archive, ViewRecord& part) {
  auto& [camera, eye_separation, report] = part;
  archive(camera, eye_separation, report);
}

/// The noun as bytes, headed by the version that they are for.
template <class Noun>
std::string to_bytes(const Noun& noun) {
  return to_message(std::string(HOLOTRACE_VERSION), noun);
}

/// @throws Error  for bytes of another version, and for damaged ones
template <class Noun>
Noun from_bytes(std::string_view bytes) {
  Reader reader(bytes, "a pickled object");
  std::string version;
  reader(version);
  require(version == HOLOTRACE_VERSION, "expected an object pickled by holotrace {}, got one of {}; make it again",
          HOLOTRACE_VERSION, version);
  Noun noun;
  reader(noun);
  require(reader.is_at_end(), "expected the end of a pickled object, got more bytes");
  return noun;
}

}  // namespace holotrace::python
