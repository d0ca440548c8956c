#include "depth_image_flags.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "holotrace/base/units.h"
#include "holotrace/data/acceptance.h"
#include "holotrace/io/picture/depth_image_file.h"
#include "holotrace/wave/layers/depth_layers.h"
#include "holotrace/wave/synthesize.h"

namespace holotrace {
namespace {

using namespace literals;

constexpr const char* group =
    "A picture with depths (RGB-D), for example: field picture.png --depth depth.png --near \"195 mm\" "
    "--far \"205 mm\" --width \"8 mm\" --slices 100 -o f.npy";

bool is_picture(const std::string& path) {
  std::string extension = std::filesystem::path(path).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  return extension == ".png" || extension == ".jpg" || extension == ".jpeg" || extension == ".exr" ||
         extension == ".tif" || extension == ".tiff";
}

}  // namespace

void DepthImageFlags::add(Command& command) {
  command
      .add_option("--depth", depth_,
                  "depth of each pixel of the picture: grey of 8 or 16 bits, brighter is nearer; or EXR in metres")
      ->type_name("IMAGE")
      ->group(group);
  flags_.add(command, DepthImageParams(), {}, group);
}

bool DepthImageFlags::check(const std::vector<std::string>& inputs, bool is_double) const {
  if (depth_.empty()) {
    for (const char* name : {"near", "far", "width", "projection", "field_of_view", "phase", "seed", "common_cone"})
      require(!flags_.has(name),
              "expected --depth with {}, which describes a picture with depths; give both or neither", dashed(name));
    require(!is_picture(inputs.front()), "{}: expected --depth with a picture, got none; give its depth image",
            inputs.front());
    return false;
  }
  require(inputs.size() == 1, "expected one picture with --depth, got {} inputs", inputs.size());
  require(is_picture(inputs.front()), "{}: expected a picture (.png, .jpg, .tif, .exr) with --depth; leave out --depth",
          inputs.front());
  require(!is_double,
          "expected --double with a scene or sources, which it sums wave by wave; got a picture with depths");
  return true;
}

std::vector<Field> DepthImageFlags::fields(const std::string& picture, const Grid& panel,
                                           std::vector<double> wavelengths, uint32_t frame, const Flags& synthesis,
                                           const Observer& observer) const {
  DepthImageParams params;
  flags_.apply(params);
  SynthesizeParams synthesize;
  synthesis.apply(synthesize);
  require(synthesize.method == SynthesisMethod::automatic || synthesize.method == SynthesisMethod::layers,
          "--method: expected layers for a picture with depths, got {}; leave it out", method_name(synthesize.method));
  const DepthImage image = load_depth_image(picture, depth_, params.near, params.far);
  if (wavelengths.empty()) wavelengths = {532_nm};
  const double cone = view_wavelength(wavelengths, params.has_common_cone);
  // One field of view for all colours: separate ones would show the picture at different sizes.
  if (params.projection == Projection::perspective && params.field_of_view == 0 && wavelengths.size() > 1)
    params.field_of_view = std::asin(acceptance_sine(cone, panel.pitch));
  const bool has_cone = params.has_common_cone && wavelengths.size() > 1;
  std::vector<Field> fields;
  for (size_t i = 0; i < wavelengths.size(); ++i)
    fields.push_back(sum_depth_image(image, panel, {wavelengths[i], has_cone ? cone : 0}, params, synthesize, frame,
                                     part_of(observer, int(i), int(wavelengths.size()))));
  return fields;
}

}  // namespace holotrace
