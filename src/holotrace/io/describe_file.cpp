#include "holotrace/io/describe_file.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numeric>
#include <optional>

#include "holotrace/base/error.h"
#include "holotrace/base/units.h"
#include "holotrace/io/field/field_file.h"
#include "holotrace/io/field/hologram_file.h"
#include "holotrace/io/field/light_field_file.h"
#include "holotrace/io/field/metadata.h"
#include "holotrace/io/field/sources_file.h"
#include "holotrace/io/files/file.h"
#include "holotrace/io/files/output.h"
#include "holotrace/io/files/ply.h"
#include "holotrace/io/files/text.h"
#include "holotrace/io/mesh/mesh_file.h"
#include "holotrace/io/picture/image_file.h"
#include "holotrace/io/picture/panel_image_file.h"
#include "holotrace/io/run_folder.h"
#include "holotrace/io/scene/scene_file.h"

namespace holotrace {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::string_view stage_of_views = "look at ";

std::optional<double> number_in(const Json& stage, const char* fact) {
  if (!stage.contains(fact) || !stage[fact].is_number()) return std::nullopt;
  return stage[fact].get<double>();
}

std::string text_in(const Json& json, const char* key) {
  return json.is_object() && json.contains(key) && json[key].is_string() ? json[key].get<std::string>() : "";
}

std::string nearness_in(const Json& stage) {
  const auto psnr = number_in(stage, "psnr_db");
  if (!psnr) {
    const std::string why = text_in(stage, "why_no_metrics");
    return "not compared with a render" + (why.empty() ? "" : ": " + why);
  }
  std::string text = fmt::format("PSNR {:.1f} dB against the render", *psnr);
  if (const auto black = number_in(stage, "psnr_of_black_db"))
    text += fmt::format(" (a black view: {:.1f} dB)", *black);
  if (const auto ssim = number_in(stage, "ssim")) text += fmt::format(", SSIM {:.2f}", *ssim);
  if (const auto contrast = number_in(stage, "speckle_contrast"))
    text += fmt::format(", speckle contrast {:.2f}", *contrast);
  return text;
}

std::string light_in(const Json& stage) {
  const auto of_view = number_in(stage, "lit_fraction_of_view"), of_render = number_in(stage, "lit_fraction_of_render");
  if (!of_view) return "";
  std::string text = of_render ? fmt::format("{} of the render and {} of the view are lit", format_percent(*of_render),
                                             format_percent(*of_view))
                               : fmt::format("{} of the view are lit", format_percent(*of_view));
  if (const auto efficiency = number_in(stage, "diffraction_efficiency"))
    text += fmt::format("; {} of the panel's light falls on what is bright in the render", format_percent(*efficiency));
  return text;
}

// The metadata of the holograms of one frame: their wavelengths, each once, and their number.
struct FrameOfRun {
  std::vector<double> wavelengths;
  size_t holograms = 0;
};

FrameOfRun first_frame(const std::vector<std::string>& paths, const Hologram& first) {
  FrameOfRun frame;
  for (size_t i = 0; i < paths.size(); ++i) {
    const Hologram hologram = i == 0 ? first : load_hologram(paths[i]);
    if (hologram.label.frame != first.label.frame) break;
    ++frame.holograms;
    std::vector<double> shown;
    for (const JointColour& colour : hologram.colours) shown.push_back(colour.wavelength);
    if (shown.empty()) shown.push_back(hologram.wavelength);
    for (const double wavelength : shown)
      if (std::find(frame.wavelengths.begin(), frame.wavelengths.end(), wavelength) == frame.wavelengths.end())
        frame.wavelengths.push_back(wavelength);
  }
  return frame;
}

std::vector<std::string> warnings_in(const Json& report) {
  std::vector<std::string> sentences;
  if (!report.is_object() || !report.contains("stages")) return sentences;
  for (const Json& stage : report["stages"]) {
    if (!stage.is_object() || !stage.contains("warnings") || !stage["warnings"].is_array()) continue;
    for (const Json& warning : stage["warnings"])
      if (warning.is_string()) sentences.push_back(text_in(stage, "stage") + ": " + warning.get<std::string>());
  }
  return sentences;
}

}  // namespace

