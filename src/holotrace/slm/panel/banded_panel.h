#pragma once

#include <functional>

#include "holotrace/opencl/device.h"
#include "holotrace/slm/panel/device_panel.h"
#include "holotrace/slm/panel/panel_model.h"

namespace holotrace {

/// How the light that leaves a panel is cut to fit in some memory of a device: rows of pixels and columns of samples that are
/// there at once.
struct PanelBands {
  int rows = 0, columns = 0;            ///< 0: not a single row and column fit
  int row_bands = 0, column_bands = 0;  ///< their numbers

  bool is_whole() const { return row_bands == 1 && column_bands == 1; }
};

/// The light that leaves a panel on an OpenCL device (DevicePanel), in bands if all of it does not fit in the device's memory.
///
/// The transforms along the rows are done for one band of rows of pixels after the other, each with the rows beside it that
/// crosstalk reaches. Of their results the device keeps one band of columns, and does the transforms along these. Levels and the
/// panel's effects are thus sent once for each band of columns, and the transforms along the rows are done again, but nothing in
/// between leaves the device. Samples are the same, however the panel is cut.
class BandedPanel {
 public:
  /// @param memory   free memory of the device [bytes]
  /// @param largest  its largest buffer [bytes]
  static PanelBands plan(const PanelModel& model, double memory, double largest);

  /// @param model   must outlive this object
  /// @throws Error  as Device does
  BandedPanel(Device& device, const PanelModel& model);

  /// Calls take(columns, u) with the light of one band of columns after the other, shape (n·ny, columns); it may take the buffer.
  /// @throws Error  if not a single row and column fit in the device's memory, and as Device does
  void leave(const PanelModel::Pattern& pattern,
             const std::function<void(const SampleColumns& columns, DeviceBuffer& u)>& take);

 private:
  struct Memory;
  struct Job;
  Memory make_memory(const PanelBands& bands);
  void leave_rows(const Job& job, const PixelRows& rows, const SampleColumns& columns, const Memory& memory);

  Device& device_;
  const PanelModel& model_;
  DevicePanel panel_;
};

}  // namespace holotrace
