#include "holotrace/slm/encode/shown_pixels.h"

#include <algorithm>
#include <utility>

namespace holotrace {
namespace {

int part_of(int count, int parts) { return (count + parts - 1) / parts; }

}  // namespace

DeviceSamples DeviceSamples::whole(std::shared_ptr<const DeviceField> field) {
  return {.device = field->device, .head = field->head, .there = field};
}

DeviceSamples DeviceSamples::in_parts(Device& device, std::shared_ptr<const Field> field, int parts) {
  return {.device = &device, .head = head_of(*field), .parts = parts, .here = field};
}

int DeviceSamples::rows_at_once() const {
  const int ny = head.grid.ny, rows = part_of(ny, parts);
  return std::min(rows + rows % 2, ny);
}

int DeviceSamples::columns_at_once(int columns) const { return std::max(1, part_of(columns, parts)); }

void each_band(const DeviceSamples& field, const std::function<void(const DeviceField& band, int first)>& work) {
  const auto lock = field.device->lock();
  if (field.there) return work(*field.there, 0);
  const int ny = field.head.grid.ny, most = field.rows_at_once();
  for (int first = 0; first < ny; first += most) {
    Field head = field.head;
    head.grid.ny = std::min(most, ny - first);
    const DeviceField band = make_device_field(*field.device, std::move(head), "rows of a field");
    field.device->write(band.samples, field.here ? field.here->samples.row(first) : nullptr, band.samples.bytes());
    if (field.top) clip_moduli(band, *field.top);
    work(band, first);
  }
}

}  // namespace holotrace
