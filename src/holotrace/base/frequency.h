#pragma once

namespace holotrace {

/// The signed frequency of bin k of a transform of n samples, in cycles per n samples: 0, 1, …, −2, −1,
/// as fftfreq orders them. The middle bin of an even n is −n/2.
inline int signed_frequency(int k, int n) { return k < (n + 1) / 2 ? k : k - n; }

}  // namespace holotrace
