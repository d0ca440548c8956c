#include "holotrace/io/mesh/gltf_accessor.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <string_view>

#include "holotrace/base/error.h"

namespace holotrace {
namespace {

using Json = nlohmann::json;

// Values of "componentType" in the standard.
enum Component : int { int8 = 5120, uint8 = 5121, int16 = 5122, uint16 = 5123, uint32 = 5125, float32 = 5126 };

size_t size_of(int component, const GltfFile& gltf) {
  switch (component) {
    case int8:
    case uint8:
      return 1;
    case int16:
    case uint16:
      return 2;
    case uint32:
    case float32:
      return 4;
    default:
      fail("{}: expected a component type of glTF, 5120 to 5126, got {}; export it again", gltf.path, component);
  }
}

size_t components_of(const std::string& type, const GltfFile& gltf) {
  constexpr std::array<std::pair<const char*, size_t>, 7> types{
      {{"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4}, {"MAT2", 4}, {"MAT3", 9}, {"MAT4", 16}}};
  for (const auto& [name, count] : types)
    if (type == name) return count;
  fail("{}: expected the type of an accessor, SCALAR to MAT4, got \"{}\"; export it again", gltf.path, type);
}

template <class T>
double as(const char* bytes) {
  T value;
  std::memcpy(&value, bytes, sizeof value);
  return double(value);
}

// A number, little-endian as this machine's.
double read(const char* bytes, int component) {
  switch (component) {
    case int8:
      return as<int8_t>(bytes);
    case uint8:
      return as<uint8_t>(bytes);
    case int16:
      return as<int16_t>(bytes);
    case uint16:
      return as<uint16_t>(bytes);
    case uint32:
      return as<uint32_t>(bytes);
    default:
      return as<float>(bytes);
  }
}

double normalized(double value, int component) {
  switch (component) {
    case int8:
      return std::max(value / 127, -1.0);
    case uint8:
      return value / 255;
    case int16:
      return std::max(value / 32767, -1.0);
    case uint16:
      return value / 65535;
    default:
      return value;
  }
}

// Items of numbers in a buffer view.
struct Items {
  std::string_view bytes;
  size_t stride = 0, size = 0;  // size: of one number
  int component = float32;
  const char* at(size_t item, size_t number) const { return bytes.data() + item * stride + number * size; }
};

// `count` items of `numbers` numbers each, from the "bufferView" and "byteOffset" of `source`.
Items items_of(const GltfFile& gltf, const Json& source, int component, size_t count, size_t numbers) {
  const auto index = gltf_count(gltf, source.at("bufferView"));
  Items items{gltf_view(gltf, index), 0, size_of(component, gltf), component};
  const size_t packed = items.size * numbers;
  items.stride = gltf_count(gltf, gltf.document.at("bufferViews").at(index), "byteStride", packed);
  if (items.stride == 0) items.stride = packed;
  const auto offset = gltf_count(gltf, source, "byteOffset", 0);
  const size_t present = items.bytes.size();
  const bool is_inside = offset <= present && items.stride >= packed && packed <= present - offset &&
                         count - 1 <= (present - offset - packed) / items.stride;
  require(count == 0 || is_inside,
          "{}: expected {} items of {} numbers from byte {} on, but the buffer view {} ends after {} bytes; export it "
          "again",
          gltf.path, count, numbers, offset, index, present);
  items.bytes.remove_prefix(std::min(offset, present));
  return items;
}

constexpr size_t most_without_data = 1 << 24;  // items of a sparse accessor that states only a few

}  // namespace

std::vector<double> gltf_numbers(const GltfFile& gltf, size_t accessor, size_t components) {
  const Json& source = gltf.document.at("accessors").at(accessor);
  const int component = int(std::min<size_t>(gltf_count(gltf, source.at("componentType")), 1 << 30));
  const size_t count = gltf_count(gltf, source.at("count"));
  const size_t present = components_of(source.at("type").get<std::string>(), gltf);
  const bool is_normalized = source.value("normalized", false), is_sparse = source.contains("sparse");
  require(present >= components, "{}: expected {} numbers per item of the accessor {}, got {}; export it again",
          gltf.path, components, accessor, present);
  const auto convert = [&](double value) { return is_normalized ? normalized(value, component) : value; };
  std::vector<double> values;
  if (source.contains("bufferView")) {
    const Items items = items_of(gltf, source, component, count, present);
    values.reserve(count * components);
    for (size_t i = 0; i < count; ++i)
      for (size_t c = 0; c < components; ++c) values.push_back(convert(read(items.at(i, c), component)));
  } else {
    require(is_sparse && count <= most_without_data, "{}: expected data of the accessor {}, got none; export it again",
            gltf.path, accessor);
    values.assign(count * components, 0.0);
  }
  if (!is_sparse) return values;
  const Json& sparse = source.at("sparse");
  const size_t changed = gltf_count(gltf, sparse.at("count"));
  const Json& places = sparse.at("indices");
  const int place_component = int(std::min<size_t>(gltf_count(gltf, places.at("componentType")), 1 << 30));
  const Items indices = items_of(gltf, places, place_component, changed, 1);
  const Items news = items_of(gltf, sparse.at("values"), component, changed, present);
  for (size_t i = 0; i < changed; ++i) {
    const double place = read(indices.at(i, 0), place_component);
    require(place >= 0 && place < double(count), "{}: expected indices below {} in the sparse accessor {}, got {}",
            gltf.path, count, accessor, place);
    for (size_t c = 0; c < components; ++c)
      values[size_t(place) * components + c] = convert(read(news.at(i, c), component));
  }
  return values;
}

std::vector<uint32_t> gltf_indices(const GltfFile& gltf, size_t accessor) {
  const std::vector<double> numbers = gltf_numbers(gltf, accessor, 1);
  std::vector<uint32_t> indices;
  indices.reserve(numbers.size());
  for (const double number : numbers) {
    const auto index = number >= 0 && number < 0x1p32 ? uint32_t(number) : UINT32_MAX;
    require(double(index) == number, "{}: expected whole numbers in the accessor {} of indices, got {}", gltf.path,
            accessor, number);
    indices.push_back(index);
  }
  return indices;
}

}  // namespace holotrace
