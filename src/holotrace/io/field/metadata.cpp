#include "holotrace/io/field/metadata.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "holotrace/base/error.h"
#include "holotrace/base/message_text.h"
#include "holotrace/io/files/text.h"

namespace holotrace {

nlohmann::json read_metadata(const std::string& path) { return parse_metadata(read_lines(path), path); }

nlohmann::json parse_metadata(const std::string& text, const std::string& path) {
  nlohmann::json json = parse_json(text, path);
  require(json.is_object(), "{}: expected a JSON object {{…}}, got {}", path, json.type_name());
  return json;
}

double metadata_number(const nlohmann::json& json, const std::string& path, const char* key,
                       std::optional<double> fallback) {
  const auto found = json.find(key);
  if (found == json.end()) {
    if (!fallback) fail("{}: expected the key \"{}\", which is missing; add it, in SI units", path, key);
    return *fallback;
  }
  require(found->is_number(), "{}: expected a number for \"{}\", got {}", path, key, found->dump());
  const double value = found->get<double>();
  require(std::isfinite(value), "{}: expected a finite number for \"{}\", got {}", path, key, value);
  return value;
}

std::string metadata_text(const nlohmann::json& json, const std::string& path, const char* key,
                          const std::string& fallback) {
  const auto found = json.find(key);
  if (found == json.end()) return fallback;
  require(found->is_string(), "{}: expected a text for \"{}\", got {}", path, key, found->dump());
  return found->get<std::string>();
}

void MetadataReader::expect(bool holds, const char* what, const nlohmann::json& json, const char* name) const {
  if (!holds)
    fail("{}: expected {} for \"{}\", got {}", path_, what, name,
         json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace));
}

double MetadataReader::whole(const nlohmann::json& json, const char* name, double least, double most) const {
  double value = 0;
  from(json, name, value);
  require(value == std::floor(value) && value >= least && value <= most,
          "{}: expected a whole number from {:.0f} to {:.0f} for \"{}\", got {}", path_, least, most, name, value);
  return value;
}

void MetadataReader::from(const nlohmann::json& json, const char* name, double& value) const {
  expect(json.is_number(), "a number", json, name);
  value = json.get<double>();
  require(std::isfinite(value), "{}: expected a finite number for \"{}\", got {}", path_, name, value);
}

void MetadataReader::from(const nlohmann::json& json, const char* name, bool& value) const {
  expect(json.is_boolean(), "true or false", json, name);
  value = json.get<bool>();
}

void MetadataReader::from(const nlohmann::json& json, const char* name, std::string& value) const {
  expect(json.is_string(), "a text", json, name);
  value = printable(json.get_ref<const std::string&>());
}

void MetadataReader::from(const nlohmann::json& json, const char* name, Vec3& value) const {
  expect(json.is_array() && json.size() == 3, "three numbers", json, name);
  from(json[0], name, value.x), from(json[1], name, value.y), from(json[2], name, value.z);
}

void MetadataReader::from(const nlohmann::json& json, const char* name, DeadPixel& value) const {
  expect(json.is_array() && json.size() == 3, "[column, row, level]", json, name);
  from(json[0], name, value.column), from(json[1], name, value.row), from(json[2], name, value.level);
}

void MetadataReader::from(const nlohmann::json& json, const char* name, LightLosses& value) const {
  value = {false, false};
  expect(json.is_array(), "a list of \"cone\" and \"pixels\"", json, name);
  for (const nlohmann::json& loss : json) {
    expect(loss == "cone" || loss == "pixels", "a list of \"cone\" and \"pixels\"", json, name);
    (loss == "cone" ? value.by_cone : value.by_pixels) = true;
  }
}

void MetadataReader::from(const nlohmann::json& json, const char* name, std::vector<CalibrationPoint>& value) const {
  expect(json.is_object(), "an object", json, name);
  std::vector<double> phases, amplitudes;
  MetadataReader table(json, path_);
  table(key("phase_rad", phases), key("amplitude", amplitudes));
  require(phases.size() == amplitudes.size(),
          "{}: expected as many calibrated amplitudes as phases, got {} and {}; write the hologram again", path_,
          amplitudes.size(), phases.size());
  value.clear();
  for (size_t level = 0; level < phases.size(); ++level) value.push_back({phases[level], amplitudes[level]});
}

void MetadataReader::refuse_name(const char* name, const std::string& text,
                                 const std::vector<std::string>& known) const {
  fail("{}: {}", path_, unknown_name_message(name, text, known));
}

