# Images and EXR: target OpenImageIO::OpenImageIO. Debian's own package config names the include
# folder of OpenCV, which libopenimageio-dev does not install, so the library is found by hand.
find_path(OpenImageIO_INCLUDE_DIR OpenImageIO/imageio.h)
find_path(OpenImageIO_Imath_INCLUDE_DIR ImathVec.h PATH_SUFFIXES Imath)
find_library(OpenImageIO_LIBRARY OpenImageIO)
find_library(OpenImageIO_Util_LIBRARY OpenImageIO_Util)
include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(OpenImageIO REQUIRED_VARS OpenImageIO_LIBRARY OpenImageIO_Util_LIBRARY
                                  OpenImageIO_INCLUDE_DIR OpenImageIO_Imath_INCLUDE_DIR)
mark_as_advanced(OpenImageIO_INCLUDE_DIR OpenImageIO_Imath_INCLUDE_DIR OpenImageIO_LIBRARY OpenImageIO_Util_LIBRARY)
if(OpenImageIO_FOUND AND NOT TARGET OpenImageIO::OpenImageIO)
  add_library(OpenImageIO::OpenImageIO UNKNOWN IMPORTED)
  set_target_properties(OpenImageIO::OpenImageIO PROPERTIES
    IMPORTED_LOCATION ${OpenImageIO_LIBRARY}
    INTERFACE_LINK_LIBRARIES ${OpenImageIO_Util_LIBRARY}
    INTERFACE_INCLUDE_DIRECTORIES "${OpenImageIO_INCLUDE_DIR};${OpenImageIO_Imath_INCLUDE_DIR}")
endif()
