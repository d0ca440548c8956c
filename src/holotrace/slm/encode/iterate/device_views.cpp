#include <algorithm>
#include <complex>
#include <cstdint>
#include <utility>

#include "holotrace/slm/encode/iterate/frames_light.h"
#include "holotrace/slm/encode/iterate/target_propagation.h"

namespace holotrace {
namespace {

constexpr const char* source =
#include "kernels/views.cl.inc"
    ;

constexpr int group = 64;

Kernel kernel(const char* name) { return {name, {source}}; }
WorkSize over(int columns, int rows) { return {size_t(columns + group - 1) / group, size_t(rows), group, 1}; }

}  // namespace

// As views.cl declares it.
struct DeviceView::Job {
  int32_t length, first_x, first_y, columns;
  float scale;
};

DeviceView::DeviceView(ViewTransforms& transforms, const Grid& eye, const ViewTargets& views, size_t view)
    : target_(transforms.device, views.amplitudes[view], {}), columns_(eye.nx) {
  Device& device = transforms.device;
  const PupilWindow window = pupil_window(eye, views.wavelength, views.pupils[view], views.z);
  length_ = window.length;
  first_x_ = window.first_x;
  first_y_ = window.first_y;
  scale_ = window.scale;
  along_x_ = device.upload(window.along_x, "a view");
  along_y_ = device.upload(window.along_y, "a view");
  spans_ = device.upload(window.spans, "a view");
  const size_t bytes = size_t(length_) * size_t(length_) * sizeof(std::complex<float>);
  for (DeviceBuffer& buffer : transforms.work) {
    if (buffer.bytes() >= bytes) continue;
    buffer = {};
    buffer = device.make_buffer(bytes, "a view");
  }
}

DeviceView::Job DeviceView::job() const { return {length_, first_x_, first_y_, columns_, scale_}; }

// Of work[0], whose result is there, too: rows become columns.
void DeviceView::transform(ViewTransforms& transforms, FftDirection direction) const {
  const LineTransform line{length_, direction, {length_}, {length_}};
  auto& [first, second] = transforms.work;
  transforms.lines.run(line, length_, first, second);
  transforms.lines.transpose(length_, length_, second, first);
  transforms.lines.run(line, length_, first, second);
  std::swap(first, second);
}

void DeviceView::take(ViewTransforms& transforms, const DeviceBuffer& eye, const DeviceBuffer& picture) const {
  Device& device = transforms.device;
  device.run(kernel("enter_pupil"), over(length_, length_),
             {job(), spans_, along_x_, along_y_, eye, transforms.work[0]});
  transform(transforms, FftDirection::backward);
  device.run(kernel("take_picture"), over(target_.nx, target_.ny),
             {int32_t(length_), int32_t(target_.nx), int32_t(target_.ny), transforms.work[0], picture});
}

void DeviceView::add_adjoint(ViewTransforms& transforms, const DeviceBuffer& picture, const DeviceBuffer& factor,
                             const DeviceBuffer& eye) const {
  Device& device = transforms.device;
  device.run(kernel("put_picture"), over(length_, length_),
             {int32_t(length_), int32_t(target_.nx), int32_t(target_.ny), picture, factor, transforms.work[0]});
  transform(transforms, FftDirection::forward);
  device.run(kernel("leave_pupil"), over(length_, length_),
             {job(), spans_, along_x_, along_y_, transforms.work[0], eye});
}

}  // namespace holotrace
