// holotrace compare: the difference between two images, or two fields.

#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "commands.h"
#include "console.h"
#include "flags.h"
#include "holotrace/base/error.h"
#include "holotrace/base/units.h"
#include "holotrace/data/image.h"
#include "holotrace/io/field/field_file.h"
#include "holotrace/io/files/file.h"
#include "holotrace/io/files/output.h"
#include "holotrace/io/picture/chart_file.h"
#include "holotrace/io/picture/image_file.h"
#include "holotrace/io/run_folder.h"
#include "holotrace/run/reference_metrics.h"
#include "holotrace/view/combine_views.h"
#include "holotrace/view/compare.h"
#include "holotrace/view/comparison_plots.h"
#include "holotrace/view/register/register.h"

namespace holotrace {
namespace {

/// Two images on the same pixels and with the same channels, and what was done to them.
struct ImagePair {
  Image reference, image;
  Json facts = Json::object();
  int rows = 0, columns = 0;            // size of the reference before it was cut
  int first_row = 0, first_column = 0;  // first compared pixel of the reference
};

std::string size_text(const Image& image) { return fmt::format("{} × {}", image.nx, image.ny); }

bool is_same_file(const std::string& a, const std::string& b) {
  std::error_code error;
  return std::filesystem::equivalent(a, b, error) && !error;
}

// The light in which a render is seen, in words.
std::string colour_text(const std::vector<double>& wavelengths) {
  std::vector<std::string> texts;
  for (const double wavelength : wavelengths) texts.push_back(format_length(wavelength));
  return fmt::format("{}", fmt::join(texts, ", "));
}

// Puts a render onto the pixels of a view of the same run. @return whether `render` is the render of `view`
bool place_render(Image& render, const std::string& render_path, const Image& view, const std::string& view_path,
                  Json& facts) {
  const std::optional<RenderOfView> known = render_of_view(view_path);
  if (!known || !(is_same_file(known->path, render_path) || is_same_file(known->radiance, render_path))) return false;
  facts["placed"] = fmt::format("{} ({} pixels) on the {} pixels of {}, each the mean over its area, by report.json",
                                render_path, size_text(render), size_text(view), view_path);
  facts["colours"] = "light of " + colour_text(known->place.wavelengths);
  if (known->psnr) facts["psnr_of_run_db"] = *known->psnr;
  render = render_at(render, known->place, view.ny, view.nx);
  return true;
}

// If one of two images is grey, makes the other grey by its luminance, and adds that fact.
void make_channels_equal(Image& a, Image& b, Json& facts) {
  if (a.channels == b.channels) return;
  a = luminance_of(a);
  b = luminance_of(b);
  facts["colours"] = "grey: luminance 0.2126 R + 0.7152 G + 0.0722 B of linear light";
}

// Loads a reference and an image. A render and a view of one run come together as in the run's report: the render in
// the colours of the view's light, on the view's pixels. Other pictures are taken to show the same window; if their
// sizes differ, the reference is brought to the image's pixels, each the mean over its area.
// @throws Error  as load_image does, and for windows of different shapes
ImagePair image_pair(const std::string& reference_path, const std::string& image_path) {
  ImagePair pair{load_image(reference_path), load_image(image_path)};
  Image &reference = pair.reference, &image = pair.image;
  const bool is_placed = place_render(reference, reference_path, image, image_path, pair.facts) ||
                         place_render(image, image_path, reference, reference_path, pair.facts);
  if (!is_placed && (reference.nx != image.nx || reference.ny != image.ny)) {
    const std::string size = size_text(reference);
    reference = on_pixels_of(reference, image);
    pair.facts["placed"] = fmt::format(
        "{} ({} pixels) on the {} pixels of {}, each the mean over its area, as if both "
        "showed one window",
        reference_path, size, size_text(image), image_path);
  }
  make_channels_equal(reference, image, pair.facts);
  pair.rows = reference.ny;
  pair.columns = reference.nx;
  return pair;
}

Json field_facts(const FieldDouble& reference, const FieldDouble& field) {
  const FieldMetrics m = compare(reference, field);
  return {{"relative_l2_error", number(m.relative_error)},
          {"scaled_l2_error", number(m.scaled_error)},
          {"correlation", number(std::abs(m.correlation))},
          {"scale_modulus", number(std::abs(m.scale))},
          {"scale_phase_rad", number(std::arg(m.scale))}};
}

// Differences of fields in colour: of all wavelengths together, and of each wavelength where its reference has light.
Json field_facts(const std::vector<FieldDouble>& reference, const std::vector<FieldDouble>& fields) {
  if (reference.size() == 1 && fields.size() == 1) return field_facts(reference.front(), fields.front());
  Json facts{{"relative_l2_error", number(relative_error(reference, fields))}};
  for (size_t n = 0; n < fields.size(); ++n) {
    Json one{{"wavelength_m", fields[n].wavelength}};
    if (power(reference[n]) > 0) one.update(field_facts(reference[n], fields[n]));
    facts["fields"].push_back(one);
  }
  return facts;
}

struct CompareOptions {
  std::string a, b, output, difference, profile;
  double difference_range = 0;
  bool is_json = false, is_registered = false;
  Flags flags;
};

// The value that a picture file shows as white: 1, unless the file has linear light.
double white_of(const std::string& path, const Image& image) {
  return extension_of(path) == ".exr" ? *std::max_element(image.values.begin(), image.values.end()) : 1;
}

ImagePair registered_pair(const CompareOptions& o, Console& console) {
  RegisterParams params;
  o.flags.apply(params);
  Image photograph = load_image(o.a), simulation = load_image(o.b);
  Json grey = Json::object();
  make_channels_equal(photograph, simulation, grey);
  const Registration r = register_image(photograph, simulation, params, console.watch("register"));
  console.finish();
  AlignedImage aligned = align_image(photograph, r, simulation.ny, simulation.nx);
  aligned.image.pitch = simulation.pitch;
  if (!o.output.empty()) save_image(o.output, aligned.image, white_of(o.b, simulation), 8);
  const PixelRectangle& covered = aligned.covered;
  ImagePair pair{cropped(simulation, covered),
                 cropped(aligned.image, covered),
                 {{"magnification", r.scale},
                  {"rotation_deg", r.rotation * 180 / pi},
                  {"shift_x_pixels", r.shift_x},
                  {"shift_y_pixels", r.shift_y},
                  {"gain", r.gain},
                  {"offset", r.offset},
                  {"place_error_pixels", r.uncertainty},
                  {"correlation", r.correlation},
                  {"overlap", r.overlap},
                  {"residual", r.residual},
                  {"compared_columns", covered.columns},
                  {"compared_rows", covered.rows},
                  {"compared_first_column", covered.first_column},
                  {"compared_first_row", covered.first_row}},
                 simulation.ny,
                 simulation.nx,
                 covered.first_row,
                 covered.first_column};
  pair.facts.update(grey);
  return pair;
}

// The figures of a pair of images, and its pictures as the flags ask for them: the chart comes last, because it may fail.
struct Comparison {
  Json facts;
  std::function<void()> draw_profile = [] {};
};

// @param i  number of the pair, from 0: of several, each has its own files
Comparison compare_images(ImagePair pair, const CompareOptions& o, size_t i = 0) {
  const Metrics m = compare(pair.reference, pair.image);
  Comparison made{std::move(pair.facts)};
  made.facts.update(Json{{"psnr_db", number(m.psnr)},
                         {"psnr_of_black_db", number(psnr_of_black(pair.reference))},
                         {"psnr_unscaled_db", number(m.psnr_unscaled)},
                         {"ssim", number(m.ssim)},
                         {"ssim_unscaled", number(m.ssim_unscaled)},
                         {"scale", number(m.scale)},
                         {"rms_error", number(m.rms_error)},
                         {"speckle_contrast", number(m.speckle_contrast)},
                         {"bright_fraction", number(m.bright_fraction)},
                         {"power_ratio", number(m.power_ratio)},
                         {"uniformity", number(m.uniformity)},
                         {"psnr_amplitude_db", number(m.psnr_amplitude)},
                         {"lit_fraction_of_reference", lit_fraction(pair.reference)},
                         {"lit_fraction", lit_fraction(pair.image)}});
  if (!o.difference.empty()) {
    const DifferenceImage difference = difference_image(pair.reference, pair.image, m.scale, o.difference_range);
    save_image(numbered_path(o.difference, i), difference.image, 1, 8);
    made.facts["difference_at_full_colour"] = difference.range;
  }
  if (!o.profile.empty())
    made.draw_profile = [path = numbered_path(o.profile, i), scale = m.scale, pair = std::move(pair)] {
      save_chart(path, profile_chart(pair.reference, pair.image, scale,
                                     {pair.rows, pair.columns, pair.first_row, pair.first_column}));
    };
  return made;
}

void compare_files(const CompareOptions& o, Console& console) {
  const Comparison made = compare_images(o.is_registered ? registered_pair(o, console) : image_pair(o.a, o.b), o);
  print_facts(made.facts, o.is_json);
  std::fflush(stdout);
  made.draw_profile();
}

// Two pictures to compare, and the plane that both show.
struct Pictures {
  std::string reference, image;
  std::optional<double> distance;
};

// The views of two runs, in their order.
std::vector<Pictures> views_of_both(const std::string& a, const std::string& b) {
  const RunFolder first = list_complete_run(a), second = list_complete_run(b);
  require(!first.views.empty() && first.views.size() == second.views.size(),
          "expected two runs with as many views, got {} in {} and {} in {}; compare single views", first.views.size(),
          a, second.views.size(), b);
  std::vector<Pictures> pairs;
  for (size_t i = 0; i < first.views.size(); ++i) {
    const auto of_first = render_of_view(first.views[i]), of_second = render_of_view(second.views[i]);
    pairs.push_back({first.views[i], second.views[i], std::nullopt});
    if (!of_first || !of_second) continue;  // without renders, the reports do not say where the views are in focus
    const double distance = of_first->place.distance, other = of_second->place.distance;
    require(
        std::abs(distance / other - 1) < 1e-9,
        "expected views of the same planes, but {} is in focus at {} and {} at {}; run both with the same distances, "
        "or compare single views",
        first.views[i], format_length(distance), second.views[i], format_length(other));
    pairs.back().distance = distance;
  }
  return pairs;
}

// The views of a run and their renders, or the views of two runs.
void compare_folders(const CompareOptions& o) {
  std::vector<Pictures> pairs;
  if (o.b.empty())
    for (const RenderedView& one : rendered_views(o.a)) pairs.push_back({one.render, one.view, one.distance});
  else
    pairs = views_of_both(o.a, o.b);
  std::vector<Comparison> comparisons;
  for (size_t i = 0; i < pairs.size(); ++i) {
    Comparison made = compare_images(image_pair(pairs[i].reference, pairs[i].image), o, i);
    Json facts{{"view", pairs[i].image}, {"reference", pairs[i].reference}};
    if (pairs[i].distance) facts["distance"] = format_length(*pairs[i].distance);
    facts.update(made.facts);
    made.facts = std::move(facts);
    comparisons.push_back(std::move(made));
  }
  Json views = Json::array();
  for (const Comparison& made : comparisons) views.push_back(made.facts);
  if (o.is_json) print_facts({{"views", views}}, true);
  for (size_t i = 0; i < views.size() && !o.is_json; ++i) {
    if (i > 0) fmt::print("\n");
    print_facts(views[i], false);
  }
  std::fflush(stdout);
  for (const Comparison& made : comparisons) made.draw_profile();
}

// Refuses flags that have no effect on the requested comparison.
void check_flags(const CompareOptions& o, bool is_field) {
  require(!o.is_registered || !is_folder(o.a),
          "--register is for a photograph and a picture, but {} is the folder of a run; name its view", o.a);
  for (const auto& [flag, is_given] : {std::pair{"--register", o.is_registered},
                                       {"--difference", !o.difference.empty()},
                                       {"--profile", !o.profile.empty()}})
    require(!is_given || !is_field, "{0} is for images, but {1} is a field: leave out {0}", flag, o.a);
  for (const auto& [flag, is_given] : {std::pair{"-o", !o.output.empty()},
                                       {"--smallest-scale", o.flags.has("smallest_scale")},
                                       {"--largest-scale", o.flags.has("largest_scale")},
                                       {"--offset", o.flags.has("offset")}})
    require(!is_given || o.is_registered, "{0} needs --register; add --register, or leave out {0}", flag);
  check_flag("--difference-range", o.difference_range, range::not_negative, Quantity::number);
  require(o.difference_range == 0 || !o.difference.empty(),
          "--difference-range needs a picture of the difference; add --difference FILE.png");
  if (!o.output.empty()) check_output(o.output, image_endings);
  if (!o.difference.empty()) check_output(o.difference, {".png"});
  if (!o.profile.empty()) check_output(o.profile, {".png", ".svg"});
}

}  // namespace

void add_compare_command(CLI::App& app, const GlobalFlags& global) {
  CLI::App* command = app.add_subcommand(
      "compare",
      "differences between two images, between two fields (.npy, .h5, .exr), between the views and the "
      "renders of a run, or between the views of two runs");
  auto o = std::make_shared<CompareOptions>();
  command
      ->add_option(
          "a", o->a,
          "reference image or field; with --register: the photograph; folder of a run: its views are compared with "
          "its renders or, if B is a folder too, are the reference for the views of B")
      ->required()
      ->type_name("A|DIR");
  command
      ->add_option(
          "b", o->b,
          "image or field that is compared with A; with --register: the simulation, which is then the reference; if "
          "A is the folder of a run: the folder of a second run")
      ->type_name("B|DIR");
  command->add_flag("--json", o->is_json, "as JSON");
  command
      ->add_option(
          "--difference", o->difference,
          "picture of the difference: red where brighter than the reference, blue where darker; several views: NAME, "
          "NAME_2, …")
      ->type_name("FILE");
  command
      ->add_option("--difference-range", o->difference_range, "difference that is shown in full colour [the largest]")
      ->type_name("NUMBER");
  command
      ->add_option("--profile", o->profile,
                   "chart of both images along the middle row: .png or .svg; several views: NAME, NAME_2, …")
      ->type_name("FILE");
  command->add_flag("--register", o->is_registered,
                    "align the photograph a with the simulation b before the comparison");
  command->add_option("-o,--output", o->output, "with --register: the aligned photograph on the simulation's pixels")
      ->type_name("FILE");
  o->flags.add(*command, RegisterParams(), {}, "with --register");
  command->callback([o, &global] {
    if (is_folder(o->a) && (o->b.empty() || is_folder(o->b))) {
      check_flags(*o, false);
      return compare_folders(*o);
    }
    if (o->b.empty()) throw CLI::RequiredError("B (b), or the folder of a run as A");
    require(!is_folder(o->a) && !is_folder(o->b),
            "expected two files, or the folders of two runs, got a file and the folder {}; name a view in the folder",
            is_folder(o->a) ? o->a : o->b);
    check_file_exists(o->a, "an image, a field or the folder of a run");
    check_file_exists(o->b, "an image or a field");
    const bool is_field = is_field_file(o->a);
    require(is_field == is_field_file(o->b),
            "expected two images or two fields to compare, got the {} {} and the {} {}; make an image of a field "
            "with `holotrace encode` and `holotrace show`",
            is_field ? "field" : "image", o->a, is_field ? "image" : "field", o->b);
    check_flags(*o, is_field);
    Console console(global.is_quiet);
    if (is_field)
      print_facts(field_facts(load_fields_double(o->a, global.outside()), load_fields_double(o->b, global.outside())),
                  o->is_json);
    else
      compare_files(*o, console);
  });
}

}  // namespace holotrace
