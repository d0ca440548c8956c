#include "holotrace/io/scene/measured_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <string_view>
#include <type_traits>
#include <vector>

#include "holotrace/base/error.h"
#include "holotrace/data/rgl_brdf.h"
#include "holotrace/io/files/file.h"

namespace holotrace {
namespace {

constexpr size_t largest_file = size_t(2) << 30;
constexpr std::string_view rgl_magic("tensor_file\0", 12);

MeasuredBrdf read_merl(const std::string& bytes, const std::string& path) {
  constexpr size_t header = 3 * sizeof(int32_t), whole = header + 3 * merl_cells * sizeof(double);
  std::array<int32_t, 3> sizes{};
  if (bytes.size() >= header) std::memcpy(sizes.data(), bytes.data(), header);
  require(sizes == std::array<int32_t, 3>{merl_theta_h, merl_theta_d, merl_phi_d},
          "{}: expected a table of the MERL or the RGL database of materials, got another file", path);
  require(bytes.size() == whole, "{}: expected {} bytes of a table of the MERL database, got {}; load it again", path,
          whole, bytes.size());
  constexpr std::array<double, 3> scales{1.0 / 1500, 1.15 / 1500, 1.66 / 1500};
  MeasuredField field{"merl", {3, merl_theta_h, merl_theta_d, merl_phi_d}, std::vector<float>(3 * merl_cells)};
  for (size_t i = 0; i < 3 * merl_cells; ++i) {
    double value = 0;
    std::memcpy(&value, bytes.data() + header + i * sizeof(double), sizeof(double));
    require(std::isfinite(value), "{}: expected finite values, got {} as number {}", path, value, i);
    field.values[i] = float(std::max(0.0, value * scales[i / merl_cells]));
  }
  MeasuredBrdf brdf{{std::move(field)}};
  choose_lobe(brdf);
  return brdf;
}

// Takes numbers and texts from the bytes of a file.
class Bytes {
 public:
  Bytes(const std::string& bytes, const std::string& path) : bytes_(bytes), path_(path) {}

  template <class Number>
  Number number() {
    Number value{};
    std::memcpy(&value, take(sizeof(Number)).data(), sizeof(Number));
    return value;
  }
  std::string_view take(size_t count) {
    const std::string_view taken = at(place_, count);
    place_ += count;
    return taken;
  }
  std::string_view at(size_t place, size_t count) const {
    require(place <= bytes_.size() && count <= bytes_.size() - place,
            "{}: expected more than {} bytes; the file is cut off", path_, bytes_.size());
    return std::string_view(bytes_).substr(place, count);
  }

 private:
  const std::string& bytes_;
  const std::string& path_;
  size_t place_ = 0;
};

MeasuredBrdf read_rgl(const std::string& content, const std::string& path) {
  Bytes bytes(content, path);
  bytes.take(rgl_magic.size());
  const auto major = bytes.number<uint8_t>(), minor = bytes.number<uint8_t>();
  require(major == 1 && minor == 0, "{}: expected version 1.0 of a file of the RGL database, got {}.{}", path, major,
          minor);
  constexpr std::array<std::string_view, 9> names{"phi_i", "theta_i", "wavelengths", "ndf", "sigma", "vndf",
                                                  "",      "",        "spectra"};
  MeasuredBrdf brdf;
  brdf.fields.resize(names.size());
  bool has_jacobian = false;
  const auto fields = bytes.number<uint32_t>();
  for (uint32_t i = 0; i < fields; ++i) {
    const auto name_length = bytes.number<uint16_t>();
    const std::string name(bytes.take(name_length));
    const auto dimensions = bytes.number<uint16_t>();
    const auto kind = bytes.number<uint8_t>();
    const auto place = bytes.number<uint64_t>();
    std::vector<int> shape;
    size_t count = 1;
    for (uint16_t k = 0; k < dimensions; ++k) {
      const auto side = bytes.number<uint64_t>();
      require(side >= 1 && side <= std::min<uint64_t>(largest_file / count, std::numeric_limits<int>::max()),
              "{}: expected a field \"{}\" that fits the file, got a side of {}", path, name, side);
      shape.push_back(int(side));
      count *= size_t(side);
    }
    if (name == "jacobian" && count == 1) has_jacobian = bytes.at(size_t(place), 1)[0] != 0;
    const auto known = std::find(names.begin(), names.end(), name);
    if (known == names.end() || name.empty()) continue;
    constexpr uint8_t floats = 10;
    require(kind == floats, "{}: expected 32-bit floats in the field \"{}\", got numbers of the kind {}", path, name,
            kind);
    const std::string_view values =
        bytes.at(size_t(place), count * sizeof(float));  // which a file that ends earlier lacks
    MeasuredField& field = brdf.fields[size_t(known - names.begin())];
    field = {name, shape, std::vector<float>(count)};
    std::memcpy(field.values.data(), values.data(), values.size());
  }
  for (size_t i = 0; i < names.size(); ++i)
    require(names[i].empty() || !brdf.fields[i].values.empty(),
            "{}: expected a field \"{}\", which a spectral file of the RGL database has, got none", path, names[i]);
  require(has_jacobian,
          "{}: expected a BRDF whose values hold their Jacobian, as those of the RGL database since 2018 do", path);
  try {
    prepare_rgl(brdf);
  } catch (const Error& e) {
    fail("{}: {}", path, e.what());
  }
  return brdf;
}

}  // namespace

MeasuredBrdf load_measured(const std::string& path) {
  check_file_exists(path, "a measured BRDF");
  const std::string bytes = read_text(path, largest_file);
  return std::string_view(bytes).starts_with(rgl_magic) ? read_rgl(bytes, path) : read_merl(bytes, path);
}

}  // namespace holotrace
