// holotrace compare: how far two images, or two fields, differ.

#include <memory>
#include <vector>

#include "commands.h"
#include "facts.h"
#include "holotrace/base/error.h"
#include "holotrace/io/field_file.h"
#include "holotrace/io/file.h"
#include "holotrace/io/image_file.h"
#include "holotrace/view/compare.h"

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

// Of fields in colour: all wavelengths together, and each by itself where its reference has light.
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

}  // namespace

void add_compare_command(CLI::App& app, const GlobalFlags&) {
  CLI::App* command = app.add_subcommand("compare", "two images, or two fields (.npy, .h5, .exr): how far they differ");
  struct Options {
    std::string reference, other;
    bool is_json = false;
  };
  auto o = std::make_shared<Options>();
  command->add_option("a", o->reference, "the reference")->required()->type_name("A");
  command->add_option("b", o->other, "what is compared with it")->required()->type_name("B");
  command->add_flag("--json", o->is_json, "as JSON");
  command->callback([o] {
    check_file_exists(o->reference, "an image or a field");
    check_file_exists(o->other, "an image or a field");
    const bool is_field = is_field_file(o->reference);
    require(
        is_field == is_field_file(o->other),
        "expected two images or two fields to compare, got the {} {} and the {} {}; `holotrace show` makes images of "
        "fields by way of their hologram",
        is_field ? "field" : "image", o->reference, is_field ? "image" : "field", o->other);
    if (is_field) {
      print_facts(field_facts(load_fields_double(o->reference), load_fields_double(o->other)), o->is_json);
      return;
    }
    const Metrics m = compare(load_image(o->reference), load_image(o->other));
    print_facts({{"psnr_db", number(m.psnr)},
                 {"psnr_unscaled_db", number(m.psnr_unscaled)},
                 {"ssim", number(m.ssim)},
                 {"ssim_unscaled", number(m.ssim_unscaled)},
                 {"scale", number(m.scale)},
                 {"rms_error", number(m.rms_error)},
                 {"speckle_contrast", number(m.speckle_contrast)},
                 {"diffraction_efficiency", number(m.bright_fraction)},
                 {"power_ratio", number(m.power_ratio)},
                 {"uniformity", number(m.uniformity)}},
                o->is_json);
  });
}

}  // namespace holotrace
