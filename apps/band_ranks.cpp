// The part of the ranks other than rank 0 in a field made in bands.

#include <tbb/global_control.h>

#include <algorithm>

#include "band_messages.h"
#include "banded_field.h"
#include "holotrace/opencl/device_info.h"
#include "holotrace/wave/bands.h"

namespace holotrace {
namespace {

// Sends the rows in pieces, so that the receiver needs little memory.
void send_rows(const Ranks& ranks, const BandOrder& order, const Field& field) {
  const int piece = std::max(1, int((4 << 20) / (sizeof(std::complex<float>) * size_t(field.grid.nx))));
  for (int row = 0; row < field.grid.ny; row += piece) {
    const int rows = std::min(piece, field.grid.ny - row);
    const std::complex<float>* from = field.samples.row(row);
    const std::vector<std::complex<float>> samples(from, from + size_t(rows) * size_t(field.grid.nx));
    ranks.send(0, tag_rows, to_message(RowsHead{order.index, order.band.first_row + row, rows}, samples));
  }
}

}  // namespace

void serve_bands(const Ranks& ranks, const Ranks::Message& job) {
  JobHead head;
  from_message(job.bytes, head);
  std::vector<Sources> sets(size_t(head.sets));
  for (Sources& set : sets) from_message(ranks.receive().bytes, set);
  const int threads = head.threads > 0 ? head.threads : ranks.threads();
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, size_t(threads));
  go_by(head.rates);
  SynthesizeParams params;
  params.method = head.method;
  params.tolerance = head.tolerance;
  params.device = head.device;
  if (params.device.kind == DeviceKind::opencl)
    params.device.number = equal_device(list_devices(), params.device.number, ranks.rank_here());
  ranks.send(0, tag_ready);
  for (Ranks::Message message = ranks.receive(); message.tag == tag_band; message = ranks.receive()) {
    BandOrder order;
    from_message(message.bytes, order);
    send_rows(ranks, order, synthesize_band(sets[size_t(order.band.set)], head.panel, order.band, params));
    ranks.send(0, tag_finished, to_message(order.index));
  }
}

}  // namespace holotrace
