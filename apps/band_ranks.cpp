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
    std::string bytes;
    pack(bytes, RowsHead{order.index, order.band.first_row + row, rows});
    const std::complex<float>* from = field.samples.row(row);
    pack(bytes, std::vector<std::complex<float>>(from, from + size_t(rows) * size_t(field.grid.nx)));
    ranks.send(0, tag_rows, bytes);
  }
}

}  // namespace

void serve_bands(const Ranks& ranks, const Ranks::Message& job) {
  JobHead head;
  Unpacker(job.bytes).get(head);
  std::vector<Sources> sets;
  while (int(sets.size()) < head.sets) sets.push_back(unpack_set(ranks.receive().bytes));
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
    Unpacker(message.bytes).get(order);
    send_rows(ranks, order, synthesize_band(sets[size_t(order.band.set)], head.panel, order.band, params));
    std::string done;
    pack(done, order.index);
    ranks.send(0, tag_finished, done);
  }
}

}  // namespace holotrace
