#pragma once

#include <array>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "holotrace/data/field.h"
#include "holotrace/data/slm.h"

// The metadata beside fields and holograms, as JSON. Only the files of this room use it.

namespace holotrace {

/// Parses the sidecar at `path`.
/// @throws Error with file, line and column for broken JSON, and if it is not an object
nlohmann::json read_metadata(const std::string& path);

/// Parses metadata that a file holds. @throws Error as read_metadata does; `name` is that of the file
nlohmann::json parse_metadata(const std::string& text, const std::string& name);

/// A number of a JSON object, or `fallback` where the key is absent and a fallback is given.
/// @throws Error naming file and key if the value is missing, not a number, or not finite
double metadata_number(const nlohmann::json& json, const std::string& path, const char* key,
                       std::optional<double> fallback = std::nullopt);

/// A text of a JSON object, or `fallback` if the key is absent.
/// @throws Error naming file and key if the value is not a text
std::string metadata_text(const nlohmann::json& json, const std::string& path, const char* key,
                          const std::string& fallback);

/// A list of numbers of a JSON object.
/// @throws Error naming file and key if the value is missing, or not a list of finite numbers
std::vector<double> metadata_numbers(const nlohmann::json& json, const std::string& path, const char* key);

/// A list of texts of a JSON object, empty where the key is absent.
/// @throws Error naming file and key if the value is not a list of texts
std::vector<std::string> metadata_texts(const nlohmann::json& json, const std::string& path, const char* key);

const char* image_side_name(ImageSide side);                                   ///< "virtual" or "real"
ImageSide image_side_from(const std::string& name, const std::string& path);   ///< @throws Error naming the file
const char* modulation_name(Modulation modulation);                            ///< "phase", "amplitude" or "complex"
Modulation modulation_from(const std::string& name, const std::string& path);  ///< @throws Error naming the file

/// A number as the index of a frame. @throws Error naming the file unless it is whole and 0 … 2³²−1
uint32_t frame_from(double number, const std::string& path);

/// Attributes of a spectral filter in HDF5 and EXR [1/m]: its centre (u, v) and half widths (u, v).
inline constexpr std::array filter_attributes{"filter_u0_per_m", "filter_v0_per_m", "filter_half_u_per_m",
                                              "filter_half_v_per_m"};

nlohmann::json filter_to_json(const SpectralFilter& filter);

/// The filter of a JSON object; none if the key "filter" is absent or null.
std::optional<SpectralFilter> filter_from_json(const nlohmann::json& json, const std::string& path);

}  // namespace holotrace
