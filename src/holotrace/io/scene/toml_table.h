#pragma once

#include <toml++/toml.h>

#include <algorithm>
#include <cstdint>
#include <initializer_list>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <type_traits>
#include <vector>

#include "holotrace/base/error.h"
#include "holotrace/base/keyframes.h"
#include "holotrace/base/vec.h"
#include "holotrace/data/params/parameter.h"

namespace holotrace {

/// Parses a TOML file of at most most_text bytes (io/files/file.h) and of limited nesting (io/files/text.h).
/// @param kind  what was expected at the path, for messages ("a scene file")
/// @throws Error with file:line:column for invalid TOML, and as read_text does
toml::table parse_toml(const std::string& path, const char* kind);

struct SceneArrays;

/// The time at which the values of a scene are read, and what its tables say about time.
struct SceneTime {
  double now = 0;                ///< [s]
  std::optional<double> last{};  ///< the latest key of all values that were read [s]; nothing if no value has keys

  void note(double key) { last = std::max(last.value_or(key), key); }
};

/// Whether a table has keys over time, { "0 s" = …, "1 s" = … }, which stand for one value.
bool is_over_time(const toml::table& table);

/// The number of a TOML value, whole or not; nothing for values of another kind.
std::optional<double> to_number(const toml::node& node);

/// One table of a TOML file, read key by key. Each reader leaves its value unchanged if the key is
/// absent, and remembers the key, so that refuse_unknown_keys can find the others. It is a visitor of
/// `describe` of data/params/: describe(table, params) reads a parameter set.
///
/// Each value is checked against the range that its reader is given. Every Error starts with file:line:column.
///
/// In tables that are read at a time (read_at), a value may have keys, { "0 s" = …, "1 s" = … }. Lengths, angles, numbers,
/// colours, directions and rotations are interpolated between them, as `interpolation` beside the keys says: "linear", "smooth"
/// or "step" (base/keyframes.h). Other values are those of the last key; before the first one they are its value.
///
/// Tables may also be made in memory. Then numbers are lengths in metres and angles in radians beside texts with a unit,
/// indices of `arrays` stand for files, and an Error starts with the name of its table.
class TomlTable {
 public:
  /// @param files  paths of the files that the tables were read from, the main file first
  /// @param name   the table's name in errors: "[slm]". The table must outlive this object.
  TomlTable(const toml::table& table, std::vector<std::string> files, std::string name)
      : table_(&table), files_(std::move(files)), name_(std::move(name)) {}

  /// @param arrays  of tables made in memory
  TomlTable(const toml::table& table, std::shared_ptr<const SceneArrays> arrays, std::string name)
      : table_(&table), files_{""}, name_(std::move(name)), arrays_(std::move(arrays)) {}

  const std::string& name() const { return name_; }
  const toml::table& toml() const { return *table_; }
  bool has(const char* key) const {
    asked_.insert(key);
    return table_->contains(key);
  }

  /// The index into `arrays` that a key of a table in memory holds; nothing if it holds something else.
  std::optional<size_t> array_index(const char* key);
  const SceneArrays* arrays() const { return arrays_.get(); }

  /// From here on, this table and those that it gives are read at that time; nullptr: no value may have keys.
  void read_at(std::shared_ptr<SceneTime> time) { time_ = std::move(time); }
  const std::shared_ptr<SceneTime>& time() const { return time_; }

  /// "file:line:column: " of a key's value, or of the table if the key is "" or absent.
  std::string where(const char* key) const;

  /// Path of the file `name` relative to the folder of the file that has the key.
  std::string beside(const char* key, const std::string& name) const;

  /// Runs `read`; an Error that it throws gets the position of the key in front.
  template <class Read>
  void locate(const char* key, const Read& read) const {
    try {
      read();
    } catch (const Error& e) {
      if (is_placed(e)) throw;
      throw Error(where(key) + e.what());
    }
  }

  void operator()(const Parameter<int>& p) { count(p.name, p.value, p.range); }
  void operator()(const Parameter<int64_t>& p) { count(p.name, p.value, p.range); }
  void operator()(const Parameter<double>& p);
  void operator()(const Parameter<bool>& p) { flag(p.name, p.value); }
  void operator()(const Parameter<std::vector<double>>& p) { lengths(p.name, p.value, p.range, p.quantity); }
  void operator()(const Parameter<Vec3>& p);                      ///< "0 0 300 mm" or three texts
  void operator()(const Parameter<std::vector<std::string>>& p);  ///< a text or a list of them
  void operator()(const Parameter<DeviceChoice>& p);              ///< "opencl:1"
  void operator()(const Parameter<std::string>& p);  ///< a text, or a path, relative to the folder of the file
  template <class Enum>
  void operator()(const Parameter<Enum>& p) {
    std::string name;
    text(p.name, name);
    if (!name.empty()) locate(p.name, [&] { p.value = value_named(name, p); });
  }

