# Everything the library stands on; the installed package config includes this file again.
# scripts/setup installs the Debian packages.
include(CMakeFindDependencyMacro)
find_dependency(Threads)
find_dependency(fmt)
find_dependency(TBB)
find_dependency(hwy)
find_dependency(embree 3)
find_dependency(OpenImageIO)
find_dependency(assimp)
find_dependency(tomlplusplus)
find_dependency(nlohmann_json)
find_dependency(FFTW3)
find_dependency(Random123)
