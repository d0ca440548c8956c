# Standard headers are most of what a compiler reads here: precompiled once for each target, a fresh build takes two thirds
# of the processor time. A compiler cache such as ccache does better without them, and clang-tidy cannot read those of GCC.
set(precompile ON)
if(CMAKE_CXX_COMPILER_LAUNCHER OR CMAKE_CXX_CLANG_TIDY)
  set(precompile OFF)
endif()
option(HOLOTRACE_PRECOMPILED_HEADERS "Precompile the headers that most files include" ${precompile})

set(HOLOTRACE_COMMON_HEADERS
  <algorithm> <array> <cmath> <complex> <cstdint> <filesystem> <fstream> <functional> <map> <memory> <optional> <random>
  <string> <variant> <vector> <fmt/format.h> "${PROJECT_SOURCE_DIR}/src/holotrace/base/error.h"
  "${PROJECT_SOURCE_DIR}/src/holotrace/base/threads.h")

# precompile_headers(TARGET [HEADER…]): the common headers and those that are named.
function(precompile_headers target)
  if(HOLOTRACE_PRECOMPILED_HEADERS)
    target_precompile_headers(${target} PRIVATE ${HOLOTRACE_COMMON_HEADERS} ${ARGN})
  endif()
endfunction()
