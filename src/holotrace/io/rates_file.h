#pragma once

#include <functional>
#include <string>

#include "holotrace/data/summation_rates.h"

namespace holotrace {

/// The rates of this machine, measured once and kept in the user's cache folder (io/files/cache_folder.h) as
/// summation_rates.json: an object that has, by `key`, the rates of each machine that shares the folder.
///
/// A file that is damaged or has nothing under the key is mended: `calibrate` is called and its rates are kept.
/// Programs that start at the same time wait for the one that measures. Where nothing can be kept, the default rates
/// are returned and nothing is measured: the same on every run, as the choice of a method has to be.
///
/// @param key        what the rates hold for: the processor, its instruction set, the version of the program
/// @param calibrate  measures them
SummationRates keep_summation_rates(const std::string& key, const std::function<SummationRates()>& calibrate);

}  // namespace holotrace
