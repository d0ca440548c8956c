#include "holotrace/base/memory.h"

#include <unistd.h>

#include "holotrace/base/error.h"
#include "holotrace/base/units.h"

namespace holotrace {

double physical_memory() { return double(sysconf(_SC_PHYS_PAGES)) * double(sysconf(_SC_PAGE_SIZE)); }

void require_memory(double bytes, std::string_view what) {
  const double present = physical_memory();
  require(bytes <= present, "expected {} to fit in memory, but it needs {} and this machine has {}; use fewer samples",
          what, format_bytes(bytes), format_bytes(present));
}

}  // namespace holotrace
