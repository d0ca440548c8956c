#include "holotrace/io/calibration/panel_file.h"

#include <filesystem>

#include "holotrace/base/error.h"
#include "holotrace/base/units.h"
#include "holotrace/io/files/file.h"
#include "holotrace/io/files/record_names.h"
#include "holotrace/io/picture/image_file.h"

namespace holotrace {
namespace {

std::string beside(const std::string& path, const char* ending) {
  return path.substr(0, path.size() - extension_of(path).size()) + ending;
}
std::string phase_path(const std::string& path) { return beside(path, "_phase.csv"); }
std::string light_path(const std::string& path) { return beside(path, "_light.exr"); }
std::string name_of(const std::string& path) { return std::filesystem::path(path).filename().string(); }

// A text between quotes of TOML.
std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    if (static_cast<unsigned char>(c) >= 0x20) out += c;
  }
  return out + "\"";
}

std::string calibration_text(const std::vector<CalibrationPoint>& points) {
  std::string text = "level,phase_rad,amplitude\n";
  for (size_t level = 0; level < points.size(); ++level)
    text += fmt::format("{},{:.6f},{:.6f}\n", level, points[level].phase, points[level].amplitude);
  return text;
}

std::string panel_text(const std::string& path, const Slm& slm) {
  const SlmEffects& e = slm.effects;
  std::string text;
  if (!slm.name.empty()) text += fmt::format("name = {}\n", quoted(slm.name));
  if (!slm.source.empty()) text += fmt::format("source = {}\n", quoted(slm.source));
  text += fmt::format("columns = {}\nrows = {}\npitch = \"{:.12g} um\"\nlevels = {}\n", slm.grid.nx, slm.grid.ny,
                      slm.grid.pitch * 1e6, slm.levels);
  if (slm.fill_x > 0)
    text += fmt::format("fill_x = {:.12g}\nfill_y = {:.12g}\n", slm.fill_x, slm.fill_y);
  else
    text += fmt::format("fill_factor = {:.12g}\n", slm.fill_factor);
  text += fmt::format("phase_range = \"{:.12g} rad\"\n", slm.phase_range);
  if (slm.design_wavelength > 0)
    text += fmt::format("design_wavelength = \"{:.12g} nm\"\n", slm.design_wavelength * 1e9);
  text += "\n";
  if (!e.calibration.empty()) text += fmt::format("calibration = {}\n", quoted(name_of(phase_path(path))));
  if (e.crosstalk > 0) text += fmt::format("crosstalk = {:.6g}\n", e.crosstalk);
  if (e.gap_amplitude > 0)
    text += fmt::format("gap_amplitude = {:.6g}\ngap_phase = \"{:.6g} rad\"\n", e.gap_amplitude, e.gap_phase);
  if (!e.aberration.empty()) {
    text += "aberration = [\n";
    for (const ZernikeTerm& term : e.aberration)
      text += fmt::format("  {{ n = {}, m = {}, rms = \"{:.6g} rad\" }},\n", term.n, term.m, term.rms);
    text += "]\n";
  }
  if (e.light_map) text += fmt::format("light_map = {}\n", quoted(name_of(light_path(path))));
  return text;
}

}  // namespace

std::vector<std::string> panel_paths(const std::string& path, const Slm& slm) {
  std::vector<std::string> paths{path};
  if (!slm.effects.calibration.empty()) paths.push_back(phase_path(path));
  if (slm.effects.light_map) paths.push_back(light_path(path));
  return paths;
}

void save_panel(const std::string& path, const Slm& slm, const std::function<FileRecord()>& files) {
  require(extension_of(path) == ".toml", "expected a panel file .toml, got {}; change its extension", path);
  check_slm(slm);
  if (!slm.effects.calibration.empty()) write_text(phase_path(path), calibration_text(slm.effects.calibration));
  if (slm.effects.light_map) {
    const Array2D<float>& map = *slm.effects.light_map;
    Image image(map.ny, map.nx, 1);
    image.values.assign(map.values.begin(), map.values.end());
    save_image(light_path(path), image, 1, 16);
  }
  std::string text = panel_text(path, slm);
  if (files) text += "# " + record_line(path, files()) + "\n";
  write_text(path, text);
}

}  // namespace holotrace
