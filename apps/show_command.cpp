// holotrace show: computes the image of holograms on a virtual SLM and in a camera.

#include <algorithm>
#include <memory>
#include <utility>
#include <vector>

#include "commands.h"
#include "console.h"
#include "flags.h"
#include "holotrace/base/error.h"
#include "holotrace/io/field/hologram_file.h"
#include "holotrace/io/files/file.h"
#include "holotrace/io/files/output.h"
#include "holotrace/io/panel_hologram_file.h"
#include "holotrace/io/picture/animation.h"
#include "holotrace/io/run/save_run.h"
#include "holotrace/io/run_folder.h"
#include "holotrace/run/view_holograms.h"

namespace holotrace {
namespace {

// A hologram of the inputs: a file or, in a coloured picture without metadata, a channel.
struct Input {
  std::string path;
  Channel channel = Channel::grey;
};

// The holograms of the inputs: those of a run in place of its folder.
std::vector<Input> holograms_of(const std::vector<std::string>& inputs, const Flags& flags) {
  std::vector<Input> holograms;
  for (const std::string& input : inputs) {
    if (is_folder(input)) {
      for (const std::string& path : list_complete_run(input).holograms) holograms.push_back({path});
    } else if (flags.has("channel")) {
      holograms.push_back({input});
    } else {
      for (const Channel channel : hologram_channels(input)) holograms.push_back({input, channel});
    }
  }
  return holograms;
}

// A hologram with what the flags say, and its wavelength among those of --wavelength.
PanelHologram load_input(const Input& input, const std::string& slm, const Flags& flags, double wavelength,
                         bool is_one) {
  PanelHologram loaded = load_panel_hologram(input.path, slm, [&](HologramParams& params) {
    flags.apply(params);
    if (input.channel != Channel::grey) params.channel = input.channel;
    params.wavelength = wavelength;
  });
  require(
      is_one || loaded.hologram.wavelength == wavelength,
      "expected several wavelengths only for files without metadata, but {} was made for {}; give one --wavelength, or none",
      input.path, format_length(loaded.hologram.wavelength));
  return loaded;
}

// Notes the files beside the output: further distances, and the sweep.
void note_outputs(const std::string& output, const std::vector<Viewpoint>& from, SweepFormat format) {
  const auto count = [&](ViewKind kind) {
    return size_t(std::count_if(from.begin(), from.end(), [&](const Viewpoint& view) { return view.kind == kind; }));
  };
  const size_t views = count(ViewKind::distance), swept = count(ViewKind::sweep);
  if (count(ViewKind::eye) > 0)
    for (const char* eye : {"_left", "_right", "_anaglyph"}) note_output(path_with_suffix(output, eye));
  for (size_t i = 1; i < views; ++i) note_output(numbered_path(output, i));
  if (swept > 0)
    for (const std::string& path : sweep_paths(output, swept, format))
      if (path != series_path(output, 0) && is_there(path))  // the main one is noted
        note_output(path);                                   // there may be many, and only those can be inputs
}

}  // namespace

void add_show_command(CLI::App& app, const GlobalFlags& global) {
  CLI::App* command = app.add_subcommand("show", "camera image of holograms on a virtual SLM");
  struct Options {
    std::vector<std::string> inputs;
    std::string output, slm, report, eye_separation, wavelength;
    Flags flags;
  };
  auto o = std::make_shared<Options>();
  command
      ->add_option(
          "holograms", o->inputs,
          "hologram files, or the folder of a run for all of its holograms. Several of one wavelength and name are averaged as "
          "frames, different names are added, and different wavelengths become colours")
      ->required()
      ->type_name("HOLOGRAM.png|DIR");
  add_output(
      *command, o->output,
      "image: .png, .jpg or .exr (irradiance); several distances: NAME, NAME_2, …; a sweep adds NAME_sweep_01, …, "
      "its animation NAME_sweep.gif and its chart NAME_sweep.png; .gif, .webp, .mp4, .webm: only the animation; "
      "NAME_####.png: only its pictures NAME_0001.png, …");
  add_slm(*command, o->slm, "the one the hologram was made for, or pluto");
  add_report(*command, o->report);
  command
      ->add_option(
          "--eye-separation", o->eye_separation,
          "distance between two eyes along x, about --eye: adds NAME_left, NAME_right and NAME_anaglyph at the "
          "first distance; needs a pupil [0 m: none]")
      ->type_name("LENGTH");
  add_hologram_flags(*command, o->flags, {"wavelength"});  // it is the illumination's flag
  command
      ->add_option(
          "--wavelength", o->wavelength,
          "wavelength of the illumination, or its name (holotrace info --lights), and of holograms without metadata; several: one "
          "for each file without metadata, or for red, green and blue of a coloured file [the holograms' own]")
      ->type_name("WAVELENGTHS");
  o->flags.add(*command, ShowParams(), {"wavelength"});
  const std::string kept = "as the first hologram's run";
  o->flags.add(*command, CameraParams(), {}, "", {{"distances", kept}, {"pupil", kept}, {"eye", kept}});
  // One --device for the panel and for propagations.
  o->flags.add(*command, PropagateParams(), {"columns", "rows", "pitch", "centre_x", "centre_y", "device"});
  command->callback([o, &global] {
    ShowParams params;
    CameraParams camera;
    PropagateParams propagation;
    o->flags.apply(params);
    o->flags.apply(camera);
    o->flags.apply(propagation);
    propagation.centre_x = propagation.centre_y = 0;  // these flags set the centre of the sensor
    check_views_output(o->output, camera);
    if (!o->report.empty()) check_output(o->report, {".json"});
    const std::vector<Input> inputs = holograms_of(o->inputs, o->flags);
    std::vector<double> wavelengths{0};
    if (!o->wavelength.empty()) wavelengths = parse_wavelengths_flag(o->wavelength);
    const bool is_one = wavelengths.size() == 1;
    require(is_one || wavelengths.size() == inputs.size(),
            "expected one --wavelength, or one for each of the {} holograms, got {}", inputs.size(),
            wavelengths.size());
    if (is_one) params.wavelength = wavelengths.front();
    camera = camera_in(viewing_of_file(inputs.front().path));
    o->flags.apply(camera);  // each flag replaces its own value
    RenderParams eyes;
    eyes.eye = camera.eye;
    if (!o->eye_separation.empty())
      eyes.eye_separation = parse_length_flag("--eye-separation", o->eye_separation, range::not_negative);
    std::vector<Viewpoint> from = viewpoints(camera, eyes);
    if (is_sweep_alone(o->output))
      std::erase_if(from, [](const Viewpoint& view) { return view.kind != ViewKind::sweep; });

    note_outputs(o->output, from, camera.sweep_format);
    std::vector<std::string> paths;
    for (const Input& input : inputs) paths.push_back(input.path);
    check_series(paths);

    Console console(global.is_quiet);
    Report report;
    bool is_for_all_light = false;  // optimised without a pupil: the light goes nearly straight on
    const HologramSeries holograms{
        inputs.size(), [&](size_t i) {
          PanelHologram loaded = load_input(inputs[i], o->slm, o->flags, wavelengths[is_one ? 0 : i], is_one);
          const Hologram& hologram = loaded.hologram;
          is_for_all_light |= hologram.encoder == "sgd" && hologram.viewing.are_known() && hologram.viewing.pupil == 0;
          return loaded;
        }};
    const SeriesViews seen = view_holograms(holograms, {params, propagation, camera, from}, report, console.stages());
    console.finish();
    if (is_for_all_light && camera.pupil > 0 && camera.eye.z > 0)
      say("warning: the holograms were found for all light that leaves the panel, most of which may pass beside this pupil; for an "
          "eye, make them by holotrace run … --eye \"{} {} {}\" --pupil \"{}\"\n",
          format_length(camera.eye.x), format_length(camera.eye.y), format_length(camera.eye.z),
          format_length(camera.pupil));
    say_warnings(write_views(o->output, {from, seen.views, seen.sweep, seen.stereo, camera},
                             seen.sweep.images.empty() ? Observer() : console.watch("save the sweep")));
    console.finish();
    if (!o->report.empty()) save_report(o->report, report);
  });
}

}  // namespace holotrace
