#pragma once

#include <map>
#include <string>

#include "holotrace/data/device_rates.h"
#include "holotrace/data/params/device.h"
#include "holotrace/data/summation_rates.h"

namespace holotrace {

/// The measured rates by which the plans of a field are chosen. The last bits of the field depend on the plans, so a
/// resumed run, and every rank, uses the rates of the run that began.
struct PlanRates {
  SummationRates processor;
  DeviceRates device;  ///< of the device that sums the field; 0 without one
};

/// The rates of this machine and of the chosen device, which is opened. Equal devices have those of the first one.
/// @throws Error  as open_device does
PlanRates plan_rates(const DeviceChoice& device);

/// Makes this program choose its plans by these rates.
void go_by(const PlanRates& rates);

/// Their names in a journal, and values.
std::map<std::string, double> named_rates(const PlanRates& rates);

/// The rates with those names. @param otherwise  rates for names that are missing, as in the journal of an older version
PlanRates rates_of(const std::map<std::string, double>& named, PlanRates otherwise);

}  // namespace holotrace
