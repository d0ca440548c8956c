#pragma once

#include <OpenEXR/ImfThreading.h>

#include "holotrace/base/thread_count.h"

namespace holotrace {

/// Gives OpenEXR's pool of threads, which has none at first, as many as all else here has.
inline void start_exr_threads() {
  if (Imf::globalThreadCount() == 0) Imf::setGlobalThreadCount(thread_count());
}

}  // namespace holotrace
