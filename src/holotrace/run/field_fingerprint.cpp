#include "holotrace/run/field_fingerprint.h"

#include <string>
#include <type_traits>

namespace holotrace {
namespace {

class Fingerprint {
 public:
  void add(const void* bytes, size_t size) {
    for (size_t i = 0; i < size; ++i) value_ = (value_ ^ static_cast<const unsigned char*>(bytes)[i]) * 1099511628211u;
  }
  template <class Value>
  void add(const Value& value) {
    static_assert(std::has_unique_object_representations_v<Value> || std::is_floating_point_v<Value>);
    add(&value, sizeof value);
  }
  void add_text(const std::string& text) { add(text.data(), text.size() + 1); }
  uint64_t value() const { return value_; }

 private:
  uint64_t value_ = 14695981039346656037u;
};

}  // namespace

uint64_t field_fingerprint(const Grid& panel, const SynthesizeParams& params, const std::vector<const Sources*>& sets,
                           const std::vector<int>& first_rows) {
  Fingerprint f;
  f.add_text(HOLOTRACE_VERSION);
  f.add(panel.nx);
  f.add(panel.ny);
  f.add(panel.pitch);
  f.add(panel.centre_x);
  f.add(panel.centre_y);
  f.add(int(params.method));
  f.add(params.tolerance);
  for (const int row : first_rows) f.add(row);
  for (const Sources* set : sets) {
    f.add_text(set->name);
    f.add(set->frame);
    f.add(set->wavelength);
    f.add(set->cone_wavelength);
    f.add(set->waves.data(), set->waves.size() * sizeof(Source));
    f.add(set->tiles.columns);
    f.add(set->tiles.rows);
    f.add(set->tiles.values.data(), set->tiles.values.size() * sizeof(float));
  }
  return f.value();
}

}  // namespace holotrace
