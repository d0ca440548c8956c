#include "depth_image_flags.h"

#include <utility>

#include "holotrace/io/files/file.h"
#include "holotrace/io/picture/depth_image_file.h"
#include "holotrace/io/picture/image_file.h"
#include "holotrace/run/depth_image_fields.h"

namespace holotrace {
namespace {

constexpr const char* group =
    "A picture with depths (RGB-D), for example: field picture.png --depth depth.png --near \"195 mm\" "
    "--far \"205 mm\" --width \"8 mm\" --slices 100 -o f.npy";

}  // namespace

void DepthImageFlags::add(CLI::App& command) {
  command
      .add_option(
          "--depth", depth_,
          "depth of each pixel of the picture: grey of 8 or 16 bits, from --near (white) to --far (black); or EXR in "
          "metres")
      ->type_name("IMAGE")
      ->group(group);
  flags_.add(command, DepthImageParams(), {}, group);
}

bool DepthImageFlags::check(const std::vector<std::string>& inputs, bool is_double) const {
  if (depth_.empty()) {
    for (const char* name :
         {"near", "far", "depth_scale", "width", "projection", "field_of_view", "phase", "seed", "common_cone"})
      require(!flags_.has(name),
              "expected --depth with {}, which describes a picture with depths; give both or neither", dashed(name));
    require(!has_image_ending(inputs.front()), "{}: expected --depth with a picture, got none; give its depth image",
            inputs.front());
    return false;
  }
  require(inputs.size() == 1, "expected one picture with --depth, got {} inputs", inputs.size());
  require(has_image_ending(inputs.front()),
          "{}: expected a picture (.png, .jpg, .tif, .exr) with --depth; leave out --depth", inputs.front());
  require(extension_of(depth_) == ".exr" || (flags_.has("near") && flags_.has("far")),
          "{}: expected --near and --far, the depths of its white and black; give both", depth_);
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
  DepthImage image = load_depth_image(picture, depth_, params.near, params.far, params.scale);
  return depth_image_fields({std::move(image), panel, std::move(wavelengths), params, synthesize, frame}, observer);
}

}  // namespace holotrace
