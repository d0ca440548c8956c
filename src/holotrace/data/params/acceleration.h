#pragma once

namespace holotrace {

/// What finds the surface that a ray meets: Embree's trees, or the uniform subdivision of the paper's appendix.
enum class Acceleration { embree, grid };

}  // namespace holotrace
