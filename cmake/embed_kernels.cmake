# embed_kernels(SOURCE FILE…): SOURCE may include the text of each file as a string, "kernels/NAME.inc":
#   constexpr const char* text =
#   #include "kernels/tile_sum.cl.inc"
#       ;
# Several sources may share a file.
function(embed_kernels source)
  set(folder ${CMAKE_CURRENT_BINARY_DIR}/embedded)
  foreach(file ${ARGN})
    get_filename_component(name ${file} NAME)
    get_filename_component(path ${file} ABSOLUTE)
    get_property(known DIRECTORY PROPERTY HOLOTRACE_EMBEDDED_${name})
    if(known AND NOT known STREQUAL path)
      message(FATAL_ERROR "expected kernel files of different names, got ${known} and ${path}; rename one of them")
    endif()
    if(NOT known)
      file(READ ${file} text)
      string(REPLACE "#pragma once\n" "" text "${text}")  # of headers, which compilers warn of in the main text
      file(GENERATE OUTPUT ${folder}/kernels/${name}.inc CONTENT "R\"kernel(${text})kernel\"\n")
      set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${path})
      set_property(DIRECTORY PROPERTY HOLOTRACE_EMBEDDED_${name} ${path})
    endif()
  endforeach()
  set_property(SOURCE ${source} APPEND PROPERTY INCLUDE_DIRECTORIES ${folder})
endfunction()
