#include "holotrace/io/field/metadata.h"

#include <algorithm>
#include <cmath>

#include "holotrace/base/error.h"
#include "holotrace/base/suggest.h"
#include "holotrace/io/files/json_text.h"
#include "holotrace/io/files/text_lines.h"

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

std::vector<std::string> metadata_texts(const nlohmann::json& json, const std::string& path, const char* key) {
  const auto found = json.find(key);
  if (found == json.end()) return {};
  const bool is_list = found->is_array() && std::all_of(found->begin(), found->end(),
                                                        [](const nlohmann::json& item) { return item.is_string(); });
  require(is_list, "{}: expected a list of texts for \"{}\", got {}", path, key, found->dump());
  return found->get<std::vector<std::string>>();
}

std::vector<double> metadata_numbers(const nlohmann::json& json, const std::string& path, const char* key) {
  const auto found = json.find(key);
  const bool is_list = found != json.end() && found->is_array() &&
                       std::all_of(found->begin(), found->end(), [](const nlohmann::json& item) {
                         return item.is_number() && std::isfinite(item.get<double>());
                       });
  require(is_list, "{}: expected a list of finite numbers for \"{}\", got {}", path, key,
          found == json.end() ? "nothing" : found->dump());
  return found->get<std::vector<double>>();
}

const char* image_side_name(ImageSide side) { return side == ImageSide::real_image ? "real" : "virtual"; }

ImageSide image_side_from(const std::string& name, const std::string& path) {
  if (name == "virtual") return ImageSide::virtual_image;
  if (name == "real") return ImageSide::real_image;
  fail("{}: {}", path, unknown_name_message("image", name, {"virtual", "real"}));
}

const char* modulation_name(Modulation modulation) {
  if (modulation == Modulation::complex) return "complex";
  return modulation == Modulation::amplitude ? "amplitude" : "phase";
}

Modulation modulation_from(const std::string& name, const std::string& path) {
  if (name == "phase") return Modulation::phase;
  if (name == "amplitude") return Modulation::amplitude;
  if (name == "complex") return Modulation::complex;
  fail("{}: {}", path, unknown_name_message("modulation", name, {"phase", "amplitude", "complex"}));
}

uint32_t frame_from(double number, const std::string& path) {
  require(number >= 0 && number < 0x1p32 && number == std::floor(number),
          "{}: expected a whole number of 0 or more for \"frame\", got {}", path, number);
  return uint32_t(number);
}

nlohmann::json filter_to_json(const SpectralFilter& filter) {
  return {{"u0_per_m", filter.u0},
          {"v0_per_m", filter.v0},
          {"half_u_per_m", filter.half_u},
          {"half_v_per_m", filter.half_v}};
}

std::optional<SpectralFilter> filter_from_json(const nlohmann::json& json, const std::string& path) {
  const auto found = json.find("filter");
  if (found == json.end() || found->is_null()) return std::nullopt;
  require(found->is_object(), "{}: expected an object for \"filter\", got {}", path, found->dump());
  return SpectralFilter{metadata_number(*found, path, "u0_per_m"), metadata_number(*found, path, "v0_per_m"),
                        metadata_number(*found, path, "half_u_per_m"), metadata_number(*found, path, "half_v_per_m")};
}

}  // namespace holotrace
