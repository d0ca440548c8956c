#pragma once

#include <functional>
#include <string>

#include "holotrace/data/device_rates.h"
#include "holotrace/data/summation_rates.h"

namespace holotrace {

/// The rates of this machine, measured once and kept in the user's cache folder (io/files/cache_folder.h) as
/// summation_rates.json: an object with the rates of each machine that shares the folder, by `key`.
///
/// If the file is damaged or has nothing under the key, `calibrate` is called and its rates are saved.
/// Programs that start at the same time wait some seconds for the one that measures. If nothing can be saved, nothing is measured
/// and the default rates are returned: they are the same on every run, as the choice of a method requires.
///
/// @param key        machine that the rates are valid for: processor, instruction set, version of the program
/// @param calibrate  measures the rates
/// @param warn       gets a sentence if another program does not give the file's lock back
SummationRates keep_summation_rates(const std::string& key, const std::function<SummationRates()>& calibrate,
                                    const std::function<void(const std::string& sentence)>& warn);

/// The same for OpenCL devices, in device_rates.json. A device that fails while it is measured has rates of 0.
DeviceRates keep_device_rates(const std::string& key, const std::function<DeviceRates()>& calibrate,
                              const std::function<void(const std::string& sentence)>& warn);

}  // namespace holotrace
