#include "holotrace/data/target.h"

#include <algorithm>

namespace holotrace {

std::vector<double> wavelengths_of(const TargetSet& targets) {
  std::vector<double> wavelengths;
  const auto add = [&](double wavelength) {
    if (std::find(wavelengths.begin(), wavelengths.end(), wavelength) == wavelengths.end())
      wavelengths.push_back(wavelength);
  };
  for (const TargetPlane& plane : targets.planes) add(plane.wavelength);
  for (const ViewTargets& views : targets.views) add(views.wavelength);
  return wavelengths;
}

}  // namespace holotrace
