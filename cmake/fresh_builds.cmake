# Most of what a compiler does here is the same for each file: reading headers, and templates of the standard library, of
# fmt and of JSON. Two measures, each an option, spare it in fresh builds. A compiler cache such as ccache does better
# without them, and clang-tidy cannot read the precompiled headers of GCC.
set(fresh ON)
if(CMAKE_CXX_COMPILER_LAUNCHER OR CMAKE_CXX_CLANG_TIDY)
  set(fresh OFF)
endif()
option(HOLOTRACE_PRECOMPILED_HEADERS "Precompile the headers that most files include" ${fresh})
option(HOLOTRACE_COMPILE_TOGETHER "Compile the files of a folder together, up to 16 at a time" ${fresh})

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

# compile_together(TARGET MOST): the files of each folder, up to MOST of them at a time, so their anonymous namespaces share
# names. Files with compiler options of their own stay alone, and so do those that define macros, as files for several
# instruction sets do.
function(compile_together target most)
  if(NOT HOLOTRACE_COMPILE_TOGETHER)
    return()
  endif()
  get_target_property(sources ${target} SOURCES)
  set(group 0)
  set(folders "")
  foreach(source ${sources})
    get_filename_component(source ${source} ABSOLUTE)
    get_filename_component(folder ${source} DIRECTORY)
    if(NOT source MATCHES "\\.cpp$" OR NOT EXISTS ${source})  # the build makes some
      continue()
    endif()
    file(STRINGS ${source} macros REGEX "^#define" LIMIT_COUNT 1)
    if(macros)
      continue()
    endif()
    list(APPEND folders ${folder})
    list(APPEND files_of_${folder} ${source})
  endforeach()
  list(REMOVE_DUPLICATES folders)
  foreach(folder ${folders})
    set(in_group ${most})
    foreach(source ${files_of_${folder}})
      if(in_group EQUAL most)
        math(EXPR group "${group} + 1")
        set(in_group 0)
      endif()
      math(EXPR in_group "${in_group} + 1")
      set_source_files_properties(${source} PROPERTIES UNITY_GROUP ${group})
    endforeach()
  endforeach()
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
endfunction()
