#include "holotrace/io/scene/scene_file.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <map>
#include <optional>
#include <string>

#include "holotrace/base/error.h"
#include "holotrace/base/message_text.h"
#include "holotrace/base/units.h"
#include "holotrace/data/job.h"
#include "holotrace/data/params/parameter_texts.h"
#include "holotrace/data/params/renamed.h"
#include "holotrace/data/path_expression.h"
#include "holotrace/io/files/file.h"
#include "holotrace/io/files/file_kind.h"
#include "holotrace/io/files/series.h"
#include "holotrace/io/scene/eye_track_file.h"
#include "holotrace/io/scene/model_job.h"
#include "holotrace/io/scene/scene_lights.h"
#include "holotrace/io/scene/scene_materials.h"
#include "holotrace/io/scene/scene_media.h"
#include "holotrace/io/scene/scene_objects.h"
#include "holotrace/io/scene/scene_tables.h"
#include "holotrace/io/scene/slm_file.h"
#include "holotrace/io/scene/toml_table.h"

namespace holotrace {
namespace {

/// Reads the table `section` of `parent`, if it is there, into a parameter set, whose `describe` in
/// data/params/ lists every key once.
/// @throws Error with file:line:column for values of another kind and for unknown keys
template <class Params>
void read_params(TomlTable& parent, const char* section, Params& params) {
  if (auto table = parent.table(section)) {
    describe(*table, params);
    table->refuse_unknown_keys();
  }
}

// Reports path expressions that cannot be read, each with its own position in the list.
void check_path_expressions(TomlTable& root, const char* section, const std::vector<std::string>& expressions) {
  const auto table = root.table(section);
  if (!table || expressions.empty()) return;
  const toml::array* list = table->toml().get("path_expressions")->as_array();
  for (size_t i = 0; i < expressions.size(); ++i) try {
      const PathAutomaton alone({expressions[i]});
    } catch (const Error& e) {
      throw Error((list ? table->place(list->get(i)->source()) : table->where("path_expressions")) + e.what());
    }
  table->locate("path_expressions", [&] { const PathAutomaton together(expressions); });
}

std::vector<double> read_wavelengths(TomlTable& root) {
  if (!root.has("wavelength")) return {};  // the scene's colours say which
  std::vector<double> wavelengths;
  root.lengths("wavelength", wavelengths, range::positive, Quantity::wavelength);
  for (const double wavelength : wavelengths)
    require(std::count(wavelengths.begin(), wavelengths.end(), wavelength) == 1,
            "{}expected each wavelength once, got {} twice", root.where("wavelength"), format_length(wavelength));
  return wavelengths;
}

// The time at which the scene is read: the one that is asked for, or that of the file.
void choose_time(TomlTable& root, std::optional<double> asked) {
  const auto time = std::make_shared<SceneTime>();
  root.instant("time", time->now, range::any);
  if (asked) time->now = *asked;
  root.read_at(time);
}

Shutter read_shutter(TomlTable& root) {
  const toml::node* node = root.find("shutter");
  if (!node) return {};
  const auto seconds = root.arrays() ? to_number(*node) : std::nullopt;  // tables in memory have numbers in SI units
  const auto text = seconds ? fmt::format("{:.17g} s", *seconds) : node->value<std::string>();
  if (!text) root.fail_kind("shutter", "a time or an angle with its unit, such as \"20 ms\" or \"180 deg\",", *node);
  Shutter shutter;
  root.locate("shutter", [&] { shutter = parse_shutter(*text); });
  return shutter;
}

// Whether light has polarization, and the polariser before the viewer.
void read_polarization(TomlTable& root, Scene& scene) {
  bool is_polarized = false;
  root.flag("polarization", is_polarized);
  if (is_polarized) scene.analyser = all_light;
  if (!root.has("analyser")) return;
  const auto name = root.find("analyser")->value_exact<std::string>();
  if (name == "none") return;
  double angle = 0;
  if (name == "left")
    scene.analyser = left_polariser;
  else if (name == "right")
    scene.analyser = right_polariser;
  else {
    if (name && name->find_first_of("0123456789") == std::string::npos)
      fail("{}expected an angle such as \"30 deg\", or left, right or none, for the analyser, got \"{}\"",
           root.where("analyser"), printable(*name, 80));
    root.angle("analyser", angle, range::any);
    scene.analyser = linear_polariser(angle);
  }
}

Job read_job(TomlTable& root, const std::string& path, Outside outside, std::optional<double> time) {
  Job job;
  job.shutter = read_shutter(root);
  choose_time(root, time);
  for (const char* section :
       {"slm",        "materials",    "media",        "light",    "environment", "object", "shape",
        "background", "reflectances", "polarization", "analyser", "trace",       "render", "synthesize",
        "encode",     "show",         "propagate",    "camera",   "animate",     "eye"})
    root.know(section);
  root.know("wavelength");
  root.refuse_unknown_keys();

  job.wavelengths = read_wavelengths(root);
  root.colour("background", job.scene.background, std::numeric_limits<double>::infinity());
  root.choice("reflectances", job.scene.reflectances,
              {{"linear", Reflectances::linear}, {"smooth", Reflectances::smooth}});
  read_polarization(root, job.scene);
  auto slm = root.table("slm", "preset = \"pluto\"");
  if (slm) slm->read_at(nullptr);  // a panel stays as it is
  job.slm = slm ? read_slm(*slm, "pluto") : slm_preset("pluto");
  if (!job.slm.own_effects.empty())
    job.slm.preset = path;  // a panel with effects of its own is read from this file again

  SceneObjects objects(job, outside);
  std::vector<std::string> names;
  const auto media = read_media(root, job.scene);
  const auto materials = root.named_tables("materials", names);
  for (size_t i = 0; i < materials.size(); ++i) objects.add_material(names[i], read_material(materials[i], media));
  open_media(root, job.scene);
  for (const TomlTable& light : root.tables("light")) job.scene.lights.push_back(read_light(light));
  if (const auto environment = root.table("environment")) job.scene.environment = read_environment(*environment);
  if (auto shapes = root.table("shape")) objects.add_shapes(*shapes);
  for (const TomlTable& object : root.tables("object")) objects.add_object(object);
  objects.check_unused_shapes();

  if (job.wavelengths.empty()) choose_wavelengths(job);

  read_params(root, "trace", job.trace);
  read_params(root, "render", job.render);
  read_params(root, "synthesize", job.synthesize);
  read_params(root, "encode", job.encode);
  read_params(root, "show", job.show);
  read_params(root, "propagate", job.propagate);
  read_params(root, "camera", job.camera);
  if (auto animate = root.table("animate")) {
    animate->read_at(nullptr);
    describe(*animate, job.animate);
    animate->refuse_unknown_keys();
  }
  if (auto eye = root.table("eye")) {
    eye->read_at(nullptr);
    describe(*eye, job.eye);
    eye->refuse_unknown_keys();
  }
  const auto camera = root.table("camera");
  job.are_distances_given = camera && camera->has("distances");
  check_path_expressions(root, "trace", job.trace.path_expressions);
  check_path_expressions(root, "render", job.render.path_expressions);
  root.locate("", [&] { check_scene(job.scene); });
  if (!has_light(job.scene)) job.warnings.emplace_back(no_light);
  job.time = root.time()->now;
  job.last_key = root.time()->last;
  objects.warn_of_models_beside_the_view();
  if (const auto eye = root.table("eye")) eye->locate("track", [&] { follow_eye_track(job); });
  return job;
}

// Renames keys that have their old names, with a warning for each.
void rename_keys(toml::table& scene, const std::string& path, std::vector<std::string>& warnings) {
  for (const RenamedParameter& one : renamed_parameters) {
    toml::table* section = scene[one.section].as_table();
    toml::node* value = section ? section->get(one.before) : nullptr;
    if (!value) continue;
    const auto at = value->source().begin;
    const std::string place = fmt::format("{}:{}:{}: ", path, at.line, at.column);
    require(!section->contains(one.now),
            "{}expected one of `{}` and its old name `{}`, got both; leave out the old one", place, one.now,
            one.before);
    warnings.push_back(place + renamed_message(one.before, one.now));
    section->insert(one.now, std::move(*value));  // moved, not copied: a node keeps its position in its file
    section->erase(one.before);
  }
}

// Puts the keys of `over` into `base`: tables key by key; everything else is replaced as a whole (lists of tables, and
// tables with the key `type`, such as another kind of material, and keys over time).
void overrule(toml::table& base, toml::table&& over) {
  for (auto&& [key, node] : over) {
    toml::node* present = base.get(key);
    const auto is_merged = [](const toml::node& one) {
      return one.is_table() && !one.as_table()->contains("type") && !is_over_time(*one.as_table());
    };
    if (present && present->is_table() && is_merged(node)) {
      overrule(*present->as_table(), std::move(*node.as_table()));
      continue;
    }
    base.erase(key);
    base.insert(key, std::move(node));  // moved, not copied: a node keeps its position in its file
  }
}

// The tables of a scene file merged over those of the file that it extends, the names of all files, and warnings.
toml::table read_scene(const std::string& path, std::vector<std::string>& files, std::vector<std::string>& warnings) {
  constexpr size_t most_files = 16;
  toml::table scene = parse_toml(path, "a scene or panel file");
  rename_keys(scene, path, warnings);
  files.push_back(path);
  if (!scene.contains("extends")) return scene;
  TomlTable root(scene, files, "the scene file");
  std::string name;
  root.text("extends", name);
  const std::string extended = root.beside("extends", name);
  root.locate("extends", [&] { check_file_exists(extended, "a scene file"); });
  const auto is_same = [&](const std::string& file) {
    std::error_code ignored;
    return std::filesystem::equivalent(file, extended, ignored);
  };
  require(std::none_of(files.begin(), files.end(), is_same),
          "{}expected a scene that does not extend itself, but \"{}\" is being read", root.where("extends"), extended);
  require(files.size() < most_files, "{}expected at most {} scenes that extend each other, got more",
          root.where("extends"), most_files);
  toml::table base = read_scene(extended, files, warnings);
  scene.erase("extends");
  overrule(base, std::move(scene));
  return base;
}

// The size of a panel is a key of a panel file; in a scene it is below [slm].
bool has_keys_of_panel(const toml::table& parsed) {
  return parsed.contains("columns") && parsed.contains("rows") && !parsed.contains("slm") &&
         !parsed.contains("wavelength") && !parsed.contains("object");
}

// The parameters of a model with values of their names.
ModelParams edited(ModelParams model, const std::vector<SceneEdit>& edits) {
  std::map<std::string, std::string> texts;
  std::vector<std::string> known;
  describe([&](const auto& parameter) { known.emplace_back(parameter.name); }, model);
  for (const SceneEdit& edit : edits) {
    if (std::find(known.begin(), known.end(), edit.key) == known.end())
      throw Error("--set: " + unknown_name_message("parameter of a model", printable(edit.key, 80), known) +
                  "; give all else by flags, and another panel by --slm FILE.toml");
    texts[edit.key] = edit.value;
  }
  set_from_texts(model, texts, [](const std::string& name) { return "--set " + name; });
  return model;
}

}  // namespace

std::vector<SceneValue> load_editable_values(const std::string& path) {
  if (is_model(path)) {
    const ModelParams model;
    if (!is_mesh_file(path)) return {{{"fit", fmt::format("{}", model.fit)}, "model"}};
    return {{{"rotation", "y 0 deg"}, "model"}, {{"fit", fmt::format("{}", model.fit)}, "model"}};
  }
  std::vector<std::string> files, warnings;
  return editable_values(read_scene(path, files, warnings));
}

Slm load_slm(const std::string& name) {
  if (extension_of(name) != ".toml") return slm_preset(name);
  std::vector<std::string> files, unheard;  // `unheard` has warnings about other tables than [slm]
  const toml::table parsed = read_scene(name, files, unheard);
  const bool is_panel = !parsed.contains("wavelength") && !parsed.contains("slm");
  TomlTable root(parsed, files, is_panel ? "the panel file" : "the scene file");
  const auto table = is_panel ? std::optional(root) : root.table("slm");
  Slm slm = table ? read_slm(*table, is_panel ? "" : "pluto") : slm_preset("pluto");
  if (is_panel && !root.has("name")) slm.name = std::filesystem::path(name).stem().string();
  if (is_panel || !slm.own_effects.empty()) slm.preset = name;
  return slm;
}

Job job_of_tables(const toml::table& tables, const SceneArrays& arrays, Outside outside, std::optional<double> time) {
  TomlTable root(tables, std::make_shared<const SceneArrays>(arrays), "the scene");
  return read_job(root, "", outside, time);
}

Slm slm_of_table(const toml::table& table) {
  return read_slm(TomlTable(table, std::make_shared<const SceneArrays>(), "the panel"), "");
}

Job load_job(const std::string& path, Outside outside, const ModelParams& model, const std::string& slm,
             std::optional<double> time, const std::vector<SceneEdit>& edits) {
  const std::string first = file_at(path, {}).path;
  check_file_exists(first, is_model(path) ? "a model" : "a scene file");  // before the panel's file
  return load_job_for(slm.empty() ? std::nullopt : std::optional(load_slm(slm)), path, outside, model, time, edits);
}

bool is_panel_file(const std::string& path) {
  if (extension_of(path) != ".toml") return false;
  std::vector<std::string> files, unheard;
  const toml::table parsed = read_scene(path, files, unheard);
  return has_keys_of_panel(parsed);
}

Job load_job_for(const std::optional<Slm>& slm, const std::string& path, Outside outside, const ModelParams& model,
                 std::optional<double> time, const std::vector<SceneEdit>& edits) {
  if (is_model(path)) {
    const Slm panel = slm ? *slm : load_slm("pluto");
    const ModelParams params = edited(model, edits);
    return is_mesh_file(path) ? job_for_model(path, panel, params, outside, time.value_or(0))
                              : job_for_pictures(path, panel, params, time.value_or(0));
  }
  check_file_exists(path, "a scene file");
  require(extension_of(path) == ".toml" || (is_text_file(path) && extension_of(path) != ".json"),
          "{}: expected a scene .toml or a model such as .obj or .glb, got {}", path, kind_of_file(path));
  std::vector<std::string> files, warnings;
  toml::table parsed;
  try {
    parsed = read_scene(path, files, warnings);
  } catch (const Error& error) {
    if (extension_of(path) == ".toml") throw;
    fail("expected a scene .toml or a model such as .obj or .glb; {}", error.what());
  }
  require(!has_keys_of_panel(parsed), "{0}: expected a scene or a model, got a panel file; name it by --slm {0}", path);
  for (const SceneEdit& edit : edits)
    require(!slm || !edit.key.starts_with("slm."),
            "expected --slm or values of the scene's panel, got both; leave out {}, or change the panel's file",
            printable(edit.key, 80));
  apply_edits(edits, parsed, files);
  TomlTable root(parsed, files, "the scene file");
  Job job = read_job(root, path, outside, time);
  job.warnings.insert(job.warnings.begin(), warnings.begin(), warnings.end());
  if (slm) job.slm = *slm;
  return job;
}

}  // namespace holotrace
