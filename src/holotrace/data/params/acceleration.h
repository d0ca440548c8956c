#pragma once

namespace holotrace {

/// Structure that finds the surface on a ray: Embree's trees, or the uniform subdivision of the paper's appendix.
enum class Acceleration { embree, grid };

}  // namespace holotrace
