#include "holotrace/view/device_camera.h"

#include <cstdint>

namespace holotrace {
namespace {

constexpr const char* camera_source =
#include "kernels/device_camera.cl.inc"
    ;

constexpr size_t camera_group = 64;

WorkSize over(int columns, int rows) {
  return {(size_t(columns) + camera_group - 1) / camera_group, size_t(rows), camera_group, 1};
}

}  // namespace

void cut_by_pupil(DeviceField& field, const std::vector<OpenColumns>& open) {
  Device& device = *field.device;
  const auto lock = device.lock();
  const Grid& grid = field.head.grid;
  const DeviceBuffer there = device.upload(open, "a pupil");
  device.run({"cut_by_pupil", {camera_source}}, over(grid.nx, grid.ny), {int32_t(grid.nx), there, field.samples});
}

Image mean_over_pixels(Device& device, const DeviceBuffer& values, int nx, const PixelSums& sums) {
  const auto lock = device.lock();
  const int32_t n = sums.n, first = sums.first, count = int32_t(sums.weights.size());
  std::vector<float> shares;
  for (const double weight : sums.weights) shares.push_back(float(weight / n));
  const DeviceBuffer weights = device.upload(shares, "a picture");
  const DeviceBuffer lines = device.make_buffer(size_t(sums.rows) * size_t(sums.across) * sizeof(float), "a picture");
  Image image(sums.rows, sums.columns, 1);
  const DeviceBuffer picture = device.make_buffer(image.values.size() * sizeof(float), "a picture");
  device.run({"add_rows", {camera_source}}, over(sums.across, sums.rows),
             {int32_t(nx), first, n, count, weights, int32_t(sums.across), values, lines});
  device.run({"add_columns", {camera_source}}, over(sums.columns, sums.rows),
             {int32_t(sums.across), n, count, weights, int32_t(sums.columns), lines, picture});
  device.read(picture, image.values.data(), picture.bytes());
  return image;
}

}  // namespace holotrace