std::vector<ViewWords> views_in_words(const Json& report) {
  std::vector<ViewWords> views;
  if (!report.is_object() || !report.contains("stages")) return views;
  for (const Json& stage : report["stages"]) {
    const std::string name = text_in(stage, "stage");
    if (!name.starts_with(stage_of_views)) continue;
    views.push_back({numbered_path(run_view, views.size()) + " at " + name.substr(stage_of_views.size()),
                     nearness_in(stage), light_in(stage)});
  }
  return views;
}

Json describe_run(const std::string& folder) {
  const RunFolder run = list_complete_run(folder);
  const Hologram first = load_hologram(run.holograms.front());
  const FrameOfRun frame = first_frame(run.holograms, first);
  Json json{{"kind", "run"}, {"holograms", run.holograms.size()}, {"frames", run.holograms.size() / frame.holograms}};
  const Json of_hologram = describe_hologram(first);
  for (const auto& [name, value] : of_hologram.items())
    if (name != "kind" && name != "frame" && name != "name" && name != "illumination_w_per_m2") json[name] = value;
  json["wavelength"] = lengths_text(frame.wavelengths);
  json["views"] = run.views.size();
  if (run.report.empty()) return json;
  const Json report = parse_json_if_sound(read_text(run.report, most_text));
  for (const ViewWords& view : views_in_words(report))
    json[view.name] = view.nearness + (view.light.empty() ? "" : "; " + view.light);
  if (const auto seconds = number_in(report, "seconds")) json["seconds"] = *seconds;
  if (report.is_object() && report.contains("versions")) json["version"] = text_in(report["versions"], "holotrace");
  json["warnings"] = warnings_in(report);
  return json;
}

