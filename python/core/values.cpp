#include "values.h"

#include <cmath>
#include <string_view>

#include "holotrace/base/error.h"
#include "holotrace/base/message_text.h"
#include "holotrace/base/units.h"
#include "holotrace/data/grid.h"
#include "holotrace/data/params/parameter_texts.h"

namespace holotrace::python {
namespace {

bool is_text(nb::handle value) { return PyUnicode_Check(value.ptr()); }

// Numbers of Python and NumPy, and what converts itself to one; truth values are not lengths.
bool is_number(nb::handle value) {
  return !PyBool_Check(value.ptr()) && !is_text(value) && PyNumber_Check(value.ptr()) && !PyComplex_Check(value.ptr());
}

double as_double(nb::handle value, const char* name) {
  const double number = PyFloat_AsDouble(value.ptr());
  if (number == -1 && PyErr_Occurred()) {
    PyErr_Clear();
    fail("expected a number for \"{}\", got {}", name, shown(value));
  }
  return number;
}

std::string as_text(nb::handle value) { return nb::cast<std::string>(value); }

// A number in SI units, or a text that `parse` reads.
template <class Parse>
double to_quantity(nb::handle value, const char* name, const char* expected, const Parse& parse) {
  if (is_text(value)) {
    try {
      return parse(as_text(value));
    } catch (const Error& error) {
      fail("{} for \"{}\"", error.what(), name);
    }
  }
  require(is_number(value), "expected {} for \"{}\", got {}", expected, name, shown(value));
  const double number = as_double(value, name);
  require(std::isfinite(number), "expected a finite number for \"{}\", got {}", name, number);
  return number;
}

template <class Visit>
void each_item(nb::handle value, const char* name, const char* expected, const Visit& visit) {
  require(PySequence_Check(value.ptr()) || nb::hasattr(value, "__iter__"), "expected {} for \"{}\", got {}", expected,
          name, shown(value));
  for (const nb::handle item : nb::iter(value)) visit(item);
}

void check_wavelength_of(double metres, nb::handle value, const char* name) {
  check_named(metres, range::positive, Quantity::length, name);
  if (metres <= longest_wavelength) return;
  if (is_text(value)) fail("expected a wavelength of light for \"{}\", got {}", name, shown(value));
  fail("expected metres for \"{0}\", got {1:g}, which is a wavelength of {1:g} m; write \"{1:g} nm\" or {1:g}e-9", name,
       metres);
}

}  // namespace

std::string shown(nb::handle value) {
  std::string text = nb::cast<std::string>(nb::repr(value));
  constexpr size_t most = 60;
  if (text.size() > most) text = text.substr(0, most) + "...";
  return printable(text);
}

void check_named(double value, const Range& range, Quantity quantity, const char* name) {
  check_range(value, range, quantity, std::string(" for \"") + name + "\"");
}

double to_length(nb::handle value, const char* name, Quantity quantity) {
  const double metres =
      to_quantity(value, name, "a length in metres, or a text with its unit such as \"300 mm\",",
                  [&](const std::string& text) { return value_within(text, range::any, name, quantity); });
  // Of a bare number: 300 is meant to be 300 mm, and a pupil of 3 to be 3 mm.
  const std::string_view of = name;
  const bool is_size = of == "pupil" || of == "eyebox" || of == "eye_separation" || of == "width" || of == "height" ||
                       of == "pixel" || of == "focal_length";
  const double longest = is_size ? 1 : 10;
  require(is_text(value) || quantity == Quantity::wavelength || std::abs(metres) <= longest || !std::isfinite(metres),
          "expected metres for \"{0}\", got {1:g}; write \"{1:g} mm\", or \"{1:g} m\" if you mean it", name, metres);
  return metres;
}

double to_angle(nb::handle value, const char* name) {
  const double radians =
      to_quantity(value, name, "an angle in radians, or a text with its unit such as \"15 deg\",", parse_angle);
  if (!is_text(value)) check_bare_angle(radians, name);
  return radians;
}

double to_time(nb::handle value, const char* name) {
  return to_quantity(value, name, "a time in seconds, or a text with its unit such as \"0.5 s\",", parse_time);
}

std::vector<double> to_lengths(nb::handle value, const char* name, Quantity quantity) {
  if (is_text(value)) {
    try {
      return values_within(as_text(value), range::any, name, quantity);
    } catch (const Error& error) {
      fail("{} for \"{}\"", error.what(), name);
    }
  }
  const bool are_times = quantity == Quantity::time;
  const auto one = [&](nb::handle item) { return are_times ? to_time(item, name) : to_length(item, name, quantity); };
  if (is_number(value) && !PySequence_Check(value.ptr())) return {one(value)};
  std::vector<double> lengths;
  each_item(value, name, are_times ? "times" : "lengths", [&](nb::handle item) { lengths.push_back(one(item)); });
  return lengths;
}

Vec3 to_position(nb::handle value, const char* name) {
  const std::vector<double> lengths = to_lengths(value, name);
  require(lengths.size() == 3, "expected three lengths x, y and z for \"{}\", got {}", name, lengths.size());
  return {lengths[0], lengths[1], lengths[2]};
}

double to_wavelength(nb::handle value, const char* name) {
  const double metres = to_length(value, name, Quantity::wavelength);
  check_wavelength_of(metres, value, name);
  return metres;
}

std::vector<double> to_wavelengths(nb::handle value, const char* name) {
  const std::vector<double> wavelengths = to_lengths(value, name, Quantity::wavelength);
  require(!wavelengths.empty(), "expected one wavelength or more for \"{}\", got none", name);
  for (const double metres : wavelengths) check_wavelength_of(metres, value, name);
  return wavelengths;
}

double to_number(nb::handle value, const char* name) {
  require(is_number(value), "expected a number for \"{}\", got {}", name, shown(value));
  return as_double(value, name);
}

int64_t to_count(nb::handle value, const char* name) {
  PyObject* whole = PyBool_Check(value.ptr()) ? nullptr : PyNumber_Index(value.ptr());
  if (!whole) {
    PyErr_Clear();
    fail("expected a whole number for \"{}\", got {}", name, shown(value));
  }
  const nb::object held = nb::steal(whole);
  const int64_t count = PyLong_AsLongLong(whole);
  if (count == -1 && PyErr_Occurred()) {
    PyErr_Clear();
    fail("expected a whole number of at most 2^63 for \"{}\", got {}", name, shown(value));
  }
  return count;
}

bool to_flag(nb::handle value, const char* name) {
  const bool is_numpy = nb::cast<std::string>(nb::str(value.type().attr("__name__"))).starts_with("bool");
  require(PyBool_Check(value.ptr()) || is_numpy, "expected True or False for \"{}\", got {}", name, shown(value));
  return PyObject_IsTrue(value.ptr()) == 1;
}

std::string to_text(nb::handle value, const char* name) {
  require(is_text(value), "expected a text for \"{}\", got {}", name, shown(value));
  return as_text(value);
}

std::vector<std::string> to_texts(nb::handle value, const char* name) {
  if (is_text(value)) return {as_text(value)};
  std::vector<std::string> texts;
  each_item(value, name, "a text or a list of texts", [&](nb::handle item) { texts.push_back(to_text(item, name)); });
  return texts;
}

}  // namespace holotrace::python