namespace {

constexpr const char *wavelengths_key = "wavelengths_m", *cone_key = "cone_wavelength_m",
                     *cones_key = "cone_wavelengths_m";

// One number for each field of a stack. A single one may stand without a list.
std::vector<double> numbers_of_fields(const nlohmann::json& json, const char* key, size_t count,
                                      const std::string& path, const std::string& how_to_add) {
  const auto found = json.find(key);
  require(found != json.end(), "{}: expected the key \"{}\", which is missing; {}", path, key, how_to_add);
  const nlohmann::json list = found->is_number() ? nlohmann::json::array({*found}) : *found;
  const bool are_numbers =
      list.is_array() && std::all_of(list.begin(), list.end(), [](const auto& value) { return value.is_number(); });
  require(are_numbers, "{}: expected {} number(s) in \"{}\", one per field of the stack, got another kind of value",
          path, count, key);
  require(list.size() == count, "{}: expected {} number(s) in \"{}\", one per field of the stack, got {}", path, count,
          key, list.size());
  return list.get<std::vector<double>>();
}

}  // namespace

template <class Real>
nlohmann::ordered_json stack_metadata(const std::vector<BasicField<Real>>& stack) {
  nlohmann::ordered_json json = metadata_of(stack.front());
  std::vector<double> wavelengths, cones;
  for (const auto& field : stack) {
    wavelengths.push_back(field.wavelength);
    cones.push_back(field.label.cone_wavelength);
  }
  json[wavelengths_key] = wavelengths;
  if (std::adjacent_find(cones.begin(), cones.end(), std::not_equal_to<>()) != cones.end()) {
    json.erase(cone_key);
    json[cones_key] = cones;
  }
  return json;
}

nlohmann::ordered_json all_stack_metadata() {
  nlohmann::ordered_json pattern = all_metadata<Field>();
  pattern[wavelengths_key] = pattern[cones_key] = nlohmann::ordered_json::array();
  return pattern;
}

template <class Real>
std::vector<BasicField<Real>> stack_of(nlohmann::json metadata, size_t count, const std::string& path,
                                       const std::string& how_to_add) {
  const std::vector<double> wavelengths = numbers_of_fields(metadata, wavelengths_key, count, path, how_to_add);
  std::vector<double> cones;
  if (metadata.contains(cones_key)) cones = numbers_of_fields(metadata, cones_key, count, path, how_to_add);
  std::vector<BasicField<Real>> stack(count);
  for (size_t n = 0; n < count; ++n) {
    metadata[wavelengths_key] = wavelengths[n];
    if (!cones.empty()) metadata[cone_key] = cones[n];
    MetadataReader reader(metadata, path, how_to_add);
    members(reader, stack[n]);
  }
  return stack;
}

void flat_metadata(const nlohmann::ordered_json& metadata,
                   const std::function<void(const std::string&, const nlohmann::ordered_json&)>& put,
                   const std::string& prefix) {
  for (const auto& [key, value] : metadata.items())
    if (value.is_object())
      flat_metadata(value, put, prefix + key + "_");
    else
      put(prefix + key, value);
}

nlohmann::json from_flat_metadata(
    const nlohmann::ordered_json& pattern,
    const std::function<nlohmann::json(const std::string&, const nlohmann::ordered_json&)>& find,
    const std::string& prefix) {
  nlohmann::json found = nlohmann::json::object();
  for (const auto& [key, like] : pattern.items()) {
    nlohmann::json value =
        like.is_object() ? from_flat_metadata(like, find, prefix + key + "_") : find(prefix + key, like);
    if (!value.is_null() && !(value.is_object() && value.empty())) found[key] = std::move(value);
  }
  return found;
}

std::string metadata_bytes(const nlohmann::json& metadata) {
  const std::vector<uint8_t> bytes = nlohmann::json::to_cbor(metadata);
  return {bytes.begin(), bytes.end()};
}

nlohmann::json metadata_from_bytes(const std::string& bytes, const std::string& path) {
  nlohmann::json metadata = nlohmann::json::from_cbor(bytes, true, false);
  require(metadata.is_object(), "{}: expected metadata, but the file is damaged", path);
  return metadata;
}

template nlohmann::ordered_json stack_metadata(const std::vector<Field>&);
template nlohmann::ordered_json stack_metadata(const std::vector<FieldDouble>&);
template std::vector<Field> stack_of(nlohmann::json, size_t, const std::string&, const std::string&);
template std::vector<FieldDouble> stack_of(nlohmann::json, size_t, const std::string&, const std::string&);

}  // namespace holotrace
