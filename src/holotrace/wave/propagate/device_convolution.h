#pragma once

#include <vector>

#include "holotrace/base/observer.h"
#include "holotrace/base/vec.h"
#include "holotrace/opencl/device.h"
#include "holotrace/wave/propagate/propagator.h"
#include "holotrace/wave/transform/line_transform.h"

namespace holotrace {

/// Samples of a window on a device, and the displacement of that window: its place in the list of a DeviceConvolution.
struct DisplacedSamples {
  size_t shift;
  const DeviceBuffer* samples;
};

/// Neighbouring frequencies of a part of the spectrum along x: columns [first, first + count) of the part.
struct ColumnBand {
  size_t part = 0;
  int first = 0, count = 0;
};

/// Where the transfer function of a propagation is: it stays on the device; or it is sent band by band of columns.
enum class TransferFunction { on_device, in_bands };

/// A propagation between windows of one pitch on an OpenCL device, with the sums of convolve.h, its adjoint, and windows
/// that are displaced by parts of a sample (ConvolutionLink). The transfer function and all other factors are sent once.
///
/// The first transform of a column, the transfer function and the second transform are one kernel: it reads and writes
/// the column once for each part of the spectrum. In between the spectrum is transposed.
class DeviceConvolution {
 public:
  /// @param propagator  a propagation on a lattice
  /// @param shifts      displacements of the output window, right and down [samples]
  /// @throws Error      as Device does
  DeviceConvolution(Device& device, const Propagator<float>& propagator, const std::vector<Vec2>& shifts = {{0, 0}},
                    TransferFunction transfer = TransferFunction::on_device);

  /// The steps of a propagation, for some rows or for a band of columns. Rows to the spectrum:
  void enter(const ColumnBand& band, int rows, const DeviceBuffer& from, const DeviceBuffer& to);
  /// Columns of the input to columns of the output. @param transfer  of the band's columns, for all frequencies of y
  void filter(const ColumnBand& band, const LineFactors& transfer, const DeviceBuffer& from, const DeviceBuffer& to,
              size_t shift = 0);
  /// The spectrum's share of rows of the output. @param adds  to the samples in place
  void leave(const ColumnBand& band, int rows, bool adds, const DeviceBuffer& from, const DeviceBuffer& to,
             size_t shift = 0);

  /// The rows of the propagator's transfer function that belong to the band's columns, in their order.
  std::vector<int> transfer_rows(const ColumnBand& band) const;

  /// Memory of a propagation: the spectrum row by row, and column by column before and after the transfer function.
  /// Propagations of the same windows may use it one after the other, and those of smaller ones.
  struct Work {
    DeviceBuffer rows, columns, filtered;
  };
  Work make_work() const;
  /// Makes the memory of other propagations large enough for these, too.
  void grow(Work& work) const;

  /// The light of `from` at displaced output windows: transforms of 1 + n fields. It returns before the device has ended.
  void to_many(const DeviceBuffer& from, const std::vector<DisplacedSamples>& to, const Work& work,
               const Observer& observer = {});

  /// The adjoint: the sum of what comes back to the input window from displaced output windows, in n + 1 transforms.
  /// It needs no table of its own: Tᴴ has the factors of T, conjugate, in the opposite order.
  void to_sum(const std::vector<DisplacedSamples>& from, const DeviceBuffer& to, const Work& work);

 private:
  struct Part {  // of an axis
    DeviceBuffer enter, leave;
    int columns = 0, shift = 0, first = 0;  // frequencies in use, place of the first one, and its number
    std::vector<DeviceBuffer> ramps;        // of x, which displace samples; empty buffers: by 0
  };
  Part make_part(const PropagationAxis& axis, int part, double scale) const;
  void make_ramps(const std::vector<Vec2>& shifts);
  LineFactors transfer_of(const ColumnBand& band) const;
  LineFactors ramp_y(size_t shift, size_t part_of_y) const;

  Device& device_;
  PropagationAxis along_x_, along_y_;
  LineTransforms lines_;
  DeviceBuffer transfer_;
  int transfer_columns_;
  std::vector<Part> x_, y_;
  std::vector<DeviceBuffer> ramps_y_;
};

/// The steps of a propagation to a window of another pitch on an OpenCL device: those of DeviceConvolution, by the sums of
/// window_transform.h. All factors but the transfer function are sent once. Its spectrum has one part.
class DeviceWindows {
 public:
  /// @param plan    a propagation off the lattice
  /// @throws Error  as Device does
  DeviceWindows(Device& device, const Propagator<float>& plan);

  void enter(const ColumnBand& band, int rows, const DeviceBuffer& from, const DeviceBuffer& to);
  /// @param bins  the columns' frequencies along y
  void filter(const ColumnBand& band, const LineFactors& transfer, const DeviceBuffer& from, const DeviceBuffer& bins,
              const DeviceBuffer& to);
  void leave(const ColumnBand& band, int rows, bool adds, const DeviceBuffer& from, const DeviceBuffer& to);

  void transpose(int rows, int columns, const DeviceBuffer& from, const DeviceBuffer& to) {
    lines_.transpose(rows, columns, from, to);
  }

 private:
  struct Window {
    DeviceBuffer enter, chirp, leave;
    int length = 0;
    bool is_plain = false;
  };
  Window make_window(const PropagationAxis& axis);
  // Samples `first` … of the axis' frequencies, summed at the window.
  void sum(const Window& window, const PropagationAxis& axis, const ColumnBand& frequencies, int lines, bool adds,
           const DeviceBuffer& from, const DeviceBuffer& to);

  Device& device_;
  PropagationAxis x_, y_;
  LineTransforms lines_;
  Window to_x_, to_y_;
};

}  // namespace holotrace