namespace {

// A film: what its first time says of all, and the figures of all times.
Json describe_film(const std::string& folder) {
  const RunFolder film = list_run(folder);
  require(
      !film.report.empty() && !is_incomplete_report(film.report),
      "expected the folder of a complete film, but {} has no report yet; the same `holotrace animate` goes on with it",
      folder);
  const Json report = parse_json_if_sound(read_text(film.report, most_text));
  Json json{{"kind", "film"}, {"times", 0}};
  for (const char* key : {"fps", "seconds_of_film", "shutter_s"})
    if (const auto figure = number_in(report, key)) json[key] = *figure;
  const Json first = describe_run(time_folder(folder, 0));
  for (const auto& [name, value] : first.items())
    if (!value.is_array() && !name.starts_with("view") && name != "kind" && name != "views" && name != "seconds" &&
        name != "version")
      json[name == "holograms" ? "holograms_of_a_time" : name] = value;
  std::vector<double> psnr;
  std::vector<std::string> warnings;
  for (const Json& time : report.is_object() ? report.value("times", Json::array()) : Json::array()) {
    if (!time.is_object()) continue;
    json["times"] = json["times"].get<int>() + 1;
    for (const Json& view : time.value("views", Json::array()))
      if (const auto figure = number_in(view, "psnr_db")) psnr.push_back(*figure);
    for (const Json& warning : time.value("warnings", Json::array()))
      if (warning.is_string() && std::find(warnings.begin(), warnings.end(), warning) == warnings.end())
        warnings.push_back(warning);
  }
  if (!psnr.empty())
    json["psnr"] = fmt::format("{:.1f} dB on average, {:.1f} dB at least, against the renders",
                               std::accumulate(psnr.begin(), psnr.end(), 0.0) / double(psnr.size()),
                               *std::min_element(psnr.begin(), psnr.end()));
  if (const auto seconds = number_in(report, "seconds")) json["seconds"] = *seconds;
  json["warnings"] = warnings;
  return json;
}

std::string size_text(int nx, int ny) { return fmt::format("{}x{}", nx, ny); }

// Adds the name and frame of an item that is one of several.
void add_part(const std::string& name, uint32_t frame, Json& json) {
  if (!name.empty()) json["name"] = name;
  if (frame > 0) json["frame"] = frame;
}

// Adds where the hologram's run focused, and the eye that it looked with.
void add_viewing(const ViewingConditions& viewing, Json& json) {
  if (viewing.are_known()) json["distances"] = lengths_text(viewing.distances);
  if (viewing.pupil == 0) return;
  json["pupil"] = format_length(viewing.pupil);
  json["eye"] = lengths_text({viewing.eye.x, viewing.eye.y, viewing.eye.z});
}

Json describe(const Job& job) {
  size_t triangles = 0;
  for (const Mesh& mesh : job.scene.meshes) triangles += mesh.triangles.size();
  return {{"kind", "scene"},
          {"wavelength", lengths_text(job.wavelengths)},
          {"slm", job.slm.name},
          {"panel", size_text(job.slm.grid.nx, job.slm.grid.ny) + " at " + format_length(job.slm.grid.pitch)},
          {"points", job.scene.points.size()},
          {"meshes", job.scene.meshes.size()},
          {"triangles", triangles},
          {"materials", job.scene.materials.size()},
          {"lights", job.scene.lights.size()},
          {"frames", job.trace.frames > 0 ? Json(job.trace.frames) : Json("auto")},
          {"warnings", job.warnings}};
}

Json describe(const Sources& sources) {
  double nearest = INFINITY, farthest = -INFINITY;  // in front of the panel < 0
  const auto include = [&](Vec3 place) {
    nearest = std::min(nearest, -place.z);
    farthest = std::max(farthest, -place.z);
  };
  for (const Source& s : sources.waves) include(s.origin);
  for (const SecondFocus& focus : sources.second_foci)
    if (focus.is_astigmatic()) include(focus.place);
  Json json{{"kind", "sources"},
            {"waves", sources.waves.size()},
            {"wavelength", format_length(sources.wavelength)},
            {"nearest", format_length(nearest)},
            {"farthest", format_length(farthest)}};
  add_part(sources.label.name, sources.label.frame, json);
  if (sources.tiles.columns > 0) json["tiles"] = size_text(sources.tiles.columns, sources.tiles.rows);
  return json;
}

Json describe(const std::vector<FieldDouble>& stack) {
  double largest = 0, watts = 0;
  std::vector<double> wavelengths;
  for (const FieldDouble& field : stack) {
    for (const auto& u : field.samples.values) largest = std::max(largest, std::abs(u));
    watts += power(field);
    wavelengths.push_back(field.wavelength);
  }
  const FieldDouble& field = stack.front();
  Json json{{"kind", "field"},
            {"samples", size_text(field.grid.nx, field.grid.ny)},
            {"pitch", format_length(field.grid.pitch)},
            {"wavelength", lengths_text(wavelengths)},
            {"z", format_length(field.z)},
            {"image", field.image == ImageSide::real_image ? "real" : "virtual"},
            {"power_w", watts},
            {"largest_amplitude", largest}};
  if (field.grid.centre_x != 0 || field.grid.centre_y != 0)
    json["centre"] = format_length(field.grid.centre_x) + ", " + format_length(field.grid.centre_y);
  add_part(field.label.name, field.label.frame, json);
  return json;
}

Json describe(const Image& image) {
  const auto [least, greatest] = std::minmax_element(image.values.begin(), image.values.end());
  return {{"kind", "image"},
          {"pixels", size_text(image.nx, image.ny)},
          {"channels", image.channels},
          {"least", double(*least)},
          {"greatest", double(*greatest)}};
}

double greatest_in(const std::vector<Image>& pictures) {
  float greatest = 0;
  for (const Image& picture : pictures)
    greatest = std::max(greatest, *std::max_element(picture.values.begin(), picture.values.end()));
  return greatest;
}

Json describe(const LightField& field) {
  return {{"kind", "light field"},
          {"views", size_text(field.columns, field.rows)},
          {"cell", format_length(field.cell_width())},
          {"cells_at_z", format_length(field.lens_z)},
          {"distance", format_length(field.distance)},
          {"pixels", size_text(field.plane.nx, field.plane.ny)},
          {"pitch", format_length(field.plane.pitch)},
          {"channels", field.views.front().channels},
          {"greatest_w_per_m2_sr", greatest_in(field.views)}};
}

Json describe(const FocalStack& stack) {
  return {{"kind", "focal stack"},
          {"planes", stack.pictures.size()},
          {"distances", lengths_text(stack.distances)},
          {"pixels", size_text(stack.grid.nx, stack.grid.ny)},
          {"pitch", format_length(stack.grid.pitch)},
          {"channels", stack.pictures.front().channels},
          {"greatest_w_per_m2_sr", greatest_in(stack.pictures)}};
}

Json describe(const LoadedModel& model) {
  size_t triangles = 0;
  Vec3 low{INFINITY, INFINITY, INFINITY}, high = -low;
  for (const Mesh& mesh : model.meshes) {
    triangles += mesh.triangles.size();
    for (const Vec3 p : mesh.positions) {
      low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
      high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
    }
  }
  const Vec3 size = high - low;
  std::vector<std::string> cameras;
  for (const ModelCamera& camera : model.cameras) cameras.push_back(camera.name);
  return {{"kind", "mesh"},
          {"meshes", model.meshes.size()},
          {"triangles", triangles},
          {"materials", model.materials.size()},
          {"lights", model.lights.size()},
          {"cameras", cameras},
          {"size", fmt::format("{:g} x {:g} x {:g} units", size.x, size.y, size.z)},
          {"warnings", model.warnings}};
}

Json describe_ply(const std::string& path, Outside outside) {
  const PlyVertices vertices = read_ply(path, true);
  if (vertices.find("amplitude") && vertices.find("phase") && !vertices.comments.empty())
    return describe(load_sources(path));
  if (!vertices.corners.sizes.empty() || !vertices.strips.empty() || vertices.find("face_idx"))
    return describe(load_meshes(path, outside));
  return {{"kind", "PLY vertices"}, {"vertices", vertices.count}, {"properties", vertices.names}};
}

std::string aberration_text(const std::vector<ZernikeTerm>& terms) {
  std::string text;
  for (const ZernikeTerm& term : terms)
    text += fmt::format("{}Z({}, {}) {:g} rad rms", text.empty() ? "" : ", ", term.n, term.m, term.rms);
  return text;
}

std::string crystal_text(const Crystal& crystal) {
  const auto axis = [](const std::optional<double>& angle) { return angle ? format_angle(*angle) : "none"; };
  std::string text = fmt::format("{}, director {}, twist {}, ", name_of(crystal.pass, crystal_pass_names),
                                 format_angle(crystal.director), format_angle(crystal.twist));
  if (!crystal.delays.empty())
    text += fmt::format("delay {:.4g}π to {:.4g}π, ", crystal.delays.front() / pi, crystal.delays.back() / pi);
  text += fmt::format("polariser {}, analyser {}", axis(crystal.polariser), axis(crystal.analyser));
  if (const size_t plates = crystal.plates_before.size() + crystal.plates_behind.size(); plates > 0)
    text += fmt::format(", {} wave plate(s)", plates);
  return text;
}

Json describe_effects(const Slm& slm) {
  const SlmEffects& e = slm.effects;
  Json json = Json::object();
  if (!e.calibration.empty()) {
    const auto least = [](const CalibrationPoint& a, const CalibrationPoint& b) { return a.amplitude < b.amplitude; };
    const auto [low, high] = std::minmax_element(e.calibration.begin(), e.calibration.end(), least);
    json["calibration"] =
        fmt::format("{} levels, phase {:.4g}π to {:.4g}π, amplitude {:g} to {:g}", e.calibration.size(),
                    e.calibration.front().phase / pi, e.calibration.back().phase / pi, low->amplitude, high->amplitude);
  }
  if (e.crosstalk > 0)
    json["crosstalk"] = fmt::format("{:g} pixels ({})", e.crosstalk, format_length(e.crosstalk * slm.grid.pitch));
  if (e.gap_amplitude > 0)
    json["gaps"] = fmt::format("amplitude {:g}, phase {:.4g}π", e.gap_amplitude, e.gap_phase / pi);
  if (e.flicker > 0) json["flicker"] = fmt::format("±{:g} % of the phase", 100 * e.flicker);
  if (!e.aberration.empty()) json["aberration"] = aberration_text(e.aberration);
  if (e.phase_map) json["phase-map"] = size_text(e.phase_map->nx, e.phase_map->ny);
  if (e.light_map) json["light-map"] = size_text(e.light_map->nx, e.light_map->ny);
  if (e.dead_fraction > 0 || !e.dead_pixels.empty())
    json["dead-pixels"] = fmt::format("{} known, {:g} % at random", e.dead_pixels.size(), 100 * e.dead_fraction);
  if (e.crystal) json["crystal"] = crystal_text(*e.crystal);
  return json;
}

}  // namespace

