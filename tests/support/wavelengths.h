#pragma once

namespace holotrace {

inline constexpr double green = 532e-9;  ///< [m]

}  // namespace holotrace
