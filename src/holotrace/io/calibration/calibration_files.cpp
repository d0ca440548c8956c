#include "holotrace/io/calibration/calibration_files.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>

#include "holotrace/base/error.h"
#include "holotrace/base/units.h"
#include "holotrace/io/field/hologram_file.h"
#include "holotrace/io/files/file.h"
#include "holotrace/io/files/output.h"
#include "holotrace/io/files/output_set.h"
#include "holotrace/io/picture/image_file.h"
#include "holotrace/io/scene/toml_table.h"

namespace holotrace {
namespace {

namespace fs = std::filesystem;

struct KindName {
  PatternKind kind;
  const char* name;
};
constexpr KindName kinds[] = {
    {PatternKind::spots, "spots"}, {PatternKind::levels, "levels"}, {PatternKind::focus, "focus"}};
constexpr const char* extensions[] = {".png", ".tif", ".tiff", ".jpg", ".jpeg", ".exr"};

const char* name_of(PatternKind kind) {
  return std::find_if(std::begin(kinds), std::end(kinds), [&](const KindName& k) { return k.kind == kind; })->name;
}

toml::table parse(const std::string& path) { return parse_toml(path, "the plan of a calibration, calibration.toml"); }

std::string photograph_path(const std::string& folder, const std::string& name) {
  for (const char* extension : extensions) {
    const fs::path path = fs::path(folder) / (name + extension);
    if (is_file(path)) return path.string();
  }
  return "";
}

// Patterns that an earlier plan in the folder lists, with their sidecars.
FileRecord earlier_patterns(const std::string& folder) {
  std::error_code ignored;
  FileRecord found;
  if (!is_there(plan_path(folder))) return found;
  const toml::table table = parse(plan_path(folder));
  const toml::array* patterns = table["pattern"].as_array();
  if (!patterns) return found;
  for (const toml::node& item : *patterns) {
    const auto file = item.as_table() ? (*item.as_table())["file"].value<std::string>() : std::nullopt;
    if (!file || fs::path(*file).has_parent_path() || fs::path(*file).extension() != ".png") continue;
    const std::string path = (fs::path(folder) / *file).string();
    if (!is_hologram_file(path)) continue;  // a photograph may have been put in its place
    for (const fs::path one : {path, sidecar_path(path), old_sidecar_path(path)})
      if (is_file(one)) found.emplace(one.filename().string(), fs::file_size(one, ignored));
  }
  return found;
}

}  // namespace

std::string plan_path(const std::string& folder) { return (fs::path(folder) / "calibration.toml").string(); }

std::vector<std::string> save_plan(const std::string& folder, const CalibrationPlan& plan) {
  make_folder(folder);
  std::string text =
      "# Test patterns of a calibration. Show each on the panel and photograph it as NAME.png, .tif, .jpg or .exr\n"
      "# with a sensor without a lens at this distance from the panel; camera and exposure stay as they are.\n";
  text += fmt::format("distance = \"{:.12g} mm\"\n", plan.distance * 1e3);
  for (const TestPattern& pattern : plan.patterns)
    text += fmt::format("\n[[pattern]]\nfile = \"{}.png\"\nkind = \"{}\"\n", pattern.name, name_of(pattern.kind));
  const std::string path = plan_path(folder);
  return write_together(path, earlier_patterns(folder), [&](const OutputSet& set) {
    for (const TestPattern& pattern : plan.patterns) save_hologram(set.path(pattern.name + ".png"), pattern.hologram);
    write_text(set.path(fs::path(path).filename().string()), text);
  });
}

CalibrationPlan load_plan(const std::string& path) {
  const toml::table parsed = parse(path);
  TomlTable table(parsed, {path}, "the plan");
  CalibrationPlan plan;
  table.require_key("distance");
  table.length("distance", plan.distance, range::positive);
  for (TomlTable& item : table.tables("pattern")) {
    TestPattern pattern;
    std::string file;
    item.require_key("file");
    item.require_key("kind");
    item.text("file", file);
    item.choice("kind", pattern.kind,
                {{"spots", PatternKind::spots}, {"levels", PatternKind::levels}, {"focus", PatternKind::focus}});
    item.refuse_unknown_keys();
    pattern.name = fs::path(file).stem().string();
    item.locate("file", [&] { pattern.hologram = load_hologram(item.beside("file", file)); });
    plan.patterns.push_back(std::move(pattern));
  }
  table.refuse_unknown_keys();
  require(!plan.patterns.empty(),
          "{}: expected a plan with a table [[pattern]] per test pattern, got none; write it with "
          "`holotrace calibrate patterns`",
          path);
  return plan;
}

std::vector<Image> load_photographs(const std::string& folder, const CalibrationPlan& plan) {
  require(is_folder(folder), "expected a folder with the photographs, got {}, which is none", folder);
  std::vector<std::string> paths, missing;
  for (const TestPattern& pattern : plan.patterns) {
    paths.push_back(photograph_path(folder, pattern.name));
    if (paths.back().empty()) missing.push_back(pattern.name);
  }
  require(
      missing.empty(),
      "expected a photograph of each pattern in {}, got none of {}; name it as its pattern, with .png, .tif, .jpg or "
      ".exr",
      folder, fmt::join(missing, ", "));
  std::vector<Image> photographs;
  for (const std::string& path : paths) photographs.push_back(load_image(path));
  return photographs;
}

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