  void count(const char* key, int& value, const Range& range);      ///< a whole number
  void count(const char* key, int64_t& value, const Range& range);  ///< a whole number
  void number(const char* key, double& value, const Range& range);  ///< a finite number
  void flag(const char* key, bool& value);                          ///< true or false
  void text(const char* key, std::string& value);                   ///< a text that is not empty
  /// "8 um"; a wavelength: or "HeNe"
  void length(const char* key, double& value, const Range& range, Quantity quantity = Quantity::length);
  /// "1 2 mm", a list; wavelengths: or "HeNe, DPSS 532"; times: "0 0.5 s"
  void lengths(const char* key, std::vector<double>& value, const Range& range, Quantity quantity = Quantity::length);
  void angle(const char* key, double& value, const Range& range);    ///< "15 deg"
  void instant(const char* key, double& value, const Range& range);  ///< "0.5 s"

  /// One of the names of an enumeration.
  template <class Enum>
  void choice(const char* key, Enum& value, std::initializer_list<std::type_identity_t<Choice<Enum>>> choices) {
    (*this)(holotrace::choice(key, value, choices, ""));
  }

  /// "0 0 -300 mm" or three texts
  void length_vector(const char* key, Vec3& value, const Range& range = range::any);
  void length_vectors(const char* key, std::vector<Vec3>& value);  ///< a list of such texts
  void colour(const char* key, Vec3& value, double most);          ///< one number or [r, g, b], each in [0, most]
  void direction(const char* key, Vec3& value);                    ///< [x, y, z] of any length above 0, normalized
  void rotation(const char* key, Frame& value);                    ///< "y 30 deg" or a list of rotations, in this order
  void outline(const char* key, std::vector<Vec2>& value);         ///< { unit = "mm", points = [[1, 2], …] }

  /// The table [key]. @param example  what may stand below its heading, for an error
  std::optional<TomlTable> table(const char* key, const char* example = "its keys");
  std::vector<TomlTable> tables(const char* key);                                         ///< the tables [[key]]
  std::vector<TomlTable> named_tables(const char* key, std::vector<std::string>& names);  ///< the tables [key.NAME]

  /// Marks a key as known before it is read.
  void know(const char* key) { known_.insert(key); }

  /// @throws Error unless the table has the key. If a similar key is there, the error names it.
  void require_key(const char* key);

  /// @throws Error for the first key that no reader asked for, naming the most similar known key
  void refuse_unknown_keys() const;

  /// The value of a key; nullptr if it is absent. The key is known from then on. Of a value with keys over time it is the
  /// one at the table's time. With place and fail_kind it serves
  /// readers of values of a special form.
  const toml::node* find(const char* key);
  std::string place(const toml::source_region& source) const;  ///< "file:line:column: "
  [[noreturn]] void fail_kind(const char* key, const char* expected, const toml::node& got) const;

 private:
  // The keys of a value over time: in their order, what stands at each.
  struct Keys {
    std::vector<double> times;
    std::vector<const toml::node*> nodes;
    Interpolation interpolation;
  };

  const toml::node* find_value(const char* key);  // also with keys over time
  Keys keys_over_time(const char* key, const toml::table& table, Interpolation otherwise) const;
  template <class Value, class Read>
  void interpolate(const char* key, Value& value, const Read& read);
  const std::string& file(const toml::source_region& source) const;
  bool is_placed(const Error& error) const;  // whether it starts with a position in one of the files, or a table
  TomlTable inner(const toml::table& table, std::string name) const;
  void check(const char* key, const toml::node& node, double value, const Range& range, Quantity quantity) const;
  std::string length_text(const char* key, const toml::node& node, Quantity quantity) const;
  std::optional<std::string> text_with_unit(const toml::node& node, const char* unit) const;
  std::vector<double> read_lengths(const char* key, const toml::node& node, Quantity quantity = Quantity::length) const;
  Vec3 read_vector(const char* key, const toml::node& node) const;
  Vec3 read_direction(const char* key, const toml::node& node) const;

  const toml::table* table_;
  std::vector<std::string> files_;
  std::string name_;
  std::shared_ptr<const SceneArrays> arrays_;  // nullptr for tables from files
  std::shared_ptr<SceneTime> time_;            // nullptr for tables without keys over time
  std::set<std::string> known_;
  mutable std::set<std::string> asked_;  // keys that may be there, for suggestions
};

}  // namespace holotrace
