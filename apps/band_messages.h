#pragma once

#include <cstring>
#include <string>
#include <type_traits>
#include <vector>

#include "holotrace/base/error.h"
#include "holotrace/data/sources.h"
#include "holotrace/wave/bands.h"
#include "plan_rates.h"

// Messages that ranks exchange about a field made in bands.

namespace holotrace {

/// Rank 0 sends a job, its sets, single bands, and the end. The other ranks ask for a band, send its rows in pieces,
/// and report that it is finished or has failed.
enum BandTag { tag_job, tag_set, tag_band, tag_end, tag_ready, tag_rows, tag_finished, tag_failed };

/// Header of a message of rows: the rows of band `band`, from row `first_row` of the panel on.
struct RowsHead {
  uint64_t band = 0;
  int32_t first_row = 0, rows = 0;
};

struct JobHead {
  Grid panel;
  SynthesisMethod method{};
  double tolerance = 0;
  DeviceChoice device{};
  int32_t threads = 0, sets = 0;
  PlanRates rates;  ///< plans are chosen by these rates: the same on every rank
};

struct BandOrder {
  uint64_t index = 0;
  Band band;
};

template <class Value>
void pack(std::string& bytes, const Value& value) {
  static_assert(std::is_trivially_copyable_v<Value>);
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

template <class Value>
void pack(std::string& bytes, const std::vector<Value>& values) {
  static_assert(std::is_trivially_copyable_v<Value>);
  pack(bytes, uint64_t(values.size()));
  bytes.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(Value));
}

/// Reads what `pack` wrote, in the same order.
class Unpacker {
 public:
  explicit Unpacker(const std::string& bytes) : bytes_(bytes) {}

  template <class Value>
  void get(Value& value) {
    take(&value, sizeof value);
  }
  template <class Value>
  void get(std::vector<Value>& values) {
    uint64_t count = 0;
    get(count);
    values.resize(count);
    take(values.data(), count * sizeof(Value));
  }

 private:
  void take(void* to, size_t size) {
    require(size <= bytes_.size() - at_, "expected a longer message from another rank, got {} bytes", bytes_.size());
    if (size > 0) std::memcpy(to, bytes_.data() + at_, size);
    at_ += size;
  }

  const std::string& bytes_;
  size_t at_ = 0;
};

inline std::string pack_set(const Sources& set) {
  std::string bytes;
  pack(bytes, set.wavelength);
  pack(bytes, set.cone_wavelength);
  pack(bytes, set.tiles.columns);
  pack(bytes, set.tiles.rows);
  pack(bytes, set.waves);
  pack(bytes, set.tiles.values);
  return bytes;
}

inline Sources unpack_set(const std::string& bytes) {
  Sources set;
  Unpacker unpacker(bytes);
  unpacker.get(set.wavelength);
  unpacker.get(set.cone_wavelength);
  unpacker.get(set.tiles.columns);
  unpacker.get(set.tiles.rows);
  unpacker.get(set.waves);
  unpacker.get(set.tiles.values);
  return set;
}

}  // namespace holotrace
