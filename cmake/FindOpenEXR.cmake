# EXR: target OpenEXR::OpenEXR. Debian's config of Imath names libraries for Python that libopenexr-dev does not install,
# so the libraries are found by hand.
find_path(OpenEXR_INCLUDE_DIR OpenEXR/ImfHeader.h)
find_path(OpenEXR_Imath_INCLUDE_DIR ImathBox.h PATH_SUFFIXES Imath)
set(OpenEXR_variables OpenEXR_INCLUDE_DIR OpenEXR_Imath_INCLUDE_DIR)
set(OpenEXR_libraries)
foreach(library OpenEXR Iex IlmThread)
  find_library(OpenEXR_${library}_LIBRARY ${library})
  list(APPEND OpenEXR_variables OpenEXR_${library}_LIBRARY)
  list(APPEND OpenEXR_libraries ${OpenEXR_${library}_LIBRARY})
endforeach()
include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(OpenEXR REQUIRED_VARS ${OpenEXR_variables})
mark_as_advanced(${OpenEXR_variables})
if(OpenEXR_FOUND AND NOT TARGET OpenEXR::OpenEXR)
  add_library(OpenEXR::OpenEXR INTERFACE IMPORTED)
  set_target_properties(OpenEXR::OpenEXR PROPERTIES
    INTERFACE_LINK_LIBRARIES "${OpenEXR_libraries}"
    INTERFACE_INCLUDE_DIRECTORIES "${OpenEXR_INCLUDE_DIR};${OpenEXR_INCLUDE_DIR}/OpenEXR;${OpenEXR_Imath_INCLUDE_DIR}")
endif()