std::string lengths_text(const std::vector<double>& lengths) {
  std::string text;
  for (const double length : lengths) text += (text.empty() ? "" : ", ") + format_length(length);
  return text;
}

Json describe_hologram(const Hologram& hologram) {
  Json json{{"kind", "hologram"}, {"pixels", size_text(hologram.grid.nx, hologram.grid.ny)}};
  if (hologram.grid.pitch > 0) json["pitch"] = format_length(hologram.grid.pitch);
  if (hologram.wavelength > 0) json["wavelength"] = format_length(hologram.wavelength);
  json["levels"] = hologram.levels;
  json["modulation"] = name_of(hologram.modulation, modulation_names);
  json["image"] = name_of(hologram.image, image_side_names);
  if (!hologram.encoder.empty()) json["encoder"] = hologram.encoder;
  json["illumination_w_per_m2"] = hologram.illumination;
  add_part(hologram.label.name, hologram.label.frame, json);
  add_viewing(hologram.viewing, json);
  return json;
}

Json describe_slm(const Slm& slm) {
  Json json{{"kind", "panel"},
            {"name", slm.name},
            {"pixels", size_text(slm.grid.nx, slm.grid.ny)},
            {"pitch", format_length(slm.grid.pitch)},
            {"size", format_length(slm.grid.width()) + " x " + format_length(slm.grid.height())},
            {"modulation", name_of(slm.modulation, modulation_names)},
            {"levels", slm.levels},
            {"fill_factor", slm.fill_factor}};
  if (slm.fill_x > 0) json["fill"] = fmt::format("{:g} of the side in x, {:g} in y", slm.fill_x, slm.fill_y);
  json["phase_range"] = fmt::format("{:.4g}π", slm.phase_range / pi);
  json["design_wavelength"] =
      slm.design_wavelength > 0 ? format_length(slm.design_wavelength) : "the wavelength in use";
  const Json effects = describe_effects(slm);
  json["effects"] = effects.empty()           ? "none"
                    : slm.own_effects.empty() ? "off; turn them on with --effects all"
                                              : fmt::format("on: {}", fmt::join(slm.own_effects, ", "));
  for (const auto& [name, text] : effects.items()) json[name] = text;
  if (!slm.source.empty()) json["source"] = slm.source;
  if (!slm.preset.empty()) json["read_from"] = slm.preset;
  return json;
}

Json describe_file(const std::string& path, Outside outside) {
  if (is_folder(path)) return is_film_folder(path) ? describe_film(path) : describe_run(path);
  check_file_exists(path, "a file");
  const std::string extension = extension_of(path);
  if (is_panel_file(path)) return describe_slm(load_slm(path));
  if (extension == ".toml") return describe(load_job(path, outside));
  if (extension == ".ply") return describe_ply(path, outside);
  if (is_mesh_file(path)) return describe(load_meshes(path, outside));
  if (Json done = done_to_panel_image(path); !done.is_null()) {
    Json json = {{"kind", "picture for a panel"}};
    json.update(done);
    return json;
  }
  if (is_hologram_file(path) || is_panel_table(path)) return describe_hologram(load_hologram(path));
  if (is_focal_stack_file(path)) return describe(load_focal_stack(path, outside));
  if (is_light_field_file(path)) return describe(load_light_field(path, outside));
  if (is_field_file(path)) return describe(load_fields_double(path, outside));
  return describe(load_image(path));
}

}  // namespace holotrace
