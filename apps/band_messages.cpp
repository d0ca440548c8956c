#include "band_messages.h"

#include "holotrace/opencl/device.h"
#include "holotrace/wave/shared/cost_model.h"
#include "holotrace/wave/shared/stage_on_device.h"

namespace holotrace {
namespace {

// Calls visit(name, rate). The processor and a device have rates of the same name.
template <class Rates, class Visit>
void for_each_rate(Rates& rates, const Visit& visit) {
  for (const SummationTerm& term : summation_terms) visit(std::string(term.name), rates.processor.*term.rate);
  for (const DeviceRateTerm& term : device_rate_terms)
    visit(std::string("device_") + term.name, rates.device.*term.rate);
}

}  // namespace

PlanRates plan_rates(const DeviceChoice& device) {
  PlanRates rates{summation_rates(), {}};
  if (device.kind == DeviceKind::opencl) rates.device = device_rates(open_device(device.number));
  if (device.kind == DeviceKind::all) rates.device = device_rates(open_device(0));
  return rates;
}

void go_by(const PlanRates& rates) {
  set_summation_rates([rates] { return rates.processor; });
  set_device_rates([rates](Device&) { return rates.device; });
}

std::map<std::string, double> named_rates(const PlanRates& rates) {
  std::map<std::string, double> named;
  for_each_rate(rates, [&](const std::string& name, double rate) { named[name] = rate; });
  return named;
}

PlanRates rates_of(const std::map<std::string, double>& named, PlanRates otherwise) {
  for_each_rate(otherwise, [&](const std::string& name, double& rate) {
    if (const auto found = named.find(name); found != named.end()) rate = found->second;
  });
  return otherwise;
}

}  // namespace holotrace
