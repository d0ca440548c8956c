#pragma once

#include <concepts>
#include <functional>
#include <initializer_list>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "holotrace/base/error.h"
#include "holotrace/data/members.h"

// The metadata of fields, stacks and holograms as JSON: the members that have keys in data/members.h. NPY keeps it in a file beside it, PNG
// as a text; HDF5 and EXR keep each value as an attribute (flat_metadata). Only the files of this room use it.

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

inline std::initializer_list<Choice<ImageSide>> names_for(ImageSide) { return image_side_names; }
inline std::initializer_list<Choice<Modulation>> names_for(Modulation) { return modulation_names; }
inline std::initializer_list<Choice<CrystalPass>> names_for(CrystalPass) { return crystal_pass_names; }

/// An archive that writes the members with keys into `json`, and leaves out objects without members.
class MetadataWriter {
 public:
  nlohmann::ordered_json json = nlohmann::ordered_json::object();
  bool is_complete = false;  ///< with the members that files leave out

  template <class... Members>
  void operator()(const Members&... each) {
    (write(each), ...);
  }

 private:
  template <class T>
  void write(const T&) {}  // what the file holds itself
  template <class T>
  void write(const Keys<T>& part) {
    members(*this, part.value);
  }
  template <class T>
  void write(const Key<T>& key) {
    if (!key.is_written && !is_complete) return;
    const nlohmann::ordered_json value = json_of(key.value);
    if (!value.is_object() || !value.empty()) json[key.name] = value;
  }

  template <class T>
  nlohmann::ordered_json json_of(const T& value) {
    if constexpr (std::is_enum_v<T>) {
      return name_of(value, names_for(value));
    } else if constexpr (requires { members(*this, const_cast<T&>(value)); }) {
      MetadataWriter part{.is_complete = is_complete};
      members(part, const_cast<T&>(value));
      return part.json;
    } else {
      return value;
    }
  }
  template <class T>
  nlohmann::ordered_json json_of(const std::optional<T>& value) {
    return json_of(value ? *value : T{});
  }
  template <class T>
  nlohmann::ordered_json json_of(const std::vector<T>& values) {
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    for (const T& value : values) list.push_back(json_of(value));
    return list;
  }
  nlohmann::ordered_json json_of(const Vec3& place) { return {place.x, place.y, place.z}; }
  nlohmann::ordered_json json_of(const DeadPixel& pixel) { return {pixel.column, pixel.row, pixel.level}; }
  nlohmann::ordered_json json_of(const LightLosses& losses) {
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    if (losses.by_cone) list.push_back("cone");
    if (losses.by_pixels) list.push_back("pixels");
    return list;
  }
  nlohmann::ordered_json json_of(const std::vector<CalibrationPoint>& points) {  // as columns
    nlohmann::ordered_json table = nlohmann::ordered_json::object();
    for (const CalibrationPoint& point : points) {
      table["phase_rad"].push_back(point.phase);
      table["amplitude"].push_back(point.amplitude);
    }
    return table;
  }
};

/// An archive that reads what MetadataWriter wrote. Texts become printable.
/// @throws Error naming file and key for a value that is missing or of another kind
class MetadataReader {
 public:
  /// @param how_to_add  advice to add a missing value
  MetadataReader(const nlohmann::json& json, const std::string& path, std::string how_to_add = "add it, in SI units")
      : json_(json), path_(path), how_to_add_(std::move(how_to_add)) {}

  template <class... Members>
  void operator()(Members&&... each) {
    (read(each), ...);
  }

 private:
  template <class T>
  void read(T&) {}
  template <class T>
  void read(Keys<T>& part) {
    members(*this, part.value);
  }
  template <class T>
  void read(Key<T>& key) {
    const auto found = json_.find(key.name);
    if (found != json_.end())
      from(*found, key.name, key.value);
    else if (key.is_required)
      fail("{}: expected the key \"{}\", which is missing; {}", path_, key.name, how_to_add_);
  }

  /// @throws Error  if `holds` is false: "PATH: expected WHAT for "NAME", got JSON"
  void expect(bool holds, const char* what, const nlohmann::json& json, const char* name) const;
  /// A whole number from `least` to `most`.
  double whole(const nlohmann::json& json, const char* name, double least, double most) const;

