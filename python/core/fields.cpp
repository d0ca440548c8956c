// Fields and sources.

#include <nanobind/stl/complex.h>
#include <nanobind/stl/vector.h>

#include "arrays.h"
#include "holotrace/base/units.h"
#include "holotrace/io/field/field_file.h"
#include "holotrace/io/field/sources_file.h"
#include "nouns.h"
#include "values.h"

namespace holotrace::python {
namespace {

template <class Real>
void bind_field(nb::module_& module, const char* name) {
  using F = BasicField<Real>;
  nb::class_<F> one(module, name);
  bind_bytes<F>(one);
  one.def_static(
      "make",
      [](const In2<std::complex<Real>>& samples, nb::handle pitch, nb::handle wavelength) {
        F field;
        field.grid.pitch = to_length(pitch, "pitch");
        check_named(field.grid.pitch, range::positive, Quantity::length, "pitch");
        require(field.grid.pitch <= largest_pitch,
                "expected a pitch in metres of at most {}, got {}; write \"{:g} um\"", format_length(largest_pitch),
                format_length(field.grid.pitch), field.grid.pitch);
        field.wavelength = to_wavelength(wavelength);
        field.samples = to_array(samples, "the samples of a field");
        field.grid.nx = field.samples.nx;
        field.grid.ny = field.samples.ny;
        return field;
      },
      nb::arg("samples"), nb::arg("pitch").none(), nb::arg("wavelength").none());
  one.def_prop_ro("samples", [](nb::handle self) { return view(self, nb::cast<F&>(self).samples); });
  one.def_prop_ro("pitch", [](const F& f) { return f.grid.pitch; });
  one.def_prop_rw(
      "centre", [](const F& f) { return nb::make_tuple(f.grid.centre_x, f.grid.centre_y); },
      [](F& f, nb::handle centre) {
        const std::vector<double> lengths = to_lengths(centre, "centre");
        require(lengths.size() == 2, "expected two lengths x and y for \"centre\", got {}", lengths.size());
        f.grid.centre_x = lengths[0];
        f.grid.centre_y = lengths[1];
      },
      nb::arg("centre").none());
  one.def_ro("wavelength", &F::wavelength);
  one.def_prop_ro("cone_wavelength", [](const F& f) { return f.label.cone_wavelength; });
  one.def_prop_rw(
      "z", [](const F& f) { return f.z; }, [](F& f, nb::handle z) { f.z = to_length(z, "z"); }, nb::arg("z").none());
  one.def_prop_rw(
      "image", [](const F& f) { return name_of(f.image); },
      [](F& f, const std::string& name) { f.image = image_side_of(name); });
  one.def_prop_rw(
      "name", [](const F& f) { return f.label.name; }, [](F& f, const std::string& name) { f.label.name = name; });
  one.def_prop_rw(
      "frame", [](const F& f) { return f.label.frame; }, [](F& f, uint32_t frame) { f.label.frame = frame; });
  one.def_prop_ro("power", [](const F& f) { return power(f); });
  one.def("as_single", [](const F& f) { return convert<float>(f); });
  one.def("as_double", [](const F& f) { return convert<double>(f); });
  module.def("save_fields", [](const std::string& path, const std::vector<F>& fields) {
    const nb::gil_scoped_release release;
    save_fields(path, fields);
  });
}

// Second foci and focal lines: none, or one of each wave.
Sources make_sources(const In2<double>& positions, const In1<float>& amplitudes, const In1<float>& phases,
                     const In2<double>& second_foci, const In2<double>& focal_lines, nb::handle wavelength) {
  require(positions.shape(1) == 3, "expected positions of the shape (n, 3), got ({}, {})", positions.shape(0),
          positions.shape(1));
  const size_t count = positions.shape(0);
  require(amplitudes.shape(0) == count && phases.shape(0) == count,
          "expected {} amplitudes and phases, one for each position, got {} and {}", count, amplitudes.shape(0),
          phases.shape(0));
  Sources sources{to_wavelength(wavelength)};
  sources.waves.resize(count);
  for (size_t i = 0; i < count; ++i)
    sources.waves[i] = {{positions(i, 0), positions(i, 1), positions(i, 2)}, amplitudes(i), phases(i)};
  const size_t foci = second_foci.shape(0);
  require(second_foci.shape(1) == 3 && focal_lines.shape(1) == 3 && focal_lines.shape(0) == foci &&
              (foci == 0 || foci == count),
          "expected second_foci and focal_lines of the shape ({}, 3), one for each position, got ({}, {}) and ({}, {})",
          count, foci, second_foci.shape(1), focal_lines.shape(0), focal_lines.shape(1));
  for (size_t i = 0; i < foci; ++i)
    sources.second_foci.push_back({{second_foci(i, 0), second_foci(i, 1), second_foci(i, 2)},
                                   {focal_lines(i, 0), focal_lines(i, 1), focal_lines(i, 2)}});
  if (count > 0) check_sources(sources);
  return sources;
}

}  // namespace

void bind_fields(nb::module_& module) {
  bind_field<float>(module, "Field32");
  bind_field<double>(module, "Field64");
  module.def("load_fields", [](const std::string& path, bool allow_outside) {
    const nb::gil_scoped_release release;
    return load_fields(path, allow_outside ? Outside::allowed : Outside::refused);
  });
  module.def("load_fields_double", [](const std::string& path, bool allow_outside) {
    const nb::gil_scoped_release release;
    return load_fields_double(path, allow_outside ? Outside::allowed : Outside::refused);
  });

  nb::class_<Sources> sources(module, "Sources");
  bind_bytes<Sources>(sources);
  sources.def_static("make", &make_sources, nb::arg("positions"), nb::arg("amplitudes"), nb::arg("phases"),
                     nb::arg("second_foci"), nb::arg("focal_lines"), nb::arg("wavelength").none());
  // The waves are one array of structures: a member of all of them is an array with a stride.
  constexpr int64_t doubles = sizeof(Source) / sizeof(double), floats = sizeof(Source) / sizeof(float);
  sources.def_prop_ro("positions", [](nb::handle self) {
    const auto& waves = nb::cast<Sources&>(self).waves;
    return view(self, waves.empty() ? nullptr : &waves[0].origin.x, {waves.size(), 3}, {doubles, 1});
  });
  sources.def_prop_ro("amplitudes", [](nb::handle self) {
    const auto& waves = nb::cast<Sources&>(self).waves;
    return view(self, waves.empty() ? nullptr : &waves[0].amplitude, {waves.size()}, {floats});
  });
  sources.def_prop_ro("phases", [](nb::handle self) {
    const auto& waves = nb::cast<Sources&>(self).waves;
    return view(self, waves.empty() ? nullptr : &waves[0].phase, {waves.size()}, {floats});
  });
  constexpr int64_t foci_doubles = sizeof(SecondFocus) / sizeof(double);
  sources.def_prop_ro("second_foci", [](nb::handle self) {
    const auto& foci = nb::cast<Sources&>(self).second_foci;
    return view(self, foci.empty() ? nullptr : &foci[0].place.x, {foci.size(), 3}, {foci_doubles, 1});
  });
  sources.def_prop_ro("focal_lines", [](nb::handle self) {
    const auto& foci = nb::cast<Sources&>(self).second_foci;
    return view(self, foci.empty() ? nullptr : &foci[0].line.x, {foci.size(), 3}, {foci_doubles, 1});
  });
  sources.def("__len__", [](const Sources& s) { return s.waves.size(); });
  sources.def_ro("wavelength", &Sources::wavelength);
  sources.def_prop_ro("cone_wavelength", [](const Sources& s) { return s.label.cone_wavelength; });
  sources.def_prop_rw(
      "name", [](const Sources& s) { return s.label.name; },
      [](Sources& s, const std::string& name) { s.label.name = name; });
  sources.def_prop_ro("frame", [](const Sources& s) { return s.label.frame; });
  sources.def("set_frame", [](Sources& s, uint32_t frame) { set_frame(s, frame); });
  sources.def("save", [](const Sources& s, const std::string& path) {
    const nb::gil_scoped_release release;
    save_sources(path, s);
  });
  module.def(
      "load_sources",
      [](const std::string& path, nb::handle wavelength) {
        const double given = wavelength.is_none() ? 0 : to_wavelength(wavelength);
        const nb::gil_scoped_release release;
        return load_sources(path, given);
      },
      nb::arg("path"), nb::arg("wavelength").none());
}

}  // namespace holotrace::python
