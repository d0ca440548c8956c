#pragma once

namespace holotrace {

/// Keeps FFTW's knowledge of fast plans between runs, in the user's cache folder ($XDG_CACHE_HOME or
/// ~/.cache)/holotrace/fftw_wisdom, and shares it, with a lock, with programs that run at the same time. If
/// the folder cannot be written, it does nothing: plans are then estimated (base/fft.h).
void keep_fft_wisdom();

}  // namespace holotrace
