#include "holotrace/run/field_fingerprint.h"

#include "holotrace/base/fingerprint.h"
#include "holotrace/data/members.h"

namespace holotrace {

uint64_t field_fingerprint(const Grid& panel, const SynthesizeParams& params, const std::vector<const Sources*>& sets,
                           const std::vector<int>& first_rows) {
  BasicWriter<FnvHash> hash;
  hash(std::string(HOLOTRACE_VERSION), panel, params.method, params.tolerance, params.device, first_rows);
  for (const Sources* set : sets) hash(*set);
  return hash.sink.value();
}

}  // namespace holotrace
