// holotrace compare: the difference between two images, or two fields.

#include <algorithm>
#include <cstdio>
#include <memory>
#include <utility>
#include <vector>

#include "commands.h"
#include "console.h"
#include "facts.h"
#include "flags.h"
#include "holotrace/base/error.h"
#include "holotrace/base/units.h"
#include "holotrace/io/field/field_file.h"
#include "holotrace/io/files/file.h"
#include "holotrace/io/files/output.h"
#include "holotrace/io/picture/chart_file.h"
#include "holotrace/io/picture/image_file.h"
#include "holotrace/view/compare.h"
#include "holotrace/view/difference.h"
#include "holotrace/view/profile.h"
#include "holotrace/view/register/align_image.h"
#include "holotrace/view/register/register.h"
#include "image_pair.h"

namespace holotrace {
namespace {

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

void compare_images(const CompareOptions& o, Console& console) {
  ImagePair pair = o.is_registered ? registered_pair(o, console) : image_pair(o.a, o.b);
  const Metrics m = compare(pair.reference, pair.image);
  Json& facts = pair.facts;
  facts.update(Json{{"psnr_db", number(m.psnr)},
                    {"psnr_unscaled_db", number(m.psnr_unscaled)},
                    {"ssim", number(m.ssim)},
                    {"ssim_unscaled", number(m.ssim_unscaled)},
                    {"scale", number(m.scale)},
                    {"rms_error", number(m.rms_error)},
                    {"speckle_contrast", number(m.speckle_contrast)},
                    {"diffraction_efficiency", number(m.bright_fraction)},
                    {"power_ratio", number(m.power_ratio)},
                    {"uniformity", number(m.uniformity)},
                    {"psnr_amplitude_db", number(m.psnr_amplitude)}});
  if (!o.difference.empty()) {
    const DifferenceImage difference = difference_image(pair.reference, pair.image, m.scale, o.difference_range);
    save_image(o.difference, difference.image, 1, 8);
    facts["difference_at_full_colour"] = difference.range;
  }
  print_facts(facts, o.is_json);
  std::fflush(stdout);
  if (!o.profile.empty())
    save_chart(o.profile, profile_chart(pair.reference, pair.image, m.scale,
                                        {pair.rows, pair.columns, pair.first_row, pair.first_column}));
}

// Refuses flags that have no effect on the requested comparison.
void check_flags(const CompareOptions& o, bool is_field) {
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
  if (!o.output.empty()) check_output(o.output, {".png", ".exr"});
  if (!o.difference.empty()) check_output(o.difference, {".png"});
  if (!o.profile.empty()) check_output(o.profile, {".png", ".svg"});
}

}  // namespace

void add_compare_command(Command& app, const GlobalFlags& global) {
  Command* command =
      app.add_subcommand("compare", "differences between two images, or between two fields (.npy, .h5, .exr)");
  auto o = std::make_shared<CompareOptions>();
  command->add_option("a", o->a, "reference; with --register the photograph")->required()->type_name("A");
  command
      ->add_option(
          "b", o->b,
          "image or field that is compared with it; with --register the simulation, which is then the reference")
      ->required()
      ->type_name("B");
  command->add_flag("--json", o->is_json, "as JSON");
  command
      ->add_option("--difference", o->difference,
                   "picture of the difference: red where brighter than the reference, blue where darker")
      ->type_name("FILE");
  command
      ->add_option("--difference-range", o->difference_range, "difference that is shown in full colour [the largest]")
      ->type_name("NUMBER");
  command->add_option("--profile", o->profile, "chart of both images along the middle row: .png or .svg")
      ->type_name("FILE");
  command->add_flag("--register", o->is_registered,
                    "align the photograph a with the simulation b before the comparison");
  command->add_option("-o,--output", o->output, "with --register: the aligned photograph on the simulation's pixels")
      ->type_name("FILE");
  o->flags.add(*command, RegisterParams(), {}, "with --register");
  command->callback([o, &global] {
    check_file_exists(o->a, "an image or a field");
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
      compare_images(*o, console);
  });
}

}  // namespace holotrace
