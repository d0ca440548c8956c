#pragma once

#include "ranks.h"

namespace holotrace {

/// The function of every rank other than rank 0: does what rank 0 asks for until it reports the end.
void serve_ranks(Ranks& ranks);

/// Lets the other ranks end, or ends them at once if they are working when the work has failed here.
void dismiss_ranks(Ranks& ranks, int exit_code);

}  // namespace holotrace
