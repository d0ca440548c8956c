#pragma once

#include <map>

#include "holotrace/base/fft.h"
#include "holotrace/opencl/device.h"

namespace holotrace {

/// Complex factors for lines of samples, on a device. Those of line i begin at |start + i·step|·stride + offset, or are
/// the same for all lines (step 0).
struct LineFactors {
  const DeviceBuffer* values = nullptr;  ///< none: no factors
  int start = 0, step = 0, stride = 0, offset = 0;
  bool is_conjugate = false;  ///< whether the samples are multiplied by the conjugates
};

/// What enters or leaves a line's transform: samples n = 0 … count − 1, at the places n + shift of its period.
struct LineEnd {
  int count = 0;
  int shift = 0;
  LineFactors factors{};  ///< the samples are multiplied by these
};

/// A transform of lines that lie one after the other: samples times factors, added up by their places; a transform; the
/// filter, times a ramp if there is one, and the transform back, if there is a filter; the samples that leave, times
/// factors. Neither transform scales.
struct LineTransform {
  int length = 0;
  FftDirection direction = FftDirection::forward;  ///< of the first transform
  LineEnd in, out;
  LineFactors filter{};
  bool adds = false;   ///< to the samples in place
  LineFactors ramp{};  ///< factors of the filter that are the same for all lines, such as those that displace samples
};

/// Where a matrix lies in a larger one: samples from one row to the next, and the place of the first one.
struct MatrixPlace {
  int stride = 0;  ///< 0: the matrix is a whole one
  int offset = 0;
};

/// Transforms on a device, in single precision. Lines of up to 4096 samples (as far as the device's local memory allows)
/// with the factors 2, 3 and 5 are read and written once. All others take a pass through memory for each factor, whose
/// cost grows with the factor, and work space: up to 64 MB, and half of the device's free memory.
///
/// Cost of a transform of N samples: 4.4·N·log₂N additions and multiplications for a power of 8, up to 7·N·log₂N for a
/// power of 5, with the twiddle factors; a factor p of a long line, 9·p·N.
class LineTransforms {
 public:
  explicit LineTransforms(Device& device) : device_(device) {}

  void run(const LineTransform& transform, int lines, const DeviceBuffer& from, const DeviceBuffer& to);
  /// to[column][row] = from[row][column], for matrices that lie one after the other
  void transpose(int rows, int columns, const DeviceBuffer& from, const DeviceBuffer& to, int matrices = 1);
  /// The same for one matrix that is a part of another, before or after it.
  void transpose(int rows, int columns, const DeviceBuffer& from, const MatrixPlace& source, const DeviceBuffer& to,
                 const MatrixPlace& target);

 private:
  const DeviceBuffer& twiddles(int length);
  Device& device_;
  std::map<int, DeviceBuffer> twiddles_;
};

/// Whether a device's local memory holds a line, so that it is read and written once.
bool is_held_line(const Device& device, int length);

}  // namespace holotrace
