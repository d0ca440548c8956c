// Panels and holograms.

#include <nanobind/stl/map.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/vector.h>

#include <filesystem>

#include "arrays.h"
#include "holotrace/base/message_text.h"
#include "holotrace/data/params/panel_image.h"
#include "holotrace/io/field/hologram_file.h"
#include "holotrace/io/files/output.h"
#include "holotrace/io/picture/panel_image_file.h"
#include "holotrace/io/scene/scene_file.h"
#include "holotrace/io/scene/slm_file.h"
#include "holotrace/slm/encode/panel_images.h"
#include "nouns.h"
#include "params.h"
#include "values.h"
#include "watch.h"

namespace holotrace::python {

ImageSide image_side_of(const std::string& name) {
  if (name == "virtual") return ImageSide::virtual_image;
  if (name == "real") return ImageSide::real_image;
  throw Error(unknown_name_message("image", name, {"virtual", "real"}));
}

std::string name_of(ImageSide side) { return side == ImageSide::real_image ? "real" : "virtual"; }

Modulation modulation_of(const std::string& name) {
  if (name == "phase") return Modulation::phase;
  if (name == "amplitude") return Modulation::amplitude;
  if (name == "complex") return Modulation::complex;
  throw Error(unknown_name_message("modulation", name, {"phase", "amplitude", "complex"}));
}

std::string name_of(Modulation modulation) {
  return modulation == Modulation::phase ? "phase" : modulation == Modulation::amplitude ? "amplitude" : "complex";
}

namespace {

void bind_panel(nb::module_& module) {
  nb::class_<Slm> slm(module, "Slm");
  bind_bytes<Slm>(slm);
  slm.def_static("load", [](const std::string& name) { return load_slm(name); });
  slm.def_static("preset_names", &slm_preset_names);
  slm.def_ro("name", &Slm::name);
  slm.def_prop_ro("columns", [](const Slm& s) { return s.grid.nx; });
  slm.def_prop_ro("rows", [](const Slm& s) { return s.grid.ny; });
  slm.def_prop_ro("pitch", [](const Slm& s) { return s.grid.pitch; });
  slm.def_prop_ro("modulation", [](const Slm& s) { return name_of(s.modulation); });
  slm.def_ro("levels", &Slm::levels);
  slm.def_ro("fill_factor", &Slm::fill_factor);
  slm.def_ro("design_wavelength", &Slm::design_wavelength);
  slm.def_prop_ro("usual_wavelength", [](const Slm& s) { return usual_wavelength(s); });
  slm.def_ro("phase_range", &Slm::phase_range);
  slm.def_ro("source", &Slm::source);
  slm.def_prop_ro("effects", [](const Slm& s) { return effects_of(s); });
  slm.def("with_effects", [](const Slm& s, const std::vector<std::string>& names) { return with_effects(s, names); });
}

Hologram make_hologram(const In2<uint16_t>& level, nb::handle pitch, nb::handle wavelength, int levels,
                       const std::string& modulation) {
  Hologram hologram;
  hologram.level = to_array(level, "the levels of a hologram");
  hologram.grid = {hologram.level.nx, hologram.level.ny, to_length(pitch, "pitch")};
  check_named(hologram.grid.pitch, range::positive, Quantity::length, "pitch");
  hologram.wavelength = to_wavelength(wavelength);
  check_named(levels, range::from_to(2, 65536), Quantity::count, "levels");
  const auto& values = hologram.level.values;
  const auto most = std::max_element(values.begin(), values.end());
  require(*most < levels, "expected levels below {}, got {} at row {}, column {}; give the number of levels", levels,
          *most, (most - values.begin()) / hologram.level.nx, (most - values.begin()) % hologram.level.nx);
  hologram.levels = levels;
  hologram.modulation = modulation_of(modulation);
  require(hologram.modulation != Modulation::complex,
          "expected the modulation phase or amplitude for an array of levels, got complex");
  return hologram;
}

}  // namespace

void bind_holograms(nb::module_& module) {
  bind_panel(module);
  nb::class_<Hologram> hologram(module, "Hologram");
  bind_bytes<Hologram>(hologram);
  hologram.def_static("make", &make_hologram, nb::arg("level"), nb::arg("pitch").none(), nb::arg("wavelength").none(),
                      nb::arg("levels"), nb::arg("modulation"));
  hologram.def_prop_ro("level", [](nb::handle self) { return view(self, nb::cast<Hologram&>(self).level); });
  hologram.def_prop_ro("modulus_level", [](nb::handle self) -> nb::object {
    const Hologram& h = nb::cast<Hologram&>(self);
    return h.modulus_level.size() > 0 ? view(self, h.modulus_level) : nb::none();
  });
  hologram.def_ro("levels", &Hologram::levels);
  hologram.def_prop_ro("modulation", [](const Hologram& h) { return name_of(h.modulation); });
  hologram.def_prop_rw(
      "pitch", [](const Hologram& h) { return h.grid.pitch; },
      [](Hologram& h, nb::handle pitch) { h.grid.pitch = to_length(pitch, "pitch"); });
  hologram.def_prop_rw(
      "wavelength", [](const Hologram& h) { return h.wavelength; },
      [](Hologram& h, nb::handle wavelength) { h.wavelength = to_wavelength(wavelength); });
  hologram.def_prop_ro("wavelengths", [](const Hologram& h) {
    std::vector<double> wavelengths;
    for (const JointColour& colour : h.colours) wavelengths.push_back(colour.wavelength);
    if (wavelengths.empty()) wavelengths.push_back(h.wavelength);
    return wavelengths;
  });
  hologram.def_prop_rw(
      "image", [](const Hologram& h) { return name_of(h.image); },
      [](Hologram& h, const std::string& name) { h.image = image_side_of(name); });
  hologram.def_ro("encoder", &Hologram::encoder);
  hologram.def_rw("illumination", &Hologram::illumination);
  hologram.def_prop_rw(
      "name", [](const Hologram& h) { return h.label.name; },
      [](Hologram& h, const std::string& name) { h.label.name = name; });
  hologram.def_prop_ro("frame", [](const Hologram& h) { return h.label.frame; });
  hologram.def_prop_ro("distances", [](const Hologram& h) { return h.viewing.distances; });
  hologram.def_ro("effects", &Hologram::effects);
  hologram.def_prop_rw(
      "slm", [](const Hologram& h) { return h.slm; }, [](Hologram& h, const std::optional<Slm>& slm) { h.slm = slm; },
      nb::arg("slm").none());
  hologram.def("save", [](const Hologram& h, const std::string& path) {
    const nb::gil_scoped_release release;
    save_hologram(path, h);
  });
  module.def("load_hologram", [](const std::string& path, const nb::dict& given) {
    const auto complete = [&](HologramParams& params) {
      const nb::gil_scoped_acquire acquire;
      set_params(given, params);
    };
    const nb::gil_scoped_release release;
    return load_hologram(path, complete);
  });
  // Paths of the files, with a record of what the texts in `done` say.
  module.def("save_panel_images", [](const std::vector<Hologram>& holograms, const std::string& path,
                                     const nb::dict& given, const std::string& lut, const std::string& correction,
                                     const std::map<std::string, std::string>& done, Watch& watch) {
    PanelImageParams params;
    set_params(given, params);
    return watch.run("panel images", [&](const Observer& observer) {
      check_output(path, panel_image_endings());
      const int levels = holograms.empty() ? 0 : holograms.front().levels;
      const std::vector<PanelImage> images =
          panel_images(holograms, params, load_panel_tables(lut, correction, levels), value_in(path), observer);
      const std::string name = std::filesystem::path(path).filename().string();
      for (const std::string& sentence : write_together(
               path, hologram_record(path), [&](const OutputSet& set) { save_panel_images(set, name, images, done); }))
        observer.warn(sentence);
      std::vector<std::string> paths;
      for (size_t i = 0; i < images.size(); ++i) paths.push_back(numbered_path(path, i));
      return paths;
    });
  });
}

}  // namespace holotrace::python
