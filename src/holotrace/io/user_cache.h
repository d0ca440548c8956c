#pragma once

#include <functional>
#include <optional>
#include <string>

#include "holotrace/data/rates.h"

namespace holotrace {

/// The rates of this machine, measured once and kept in the user's cache folder (io/files/folders.h) as
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

// What drivers of OpenCL compiled (opencl/device.h), in the folder opencl/ of the user's cache. Without a cache
// folder nothing is kept.

/// The program that was kept for that key; none if there is none, its file is damaged, or another user could have
/// written it.
std::optional<std::string> load_kept_program(const std::string& key);

void keep_program(const std::string& key, const std::string& binary);

/// Keeps the messages of a compiler that refused a kernel, in place of earlier ones.
/// @return  the path of their file; "" if they could not be written
std::string keep_compiler_log(const std::string& log);

}  // namespace holotrace
