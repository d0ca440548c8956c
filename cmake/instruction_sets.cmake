# Instruction sets for which loops in vectors are compiled, as definitions for Highway: sets instruction_sets. A program chooses among them
# when it starts.
set(HOLOTRACE_INSTRUCTION_SETS ALL CACHE STRING
    "Compile loops for every instruction set (ALL), or for the best of this machine's processor alone (OWN), which takes less time")
set_property(CACHE HOLOTRACE_INSTRUCTION_SETS PROPERTY STRINGS ALL OWN)

if(CMAKE_SYSTEM_PROCESSOR MATCHES "^(aarch64|arm64)$")
  # NEON alone, which all of them have. Highway would add SVE, whose vectors, of a length that is known only at run time, cannot
  # stand in arrays, and ask for the instructions of AES, which a Raspberry Pi 4 lacks.
  set(instruction_sets TOOLCHAIN_MISS_SYS_AUXV_H)
elseif(CMAKE_SYSTEM_PROCESSOR MATCHES "^(x86_64|AMD64|amd64)$")
  # The bits of Highway's targets. No processor made since 2008 has SSSE3 and not SSE4.1. One that has none of these runs plain loops.
  set(ssse3 4096)
  set(sse4 2048)
  set(avx2 512)
  set(left_out ${ssse3})
  if(HOLOTRACE_INSTRUCTION_SETS STREQUAL "OWN" AND EXISTS /proc/cpuinfo)
    file(STRINGS /proc/cpuinfo flags REGEX "^flags" LIMIT_COUNT 1)
    if(flags MATCHES " avx512f .* avx512bw .*avx512vl ")
      math(EXPR left_out "${ssse3} | ${sse4} | ${avx2}")
    elseif(flags MATCHES " avx2 ")
      math(EXPR left_out "${ssse3} | ${sse4}")
    endif()
  endif()
  set(instruction_sets HWY_DISABLED_TARGETS=${left_out})
endif()
