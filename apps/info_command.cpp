// holotrace info: prints the content of a file or a panel, or lists panels, lights, or the devices of this machine.

#include <algorithm>
#include <memory>

#include "commands.h"
#include "console.h"
#include "holotrace/base/error.h"
#include "holotrace/base/machine.h"
#include "holotrace/base/message_text.h"
#include "holotrace/base/units.h"
#include "holotrace/data/named_light.h"
#include "holotrace/data/params/device.h"
#include "holotrace/io/describe_file.h"
#include "holotrace/io/files/file.h"
#include "holotrace/io/picture/panel_image_file.h"
#include "holotrace/io/run_folder.h"
#include "holotrace/wave/shared/stage_on_device.h"

namespace holotrace {
namespace {

// What a device does per second, as kept or measured now; why it does not work, if it does not.
struct Measured {
  DeviceRates rates;
  std::string fault;
};

Measured measured(const DeviceInfo& info) {
  try {
    return {device_rates(open_device(info.number)), ""};
  } catch (const Error& error) {
    return {{}, error.what()};
  }
}

Json facts_of(const DeviceInfo& info) {
  const auto& [rates, fault] = measured(info);
  Json facts = {{"device", device_text({DeviceKind::opencl, info.number})},
                {"name", info.name},
                {"type", type_name(info.type)},
                {"compute_units", info.compute_units},
                {"memory_bytes", int64_t(info.memory)},
                {"driver", info.driver},
                {"platform", info.platform},
                {"multiply_adds_per_second", rates.multiply_adds},
                {"bytes_per_second", rates.bytes},
                {"moved_bytes_per_second", rates.moved_bytes}};
  if (!fault.empty()) facts["fault"] = fault;
  return facts;
}

std::string line_of(const DeviceInfo& info) {
  return fmt::format("{:<12} {}: {} of {} units, {}; driver {} ({})", device_text({DeviceKind::opencl, info.number}),
                     info.name, type_name(info.type), info.compute_units, format_bytes(info.memory), info.driver,
                     info.platform);
}

std::string rates_line_of(const DeviceInfo& info) {
  const auto& [rates, fault] = measured(info);
  if (!fault.empty()) return "does not work: " + fault;
  return fmt::format("sums waves at {:.3g} multiply-adds/s; propagates at {:.3g} bytes/s; transfers {:.3g} bytes/s",
                     rates.multiply_adds, rates.moved_bytes, rates.bytes);
}

/// Prints the processor and the OpenCL devices of this machine, by the names that --device takes; or as JSON.
void print_devices(bool is_json) {
  std::vector<DeviceInfo> devices;
  std::string why_none = "no driver for OpenCL is installed";
  try {
    devices = list_devices();
  } catch (const Error& error) {
    why_none = error.what();
  }
  if (is_json) {
    Json json = {{"devices", Json::array({{{"device", "cpu"}, {"name", cpu_name()}, {"threads", thread_count()}}})}};
    for (const DeviceInfo& info : devices) json["devices"].push_back(facts_of(info));
    return print_facts(json, true);
  }
  fmt::print("{:<12} {}, {} threads\n", "cpu", printable(cpu_name()), thread_count());
  for (const DeviceInfo& info : devices)
    fmt::print("{}\n{:<12} {}\n", printable(line_of(info)), "", printable(rates_line_of(info)));
  if (devices.empty()) say("no OpenCL devices: {}\n", printable(why_none));
}

Json facts_of(const KnownPanel& panel) {
  Json facts{{"name", panel.name}, {"is_own", panel.is_users}, {"file", panel.file}};
  try {
    const Slm slm = slm_preset(panel.name);
    facts.update(Json{{"columns", slm.grid.nx},
                      {"rows", slm.grid.ny},
                      {"pitch_m", slm.grid.pitch},
                      {"levels", slm.levels},
                      {"modulation", name_of(slm.modulation, modulation_names)},
                      {"fill_factor", slm.fill_factor},
                      {"source", slm.source}});
  } catch (const Error& error) {
    facts["fault"] = error.what();
  }
  return facts;
}

// The beginning of a source, which has the maker and the type of a panel: "HOLOEYE LUNA data sheet".
std::string beginning_of(const std::string& source) {
  const std::string beginning = source.substr(0, source.find_first_of(";("));
  return beginning.substr(0, beginning.find_last_not_of(' ') + 1);
}

/// Lists the panels that --slm knows by name, those in folders of the user's with a star; or as JSON.
void print_panels(bool is_json) {
  Json panels = Json::array();
  size_t width = 0;
  bool has_own = false;
  for (const KnownPanel& panel : known_panels()) {
    panels.push_back(facts_of(panel));
    width = std::max(width, panel.name.size());
    has_own |= panel.is_users;
  }
  if (is_json) return print_facts({{"panels", panels}}, true);
  fmt::print("  {:<{}} {:>11} {:>8} {:>6} {:<10} {:>5}  {}\n", "name", width, "pixels", "pitch", "levels", "modulation",
             "fill", "maker, type and source");
  for (const Json& panel : panels) {
    fmt::print("{} {:<{}} ", panel["is_own"].get<bool>() ? '*' : ' ', printable(panel["name"].get<std::string>()),
               width);
    if (panel.contains("fault"))
      fmt::print("cannot be read: {}\n", printable(panel["fault"].get<std::string>()));
    else
      fmt::print("{:>11} {:>8} {:>6} {:<10} {:>5g}  {}\n",
                 fmt::format("{} x {}", panel["columns"].get<int>(), panel["rows"].get<int>()),
                 format_length(panel["pitch_m"].get<double>()), panel["levels"].get<int>(),
                 panel["modulation"].get<std::string>(), panel["fill_factor"].get<double>(),
                 printable(beginning_of(panel["source"].get<std::string>())));
  }
  if (has_own) fmt::print("* from a folder of your own\n");
}

/// Lists the lasers and LEDs whose names stand for wavelengths; or as JSON.
void print_lights(bool is_json) {
  Json lights = Json::array();
  for (const auto& [name, wavelength, bandwidth, source] : named_lights())
    lights.push_back({{"name", name}, {"wavelength_m", wavelength}, {"bandwidth_m", bandwidth}, {"source", source}});
  if (is_json) return print_facts({{"lights", lights}}, true);
  fmt::print("{:<12} {:>10} {:>9}  {}\n", "name", "wavelength", "bandwidth", "source");
  for (const auto& [name, wavelength, bandwidth, source] : named_lights())
    fmt::print("{:<12} {:>10} {:>9}  {}\n", name, format_length(wavelength),
               bandwidth > 0 ? format_length(bandwidth) : "narrow", source);
}

// A picture is a hologram if flags say what it shows.
Json describe_input(const std::string& path, const Flags& flags, Outside outside) {
  if (!is_there(path)) {
    const std::vector<std::string> panels = slm_preset_names();
    require(std::find(panels.begin(), panels.end(), path) == panels.end(),
            "expected a file or folder at {0}, but there is none; {0} is a panel: holotrace info --slm {0}", path);
  }
  if (flags.texts().empty()) return describe_file(path, outside);
  const std::vector<std::string>& endings = panel_image_endings();
  require(std::find(endings.begin(), endings.end(), extension_of(path)) != endings.end() && !is_folder(path),
          "{0} is for holograms, but {1} is none; leave out {0}", dashed(flags.texts().begin()->first), path);
  return describe_hologram(load_hologram(path, apply_to_hologram(flags)));
}

}  // namespace

void add_info_command(CLI::App& app, const GlobalFlags& global) {
  CLI::App* command = app.add_subcommand(
      "info",
      "contents of any file that holotrace reads or of the folder of a run or a film; data of a panel; or a list of the known "
      "panels, the known lights or the devices of this machine");
  struct Options {
    std::string path, slm;
    bool is_json = false, has_devices = false, has_lights = false;
    Flags flags;
  };
  auto o = std::make_shared<Options>();
  auto* file = command->add_option("file", o->path, "file, or folder of a run or a film")->type_name("FILE|DIR");
  auto* slm =
      command
          ->add_option("--slm", o->slm,
                       "panel whose data, effects and their sources are shown; without a value: all panels that are "
                       "known by name")
          ->type_name("NAME|FILE.toml")
          ->expected(0, 1);
  slm->excludes(file);
  command->add_flag("--devices", o->has_devices,
                    "processor and OpenCL devices of this machine, as --device names them");
  command->add_flag("--lights", o->has_lights, "lasers and LEDs whose names may be given as wavelengths");
  command->add_flag("--json", o->is_json, "as JSON");
  add_hologram_flags(*command, o->flags, {"range"});  // it is the panel's
  command->callback([o, slm, &global] {
    const bool has_slm = slm->count() > 0;
    std::vector<const char*> asked;
    if (o->has_devices) asked.push_back("--devices");
    if (o->has_lights) asked.push_back("--lights");
    if (has_slm) asked.push_back("--slm");
    if (!o->path.empty()) asked.push_back("a file");
    if (asked.empty()) throw CLI::RequiredError("a file or folder, --slm, --lights or --devices");
    if (asked.size() > 1) throw CLI::ExcludesError(asked[0], asked[1]);
    if (o->has_devices) return print_devices(o->is_json);
    if (o->has_lights) return print_lights(o->is_json);
    if (has_slm && o->slm.empty()) return print_panels(o->is_json);
    print_facts(o->slm.empty() ? describe_input(o->path, o->flags, global.outside()) : describe_slm(load_slm(o->slm)),
                o->is_json);
  });
}

}  // namespace holotrace
