#pragma once

#include <nanobind/nanobind.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "holotrace/base/error.h"
#include "holotrace/base/suggest.h"
#include "holotrace/data/params/choice.h"
#include "values.h"

// Parameters of a stage as keyword arguments, made from the list of the stage in data/params/.

namespace holotrace::python {

/// A visitor of `describe` that sets parameters from keyword arguments. None leaves a parameter as it is.
class ParamSetter {
 public:
  explicit ParamSetter(const nb::dict& given) : given_(given) {}

  template <class Integer>
  void count(const char* name, Integer& value, const Range& range, const char*) {
    with(name, [&](nb::handle given) {
      const int64_t whole = to_count(given, name);
      check_named(double(whole), range, Quantity::count, name);
      require(whole <= int64_t(std::numeric_limits<Integer>::max()), "expected at most {} for \"{}\", got {}",
              std::numeric_limits<Integer>::max(), name, whole);
      value = Integer(whole);
    });
  }
  void number(const char* name, double& value, const Range& range, const char*) {
    with(name, [&](nb::handle given) { set(name, value, to_number(given, name), range, Quantity::number); });
  }
  void length(const char* name, double& value, const Range& range, const char*) {
    with(name, [&](nb::handle given) { set(name, value, to_length(given, name), range, Quantity::length); });
  }
  void angle(const char* name, double& value, const Range& range, const char*) {
    with(name, [&](nb::handle given) { set(name, value, to_angle(given, name), range, Quantity::angle); });
  }
  void lengths(const char* name, std::vector<double>& value, const Range& range, const char*) {
    with(name, [&](nb::handle given) {
      value = to_lengths(given, name);
      for (const double one : value) check_named(one, range, Quantity::length, name);
    });
  }
  void position(const char* name, Vec3& value, const Range& range_of_z, const char*) {
    with(name, [&](nb::handle given) {
      value = to_position(given, name);
      check_range(value.z, range_of_z, Quantity::length, fmt::format(" for z of \"{}\"", name));
    });
  }
  void flag(const char* name, bool& value, const char*) {
    with(name, [&](nb::handle given) { value = to_flag(given, name); });
  }
  void texts(const char* name, std::vector<std::string>& value, const char*) {
    with(name, [&](nb::handle given) { value = to_texts(given, name); });
  }
  void device(const char* name, DeviceChoice& value, const char*) {
    with(name, [&](nb::handle given) { value = parse_device(to_text(given, name)); });
  }
  template <class Enum>
  void choice(const char* name, Enum& value, std::initializer_list<std::type_identity_t<Choice<Enum>>> choices,
              const char*) {
    with(name, [&](nb::handle given) {
      const std::string text = to_text(given, name);
      std::vector<std::string> names;
      for (const auto& choice : choices) {
        if (text == choice.name) {
          value = choice.value;
          return;
        }
        names.emplace_back(choice.name);
      }
      throw Error(unknown_name_message(name, text, names));
    });
  }

  /// @throws Error for the first keyword that no parameter has, naming the nearest
  void refuse_unknown() const {
    for (const auto& [key, value] : given_) {
      const std::string name = nb::cast<std::string>(key);
      if (std::find(known_.begin(), known_.end(), name) == known_.end())
        throw Error(unknown_name_message("parameter", name, known_));
    }
  }

 private:
  static void set(const char* name, double& value, double to, const Range& range, Quantity quantity) {
    check_named(to, range, quantity, name);
    value = to;
  }
  template <class Set>
  void with(const char* name, const Set& set) {
    known_.emplace_back(name);
    if (given_.contains(name) && !given_[name].is_none()) set(given_[name]);
  }

  const nb::dict& given_;
  std::vector<std::string> known_;
};

/// Sets the parameters that are given. @throws Error for unknown names and invalid values, naming the parameter
template <class Params>
void set_params(const nb::dict& given, Params& params) {
  ParamSetter setter(given);
  describe(setter, params);
  setter.refuse_unknown();
}

/// A visitor of `describe` that lists name, kind, value, bounds and help text of each parameter.
struct ParamLister {
  nb::list list{};

  void add(const char* name, const char* kind, nb::object value, const std::string& bounds, const char* help,
           nb::list choices = {}) {
    nb::dict one;
    one["name"] = name;
    one["kind"] = kind;
    one["value"] = std::move(value);
    one["bounds"] = bounds;
    one["help"] = help;
    one["choices"] = std::move(choices);
    list.append(one);
  }
  template <class Integer>
  void count(const char* name, Integer& v, const Range& range, const char* help) {
    add(name, "count", nb::cast(int64_t(v)), bounds_text(range, Quantity::count), help);
  }
  void number(const char* name, double& v, const Range& range, const char* help) {
    add(name, "number", nb::cast(v), bounds_text(range, Quantity::number), help);
  }
  void length(const char* name, double& v, const Range& range, const char* help) {
    add(name, "length", nb::cast(v), bounds_text(range, Quantity::length), help);
  }
  void angle(const char* name, double& v, const Range& range, const char* help) {
    add(name, "angle", nb::cast(v), bounds_text(range, Quantity::angle), help);
  }
  void lengths(const char* name, std::vector<double>& v, const Range& range, const char* help) {
    nb::list values;
    for (const double one : v) values.append(one);
    add(name, "lengths", nb::tuple(values), bounds_text(range, Quantity::length), help);
  }
  void position(const char* name, Vec3& v, const Range&, const char* help) {
    add(name, "position", nb::make_tuple(v.x, v.y, v.z), "", help);
  }
  void flag(const char* name, bool& v, const char* help) { add(name, "flag", nb::bool_(v), "", help); }
  void texts(const char* name, std::vector<std::string>& v, const char* help) {
    nb::list values;
    for (const std::string& one : v) values.append(nb::str(one.c_str()));
    add(name, "texts", nb::tuple(values), "", help);
  }
  void device(const char* name, DeviceChoice& v, const char* help) {
    add(name, "device", nb::str(device_text(v).c_str()), "", help);
  }
  template <class Enum>
  void choice(const char* name, Enum& v, std::initializer_list<std::type_identity_t<Choice<Enum>>> choices,
              const char* help) {
    nb::list names;
    nb::object value = nb::none();
    for (const auto& choice : choices) {
      names.append(choice.name);
      if (choice.value == v) value = nb::str(choice.name);
    }
    add(name, "choice", std::move(value), "", help, names);
  }
};

template <class Params>
nb::list list_params(Params params) {
  ParamLister lister;
  describe(lister, params);
  return lister.list;
}

}  // namespace holotrace::python
