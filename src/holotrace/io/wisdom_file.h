#pragma once

#include <functional>
#include <string>

namespace holotrace {

/// Keeps FFTW's knowledge of fast plans between runs, in the user's cache folder ($XDG_CACHE_HOME or
/// ~/.cache)/holotrace/fftw_wisdom, and shares it, with a lock, with programs that run at the same time. If
/// the folder cannot be written, it does nothing: plans are then estimated (base/fft.h).
/// @param warn  gets a sentence if another program does not give the lock back: plans are estimated from there on
void keep_fft_wisdom(const std::function<void(const std::string& sentence)>& warn);

}  // namespace holotrace
