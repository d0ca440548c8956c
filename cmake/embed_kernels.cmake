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
    get_property(embedded DIRECTORY PROPERTY HOLOTRACE_EMBEDDED)
    if(NOT name IN_LIST embedded)
      file(READ ${file} text)
      string(REPLACE "#pragma once\n" "" text "${text}")  # of headers, which compilers warn of in the main text
      file(GENERATE OUTPUT ${folder}/kernels/${name}.inc CONTENT "R\"kernel(${text})kernel\"\n")
      set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${path})
      set_property(DIRECTORY APPEND PROPERTY HOLOTRACE_EMBEDDED ${name})
    endif()
  endforeach()
  set_property(SOURCE ${source} APPEND PROPERTY INCLUDE_DIRECTORIES ${folder})
endfunction()
