# Everything the library stands on; the installed package config includes this file again.
# scripts/setup installs the Debian packages.
include(CMakeFindDependencyMacro)
find_dependency(Threads)
find_dependency(fmt)
find_dependency(TBB)
find_dependency(hwy)
find_dependency(Eigen3)
find_dependency(embree 3)
# Pictures: each format by the small library made for it.
find_dependency(PNG)
find_dependency(JPEG)
find_dependency(GIF)
find_dependency(WebP)
find_dependency(OpenEXR)
find_dependency(assimp)
find_dependency(tomlplusplus)
find_dependency(nlohmann_json)
find_dependency(Random123)
