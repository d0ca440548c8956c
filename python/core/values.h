#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>

#include <string>
#include <vector>

#include "holotrace/base/vec.h"
#include "holotrace/data/params/parameter.h"

// Values of Python as the values of parameters: a number in SI units, or a text with its unit as on the command line.

namespace holotrace::python {

namespace nb = nanobind;

/// Metres, radians or seconds; a wavelength may be the name of a light. @throws Error, naming the parameter, for other kinds of values and for texts without a unit
double to_length(nb::handle value, const char* name, Quantity quantity = Quantity::length);
double to_angle(nb::handle value, const char* name);
double to_time(nb::handle value, const char* name);

/// Metres from one length, a text of several lengths ("290, 310 mm") or a sequence of lengths; seconds from times. @throws Error
std::vector<double> to_lengths(nb::handle value, const char* name, Quantity quantity = Quantity::length);

/// Three lengths. @throws Error
Vec3 to_position(nb::handle value, const char* name);

/// A wavelength, above 0. @throws Error, naming the likely mistake for a number such as 532, which are metres
double to_wavelength(nb::handle value, const char* name = "wavelength");
std::vector<double> to_wavelengths(nb::handle value, const char* name = "wavelength");

double to_number(nb::handle value, const char* name);
int64_t to_count(nb::handle value, const char* name);
bool to_flag(nb::handle value, const char* name);
std::string to_text(nb::handle value, const char* name);
std::vector<std::string> to_texts(nb::handle value, const char* name);

/// The value as an error shows it, shortened.
std::string shown(nb::handle value);

/// check_range with the parameter's name in the sentence.
void check_named(double value, const Range& range, Quantity quantity, const char* name);

}  // namespace holotrace::python
