# Writes OUTPUT, which defines source_commit (apps/bench/commit.h), if the commit of SOURCE has changed. For cmake -P.
set(commit "unknown")
find_program(git git)
if(git)
  execute_process(COMMAND ${git} -C ${SOURCE} rev-parse --show-toplevel
                  OUTPUT_VARIABLE repository ERROR_QUIET OUTPUT_STRIP_TRAILING_WHITESPACE)
  file(REAL_PATH ${SOURCE} source)
endif()
if(git AND repository STREQUAL source)  # not a repository around it
  execute_process(COMMAND ${git} -C ${SOURCE} describe --always --dirty --abbrev=8 --exclude "*"
                  OUTPUT_VARIABLE described ERROR_QUIET OUTPUT_STRIP_TRAILING_WHITESPACE)
  if(described)
    set(commit ${described})
  endif()
endif()
file(CONFIGURE OUTPUT ${OUTPUT} CONTENT [[#include "bench/commit.h"

const char* const holotrace::source_commit = "@commit@";
]] @ONLY)
