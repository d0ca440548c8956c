#pragma once

#include <nlohmann/json_fwd.hpp>

#include "holotrace/calibrate/fit_panel.h"

namespace holotrace {

/// What a fit found, by name: values with their standard errors, in the units of the names.
nlohmann::ordered_json fit_json(const PanelFit& fit);

}  // namespace holotrace
