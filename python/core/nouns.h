#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>

#include <string>

#include "pickles.h"

namespace holotrace::python {

namespace nb = nanobind;

// Each function adds its classes or functions to the module. The package's classes (holotrace/*.py) hold objects of
// these classes, check what they are made from, and name their attributes.
void bind_fields(nb::module_& module);
void bind_holograms(nb::module_& module);
void bind_pictures(nb::module_& module);
void bind_scenes(nb::module_& module);
void bind_params(nb::module_& module);
void bind_wave_verbs(nb::module_& module);
void bind_view_verbs(nb::module_& module);
void bind_estimate_verbs(nb::module_& module);
void bind_encode_verbs(nb::module_& module);
void bind_run_verbs(nb::module_& module);
void bind_gradients(nb::module_& module);

/// Adds copying and pickling to a class.
template <class Noun, class Class>
void bind_bytes(Class& one) {
  one.def("copy", [](const Noun& noun) { return Noun(noun); });
  one.def("__getstate__", [](const Noun& noun) {
    const std::string bytes = to_bytes(noun);
    return nb::bytes(bytes.data(), bytes.size());
  });
  one.def("__setstate__", [](Noun& noun, const nb::bytes& bytes) {
    new (&noun) Noun(from_bytes<Noun>(std::string_view(bytes.c_str(), bytes.size())));
  });
}

/// The names of an enumeration of a noun, which no parameter has.
ImageSide image_side_of(const std::string& name);
std::string name_of(ImageSide side);
Modulation modulation_of(const std::string& name);
std::string name_of(Modulation modulation);

}  // namespace holotrace::python
