# HDF5: sets hdf5_libraries for the library, and HOLOTRACE_HDF5_LIBRARIES for other targets.

# FindHDF5 wants the language C, which a consumer need not have: the exported target names the library itself.
find_package(HDF5 REQUIRED COMPONENTS C)
set(hdf5_libraries ${HDF5_C_LIBRARIES})

# Debian's shared HDF5 loads 30 libraries for files on the network, which nothing here reads, into every process, some of them
# under the LGPL. The static one leaves them out. Programs take it as it is. A module can take it (property HDF5_IS_MOVABLE) if
# HDF5's own symbols stay inside, and if it finds stdout and stderr, which its code cannot reach from a module, under other
# names: see python/CMakeLists.txt and python/core/hdf5_streams.cpp. All other targets take the shared one.
list(GET HDF5_C_LIBRARIES 0 hdf5_shared)
get_filename_component(hdf5_folder ${hdf5_shared} DIRECTORY)
find_library(HOLOTRACE_HDF5_STATIC libhdf5.a HINTS ${hdf5_folder} ${hdf5_folder}/hdf5/serial NO_DEFAULT_PATH)
find_library(HOLOTRACE_SZIP sz)
find_package(ZLIB)
if(HOLOTRACE_HDF5_STATIC AND HOLOTRACE_SZIP AND ZLIB_FOUND AND CMAKE_OBJCOPY)
  set(hdf5_movable ${CMAKE_CURRENT_BINARY_DIR}/libhdf5_movable.a)
  add_custom_command(OUTPUT ${hdf5_movable} DEPENDS ${HOLOTRACE_HDF5_STATIC} VERBATIM
    COMMAND ${CMAKE_OBJCOPY} --redefine-sym stdout=holotrace_hdf5_stdout --redefine-sym stderr=holotrace_hdf5_stderr
            ${HOLOTRACE_HDF5_STATIC} ${hdf5_movable})
  add_custom_target(hdf5_movable DEPENDS ${hdf5_movable})
  set(is_program $<STREQUAL:$<TARGET_PROPERTY:TYPE>,EXECUTABLE>)
  set(is_module $<BOOL:$<TARGET_PROPERTY:HDF5_IS_MOVABLE>>)
  set(hdf5_beside ${HOLOTRACE_SZIP} ${ZLIB_LIBRARIES} ${CMAKE_DL_LIBS} m)
  list(TRANSFORM hdf5_libraries REPLACE "(.+)" "$<$<NOT:$<OR:${is_program},${is_module}>>:\\1>")
  list(TRANSFORM hdf5_beside REPLACE "(.+)" "$<$<OR:${is_program},${is_module}>:\\1>")
  list(APPEND hdf5_libraries $<${is_program}:${HOLOTRACE_HDF5_STATIC}> $<${is_module}:${hdf5_movable}> ${hdf5_beside})
endif()
set(HOLOTRACE_HDF5_LIBRARIES ${hdf5_libraries} CACHE INTERNAL "HDF5 for programs and for other targets")