  void from(const nlohmann::json& json, const char* name, double& value) const;
  void from(const nlohmann::json& json, const char* name, bool& value) const;
  void from(const nlohmann::json& json, const char* name, std::string& value) const;
  void from(const nlohmann::json& json, const char* name, Vec3& value) const;
  void from(const nlohmann::json& json, const char* name, DeadPixel& value) const;
  void from(const nlohmann::json& json, const char* name, LightLosses& value) const;
  void from(const nlohmann::json& json, const char* name, std::vector<CalibrationPoint>& value) const;
  template <std::integral T>
  void from(const nlohmann::json& json, const char* name, T& value) const {
    if constexpr (sizeof(T) == 8) {
      expect(json.is_number_integer(), "a whole number", json, name);
      value = json.get<T>();
    } else {
      value = T(whole(json, name, std::numeric_limits<T>::min(), std::numeric_limits<T>::max()));
    }
  }
  template <class T>
  void from(const nlohmann::json& json, const char* name, std::optional<T>& value) const {
    if (!json.is_null()) from(json, name, value.emplace());
  }
  template <class T>
  void from(const nlohmann::json& json, const char* name, std::vector<T>& values) const {
    expect(json.is_array(), "a list", json, name);
    values.clear();
    for (const nlohmann::json& item : json) {
      const std::string place = fmt::format("{}[{}]", name, values.size());
      from(item, place.c_str(), values.emplace_back());
    }
  }
  template <class T>
  void from(const nlohmann::json& json, const char* name, T& value) const {
    if constexpr (std::is_enum_v<T>) {
      std::string text;
      from(json, name, text);
      value = value_of(text, name, names_for(value));
    } else {
      expect(json.is_object(), "an object", json, name);
      MetadataReader part(json, path_, how_to_add_);
      members(part, value);
    }
  }
  template <class Enum>
  Enum value_of(const std::string& text, const char* name, std::initializer_list<Choice<Enum>> names) const {
    std::vector<std::string> known;
    for (const Choice<Enum>& choice : names) {
      if (text == choice.name) return choice.value;
      known.push_back(choice.name);
    }
    refuse_name(name, text, known);
  }
  [[noreturn]] void refuse_name(const char* name, const std::string& text, const std::vector<std::string>& known) const;

  const nlohmann::json& json_;
  const std::string& path_;
  std::string how_to_add_;
};

/// The metadata of a noun.
template <class Noun>
nlohmann::ordered_json metadata_of(const Noun& noun) {
  MetadataWriter writer;
  members(writer, const_cast<Noun&>(noun));
  return writer.json;
}

/// All keys that metadata of a noun can have, with values of their kinds.
template <class Noun>
nlohmann::ordered_json all_metadata() {
  MetadataWriter writer{.is_complete = true};
  Noun noun;
  members(writer, noun);
  return writer.json;
}

/// The metadata of fields that share one grid, plane, image side and filter: "wavelengths_m" lists all, and "cone_wavelengths_m" if they
/// differ.
template <class Real>
nlohmann::ordered_json stack_metadata(const std::vector<BasicField<Real>>& stack);

/// All keys that the metadata of a stack can have, with values of their kinds.
nlohmann::ordered_json all_stack_metadata();

/// The fields of such metadata, with empty samples.
/// @throws Error  naming the file, unless it has `count` wavelengths, and as MetadataReader does
template <class Real>
std::vector<BasicField<Real>> stack_of(nlohmann::json metadata, size_t count, const std::string& path,
                                       const std::string& how_to_add = "add it, in SI units");

/// Calls put(name, value) for each number, text or list. Those of the object "filter" have names "filter_…".
void flat_metadata(const nlohmann::ordered_json& metadata,
                   const std::function<void(const std::string&, const nlohmann::ordered_json&)>& put,
                   const std::string& prefix = "");

/// Reads flat metadata.
/// @param pattern  all keys, with values of their kinds (all_metadata)
/// @param find     the value of a name, or null if there is none; `like` is the one in the pattern
nlohmann::json from_flat_metadata(
    const nlohmann::ordered_json& pattern,
    const std::function<nlohmann::json(const std::string& name, const nlohmann::ordered_json& like)>& find,
    const std::string& prefix = "");

/// Metadata as bytes for another process, and back. @throws Error  naming the file, for other bytes
std::string metadata_bytes(const nlohmann::json& metadata);
nlohmann::json metadata_from_bytes(const std::string& bytes, const std::string& path);

}  // namespace holotrace
