#include "holotrace/io/scene/slm_file.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <optional>
#include <string_view>

#include "holotrace/base/error.h"
#include "holotrace/base/message_text.h"
#include "holotrace/base/units.h"
#include "holotrace/io/files/file.h"
#include "holotrace/io/files/shipped_files.h"
#include "holotrace/io/files/text.h"
#include "holotrace/io/picture/image_file.h"
#include "holotrace/io/scene/toml_table.h"

namespace holotrace {
namespace {

namespace fs = std::filesystem;

// Converts a calibration of L levels to M levels: level ℓ of M is level ℓ·L/M of L, by linear interpolation.
std::vector<CalibrationPoint> with_levels(const std::vector<CalibrationPoint>& points, int levels) {
  if (points.empty() || points.size() == size_t(levels)) return points;
  std::vector<CalibrationPoint> out;
  for (int level = 0; level < levels; ++level)
    out.push_back(calibration_at(points, double(level) * double(points.size()) / levels));
  return out;
}

std::vector<ZernikeTerm> read_aberration(TomlTable& table) {
  std::vector<ZernikeTerm> terms;
  const toml::node* node = table.find("aberration");
  const char* expected = "a list of terms [{ n = 2, m = 0, rms = \"0.3 rad\" }, …]";
  if (!node->is_array()) table.fail_kind("aberration", expected, *node);
  for (const toml::node& item : *node->as_array()) {
    const toml::table* term = item.as_table();
    if (!term) table.fail_kind("aberration", expected, item);
    for (auto&& [key, value] : *term)
      if (key != "n" && key != "m" && key != "rms")
        throw Error(table.place(key.source()) + unknown_name_message("key", std::string(key.str()), {"n", "m", "rms"}));
    const auto n = (*term)["n"].value_exact<int64_t>(), m = (*term)["m"].value_exact<int64_t>();
    const auto rms = (*term)["rms"].value_exact<std::string>();
    if (!n || !m || !rms) table.fail_kind("aberration", expected, item);
    double radians = 0;
    try {
      radians = parse_angle(*rms);
    } catch (const Error& e) {
      throw Error(table.place(item.source()) + e.what());
    }
    const auto in_int = [](int64_t value) { return int(std::clamp<int64_t>(value, -1000, 1000)); };
    terms.push_back({in_int(*n), in_int(*m), radians});
  }
  return terms;
}

std::vector<DeadPixel> read_dead_pixels(TomlTable& table) {
  std::vector<DeadPixel> pixels;
  const toml::node* node = table.find("dead_pixels");
  const char* expected = "a list of pixels [[column, row, level], …]";
  if (!node->is_array()) table.fail_kind("dead_pixels", expected, *node);
  for (const toml::node& item : *node->as_array()) {
    const toml::array* numbers = item.as_array();
    if (!numbers || numbers->size() != 3) table.fail_kind("dead_pixels", expected, item);
    int values[3] = {};
    for (size_t i = 0; i < 3; ++i) {
      const auto value = numbers->get(i)->value_exact<int64_t>();
      if (!value) table.fail_kind("dead_pixels", expected, item);
      values[i] = int(std::clamp<int64_t>(*value, -1, 1 << 30));
    }
    pixels.push_back({values[0], values[1], values[2]});
  }
  return pixels;
}

// Delays of L levels as those of M levels, as with_levels does.
std::vector<double> delays_with_levels(const std::vector<double>& delays, int levels) {
  std::vector<CalibrationPoint> points;
  for (const double delay : delays) points.push_back({delay, 1});
  std::vector<double> out;
  for (const CalibrationPoint& point : with_levels(points, levels)) out.push_back(point.phase);
  return out;
}

// An axis "45 deg", or "none".
void read_axis(TomlTable& table, const char* key, std::optional<double>& axis) {
  if (!table.has(key)) return;
  double angle = 0;
  const bool is_none = table.find(key)->value_exact<std::string>() == "none";
  if (!is_none) table.angle(key, angle, range::any);
  axis = is_none ? std::nullopt : std::optional(angle);
}

void read_plates(TomlTable& table, const char* key, std::vector<WavePlate>& plates) {
  if (!table.has(key)) return;
  const toml::node* node = table.find(key);
  const char* expected = "a list of wave plates [{ axis = \"45 deg\", delay = \"90 deg\" }, …]";
  if (!node->is_array()) table.fail_kind(key, expected, *node);
  plates.clear();
  for (const toml::node& item : *node->as_array()) {
    const toml::table* plate = item.as_table();
    if (!plate) table.fail_kind(key, expected, item);
    for (auto&& [name, value] : *plate)
      if (name != "axis" && name != "delay")
        throw Error(table.place(name.source()) +
                    unknown_name_message("key", std::string(name.str()), {"axis", "delay"}));
    const auto axis = (*plate)["axis"].value_exact<std::string>(), delay = (*plate)["delay"].value_exact<std::string>();
    if (!axis || !delay) table.fail_kind(key, expected, item);
    try {
      plates.push_back({parse_angle(*axis), parse_angle(*delay)});
    } catch (const Error& e) {
      throw Error(table.place(item.source()) + e.what());
    }
  }
}

void read_delays(TomlTable& table, int levels, std::vector<double>& delays) {
  std::string file;
  double first = 0, last = 0;
  table.text("delays", file);
  table.angle("first_delay", first, range::any);
  table.angle("last_delay", last, range::any);
  const bool has_ends = table.has("first_delay") || table.has("last_delay");
  require(file.empty() || !has_ends, "{}expected either \"delays\", or \"first_delay\" and \"last_delay\", got both",
          table.where("delays"));
  if (!file.empty()) table.locate("delays", [&] { delays = load_delays(table.beside("delays", file), levels); });
  if (!has_ends) return;
  require(table.has("last_delay"),
          "{}expected \"last_delay\", the delay that the level {} would have, beside \"first_delay\"",
          table.where("first_delay"), levels);
  delays.clear();
  for (int level = 0; level < levels; ++level) delays.push_back(first + (last - first) * level / levels);
}

// Reads the crystal, the polarisers and the wave plates, over those of the preset.
void read_crystal(TomlTable& table, Slm& slm, bool has_new_levels) {
  const bool is_here = table.has("crystal") || table.has("polariser") || table.has("analyser") ||
                       table.has("plates_before") || table.has("plates_behind");
  std::optional<Crystal>& known = slm.effects.crystal;
  if (!is_here && !known) return;
  Crystal crystal = known.value_or(Crystal());
  const bool is_along_director = !known || crystal.polariser == crystal.director;
  if (has_new_levels) crystal.delays = delays_with_levels(crystal.delays, slm.levels);
  if (std::optional<TomlTable> own = table.table("crystal", "twist = \"45 deg\"")) {
    own->choice("kind", crystal.pass, crystal_pass_names);
    own->angle("director", crystal.director, range::any);
    own->angle("twist", crystal.twist, range::any);
    read_delays(*own, slm.levels, crystal.delays);
    own->refuse_unknown_keys();
  }
  if (is_along_director) crystal.polariser = crystal.director;
  read_axis(table, "polariser", crystal.polariser);
  read_axis(table, "analyser", crystal.analyser);
  read_plates(table, "plates_before", crystal.plates_before);
  read_plates(table, "plates_behind", crystal.plates_behind);
  known = crystal;
}

// The numbers in an image times `range`.
std::shared_ptr<const Array2D<float>> load_map(const std::string& path, double range) {
  const Image image = load_image(path, ImageContent::data);
  auto map = std::make_shared<Array2D<float>>(image.ny, image.nx);
  for (int j = 0; j < image.ny; ++j)
    for (int i = 0; i < image.nx; ++i) (*map)(j, i) = float(range * double(image(j, i, 0)));
  return map;
}

// Reads the effects that the table itself defines, over those of the preset.
void read_effects(TomlTable& table, Slm& slm, bool has_new_levels) {
  SlmEffects& effects = slm.effects;
  const auto has_any = [&](std::initializer_list<const char*> keys) {
    return std::any_of(keys.begin(), keys.end(), [&](const char* key) { return table.has(key); });
  };
  std::string calibration, map, light;
  double map_range = 2 * pi;
  table.text("calibration", calibration);
  if (!calibration.empty())
    table.locate("calibration",
                 [&] { effects.calibration = load_calibration(table.beside("calibration", calibration), slm.levels); });
  else if (has_new_levels)
    effects.calibration = with_levels(effects.calibration, slm.levels);
  table.number("crosstalk", effects.crosstalk, range::from_to(0, 8));
  table.number("gap_amplitude", effects.gap_amplitude, range::fraction);
  table.angle("gap_phase", effects.gap_phase, range::any);
  table.number("flicker", effects.flicker, range::below(0, 1));
  if (table.has("aberration")) effects.aberration = read_aberration(table);
  table.text("phase_map", map);
  table.angle("phase_map_range", map_range, range::any);
  if (!map.empty())
    table.locate("phase_map", [&] { effects.phase_map = load_map(table.beside("phase_map", map), map_range); });
  table.text("light_map", light);
  if (!light.empty())
    table.locate("light_map", [&] { effects.light_map = load_map(table.beside("light_map", light), 1); });
  table.number("dead_fraction", effects.dead_fraction, range::fraction);
  table.count("dead_seed", effects.dead_seed, range::not_negative);
  if (table.has("dead_pixels")) effects.dead_pixels = read_dead_pixels(table);

  read_crystal(table, slm, has_new_levels);

  std::vector<std::string>& own = slm.own_effects;
  const auto add_if = [&](bool is_here, const char* name) {
    if (is_here && std::find(own.begin(), own.end(), name) == own.end()) own.push_back(name);
  };
  add_if(has_any({"calibration"}), "calibration");
  add_if(has_any({"crosstalk"}), "crosstalk");
  add_if(has_any({"gap_amplitude", "gap_phase"}), "gaps");
  add_if(has_any({"flicker"}), "flicker");
  add_if(has_any({"aberration"}), "aberration");
  add_if(has_any({"phase_map", "phase_map_range"}), "phase-map");
  add_if(has_any({"light_map"}), "light-map");
  add_if(has_any({"dead_fraction", "dead_seed", "dead_pixels"}), "dead-pixels");
  add_if(has_any({"crystal", "polariser", "analyser", "plates_before", "plates_behind"}), "crystal");
  const std::vector<std::string> on = effects_of(slm);  // a value of 0 turns an effect off
  std::erase_if(own, [&](const std::string& name) { return std::find(on.begin(), on.end(), name) == on.end(); });
}

std::string environment(const char* name) {
  const char* value = std::getenv(name);
  return value ? value : "";
}

// The folders for panels of the user's, present or not.
std::vector<std::string> user_panel_folders() {
  std::vector<std::string> folders;
  const std::string own = environment("HOLOTRACE_PANELS"), settings = environment("XDG_CONFIG_HOME"),
                    home = environment("HOME");
  if (!own.empty()) folders.push_back(own);
  if (!settings.empty())
    folders.push_back(fs::path(settings) / "holotrace" / "panels");
  else if (!home.empty())
    folders.push_back(fs::path(home) / ".config" / "holotrace" / "panels");
  return folders;
}

std::vector<std::string> words_of(const std::string& text) {
  std::vector<std::string> words(1);
  for (const char c : text)
    if (std::isalnum(static_cast<unsigned char>(c)))
      words.back() += char(std::tolower(static_cast<unsigned char>(c)));
    else if (!words.back().empty())
      words.emplace_back();
  if (words.back().empty()) words.pop_back();
  return words;
}

// The panels whose names or files, which name the maker, have all the words of a name such as "HOLOEYE pluto".
std::vector<std::string> panels_with_words_of(const std::string& name, const std::vector<KnownPanel>& known) {
  const std::vector<std::string> wanted = words_of(name);
  std::vector<std::string> found;
  for (const KnownPanel& panel : known) {
    const std::vector<std::string> own = words_of(panel.name + " " + read_text(panel.file, most_text));
    const auto has = [&](const std::string& word) {
      return std::any_of(own.begin(), own.end(), [&](const std::string& one) { return one.starts_with(word); });
    };
    if (!wanted.empty() && std::all_of(wanted.begin(), wanted.end(), has)) found.push_back(panel.name);
  }
  return found;
}

// The panel of that name. A type without its maker, "x13138", suggests the panel whose name ends with it.
KnownPanel panel_named(const std::string& name) {
  const std::vector<KnownPanel> known = known_panels();
  const auto has_name = [&](const KnownPanel& panel) { return panel.name == name; };
  const auto found = std::find_if(known.begin(), known.end(), has_name);
  if (found != known.end()) return *found;
  const std::string file = name + ".toml";
  require(!holotrace::is_file(file), "unknown SLM \"{}\"; did you mean the panel file \"{}\"?", name, file);
  std::vector<std::string> names;
  for (const KnownPanel& panel : known) names.push_back(panel.name);
  const auto has_type = [&](const std::string& one) { return !name.empty() && one.ends_with("-" + name); };
  const auto of_type = std::find_if(names.begin(), names.end(), has_type);
  std::string nearest = of_type != names.end() ? *of_type : nearest_name(name, names);
  if (const auto likely = panels_with_words_of(name, known); nearest.empty() && !likely.empty())
    nearest = fmt::format(
        "{}", fmt::join(likely.begin(), likely.begin() + std::min<ptrdiff_t>(4, std::ssize(likely)), "\" or \""));
  if (nearest.empty()) fail("unknown SLM \"{}\"; \"holotrace info --slm\" lists those that are known", name);
  fail("unknown SLM \"{}\"; did you mean \"{}\"? \"holotrace info --slm\" lists all", name, nearest);
}

Slm read_over(TomlTable table, const std::string& preset, const std::vector<std::string>& chain);

// The file of a panel that comes with the program; "" if there is none.
std::string built_in_file(const std::string& name) {
  for (const std::string& folder : shipped_folders("panels"))
    if (const fs::path file = fs::path(folder) / (name + ".toml"); holotrace::is_file(file)) return file.string();
  return "";
}

// Loads a panel by name, or from a file NAME.toml. `chain` has the files that led here, each of which extends the next. A user's
// panel may extend the one that comes with the program under its name.
Slm load_panel(const std::string& name, std::vector<std::string> chain) {
  const bool is_file = extension_of(name) == ".toml";
  KnownPanel panel = is_file ? KnownPanel{name, name, true} : panel_named(name);
  const auto is_same = [&](const std::string& other) {
    std::error_code ignored;
    return fs::equivalent(other, panel.file, ignored);
  };
  if (!is_file && panel.is_users && !chain.empty() && is_same(chain.back()))
    if (const std::string built_in = built_in_file(name); !built_in.empty()) panel = {name, built_in, false};
  require(std::none_of(chain.begin(), chain.end(), is_same), "expected a panel that does not extend itself, got \"{}\"",
          name);
  chain.push_back(panel.file);
  const toml::table parsed = parse_toml(panel.file, "a panel file");
  Slm slm = read_over(TomlTable(parsed, {panel.file}, "the panel"), "", chain);
  if (!parsed.contains("name")) slm.name = is_file ? fs::path(name).stem().string() : name;
  slm.preset = name;
  if (!panel.is_users) slm.own_effects.clear();
  return slm;
}

// The levels of a panel whose file gives their bits, as data sheets do.
void read_bits(TomlTable& table, int& levels) {
  if (!table.has("bits")) return;
  require(!table.has("levels"), "{}expected either \"bits\" or \"levels\", got both", table.where("bits"));
  int bits = 0;
  table.count("bits", bits, range::from_to(1, 16));
  levels = 1 << bits;
}

// The pitch of a panel whose file gives it along both axes.
void read_pitch_of_axes(TomlTable& table, double& pitch) {
  double x = 0, y = 0;
  table.length("pitch_x", x, range::positive);
  table.length("pitch_y", y, range::positive);
  require((x > 0) == (y > 0), "{}expected pitch_x and pitch_y together, got one of them; give both, or \"pitch\"",
          table.where(x > 0 ? "pitch_x" : "pitch_y"));
  if (x == 0) return;
  require(!table.has("pitch"), "{}expected either \"pitch\", or \"pitch_x\" and \"pitch_y\", got all of them",
          table.where("pitch"));
  require(x == y,
          "{}expected square pixels, got {} in x and {} in y; pixels of two pitches are not supported: compute the "
          "hologram at the smaller pitch, and resample its field to the panel's pixels before you encode it",
          table.where("pitch_x"), format_length(x), format_length(y));
  pitch = x;
}

Slm read_over(TomlTable table, const std::string& preset, const std::vector<std::string>& chain) {
  std::string base = preset;
  table.text("preset", base);
  if (extension_of(base) == ".toml") base = fs::path(table.beside("preset", base)).lexically_normal().string();
  Slm slm;
  if (!base.empty()) table.locate("preset", [&] { slm = load_panel(base, chain); });
  for (const char* key : {"columns", "rows", "pitch"})
    if (base.empty() && !(std::string_view(key) == "pitch" && table.has("pitch_x"))) table.require_key(key);
  const Slm standard = slm;
  table.count("columns", slm.grid.nx, range::at_least(1));
  table.count("rows", slm.grid.ny, range::at_least(1));
  table.length("pitch", slm.grid.pitch, range::positive);
  read_pitch_of_axes(table, slm.grid.pitch);
  table.count("levels", slm.levels, range::from_to(2, 65536));
  read_bits(table, slm.levels);
  table.number("fill_factor", slm.fill_factor, range::above_to(0, 1));
  if (table.has("fill_factor")) slm.fill_x = slm.fill_y = 0;
  table.number("fill_x", slm.fill_x, range::above_to(0, 1));
  table.number("fill_y", slm.fill_y, range::above_to(0, 1));
  if (table.has("fill_x") || table.has("fill_y")) slm.fill_factor = slm.fill_x * slm.fill_y;
  table.choice("modulation", slm.modulation,
               {{"phase", Modulation::phase}, {"amplitude", Modulation::amplitude}, {"complex", Modulation::complex}});
  table.length("design_wavelength", slm.design_wavelength, range::not_negative, Quantity::wavelength);
  table.angle("phase_range", slm.phase_range, range::positive);
  if (!(slm.grid == standard.grid)) slm.name = "custom";
  table.text("name", slm.name);
  table.text("source", slm.source);
  read_effects(table, slm, slm.levels != standard.levels);
  table.refuse_unknown_keys();
  table.locate("", [&] { check_slm(slm); });
  return slm;
}

}  // namespace

std::vector<std::string> panel_folders() {
  std::vector<std::string> folders;
  for (const std::string& folder : user_panel_folders())
    if (is_folder(folder)) folders.push_back(folder);
  for (const std::string& folder : shipped_folders("panels")) folders.push_back(folder);
  return folders;
}

std::vector<KnownPanel> known_panels() {
  const std::vector<std::string> of_user = user_panel_folders();
  std::map<std::string, KnownPanel> panels;  // in alphabetical order; the first file of a name stays
  for (const std::string& folder : panel_folders()) {
    const bool is_users = std::find(of_user.begin(), of_user.end(), folder) != of_user.end();
    std::error_code ignored;
    for (const auto& entry : fs::directory_iterator(folder, ignored)) {
      const std::string name = entry.path().stem().string();
      if (entry.path().extension() == ".toml" && is_file(entry.path()))
        panels.try_emplace(name, KnownPanel{name, entry.path().string(), is_users});
    }
  }
  std::vector<KnownPanel> list;
  for (const auto& [name, panel] : panels) list.push_back(panel);
  return list;
}

std::vector<std::string> slm_preset_names() {
  std::vector<std::string> names;
  for (const KnownPanel& panel : known_panels()) names.push_back(panel.name);
  return names;
}

Slm slm_preset(const std::string& name) { return load_panel(name, {}); }

Slm read_slm(TomlTable table, const std::string& preset) { return read_over(std::move(table), preset, {}); }

}  // namespace holotrace
