#pragma once

#include <functional>
#include <optional>
#include <variant>

#include "holotrace/base/array.h"
#include "holotrace/base/observer.h"
#include "holotrace/data/field.h"
#include "holotrace/data/params/device.h"
#include "holotrace/opencl/device.h"
#include "holotrace/slm/panel/device_panel.h"
#include "holotrace/slm/panel/panel_model.h"
#include "holotrace/wave/shared/device_field.h"

namespace holotrace {

/// A pattern on the panel, as PanelModel::leave takes it.
struct PanelPattern {
  const Array2D<float>& drive;
  const Array2D<float>* modulus = nullptr;
};

/// The field that leaves a panel (PanelModel::leave), on the device that `choice` names, in single precision (DevicePanel).
///
/// The device `auto` is the one that is expected to be the fastest, by the rates of stage_on_device.h: the transforms of the
/// panel count, and the transfers of levels and field, for each band. If it fails, a warning says why.
///
/// A panel that does not fit in the device's memory is done in bands (BandedPanel); the field is the same.
///
/// Fact: `device`, its name. Transfers: 4 bytes per pixel (8 for a complex modulation), and the panel's effects, once for each band
/// of columns; 8 bytes per sample come back.
/// @return        nothing if the processor should do it
/// @throws Error  for a device that is not there, and as PanelModel::leave and Device do
std::optional<Field> panel_field_by_device(const PanelModel& panel, const PanelPattern& pattern,
                                           const DeviceChoice& choice, const Observer& observer = {});

/// A field that left a panel, on the device that has computed it or, if it does not fit there, on the processor; and its
/// power [W].
struct PanelField {
  std::variant<DeviceField, Field> field;
  double power = 0;
};

/// The same, but the field stays on the device if that has memory for it.
std::optional<PanelField> panel_field_on_device(const PanelModel& panel, const PanelPattern& pattern,
                                                const DeviceChoice& choice, const Observer& observer = {});

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
