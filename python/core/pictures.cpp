// Images and focal stacks.

#include <nanobind/stl/vector.h>

#include "arrays.h"
#include "holotrace/denoise/denoise.h"
#include "holotrace/io/field/light_field_file.h"
#include "holotrace/io/picture/image_file.h"
#include "holotrace/view/camera.h"
#include "nouns.h"
#include "values.h"
#include "watch.h"

namespace holotrace::python {
namespace {

Image make_image(const In3<float>& values, nb::handle pitch) {
  const size_t channels = values.shape(2);
  require(channels == 1 || channels == 3, "expected 1 or 3 channels in an image, got {}", channels);
  require(values.size() > 0, "expected rows and columns in an image, got an array of the shape ({}, {}, {})",
          values.shape(0), values.shape(1), channels);
  Image image(int(values.shape(0)), int(values.shape(1)), int(channels));
  std::copy(values.data(), values.data() + values.size(), image.values.begin());
  check_finite(values.data(), values.size(), values.shape(1) * channels, "an image");
  image.pitch = to_length(pitch, "pitch");
  check_named(image.pitch, range::not_negative, Quantity::length, "pitch");
  return image;
}

nb::object pixels(nb::handle self, const Image& image) {
  const size_t rows = size_t(image.ny), columns = size_t(image.nx);
  return image.channels == 1 ? view(self, image.values.data(), {rows, columns})
                             : view(self, image.values.data(), {rows, columns, size_t(image.channels)});
}

FocalStack make_stack(const std::vector<Image>& pictures, nb::handle distances, nb::handle pitch) {
  FocalStack stack;
  stack.pictures = pictures;
  stack.distances = to_lengths(distances, "distances");
  require(!pictures.empty(), "expected pictures of one plane or more in a focal stack, got none");
  stack.grid = {pictures.front().nx, pictures.front().ny, to_length(pitch, "pitch")};
  check_focal_stack(stack);
  return stack;
}

LightField make_light_field(const std::vector<Image>& views, int columns, nb::handle cell, nb::handle pitch,
                            nb::handle distance, nb::handle lens_z) {
  require(!views.empty() && columns > 0 && views.size() % size_t(columns) == 0,
          "expected the views of one cell or more in a light field, as rows of as many columns each, got {}",
          views.size());
  LightField field;
  field.columns = columns;
  field.rows = int(views.size()) / columns;
  field.lens = {columns, field.rows, to_length(cell, "cell")};
  field.lens_z = to_length(lens_z, "lens_z");
  field.plane = {views.front().nx, views.front().ny, to_length(pitch, "pitch")};
  field.distance = to_length(distance, "distance");
  field.views = views;
  check_light_field(field);
  check_radiance(field);
  return field;
}

Image denoise_image(const Image& image, const Image* albedo, const Image* normals, bool is_fast, Watch& watch) {
  return watch.run("denoise", [&](const Observer& observer) {
    observer.fact("denoiser", find_denoiser());
    DenoiseGuides guides;
    if (albedo) guides.albedo = *albedo;
    if (normals) guides.normals = *normals;
    return denoise(image, guides, is_fast ? DenoiseQuality::fast : DenoiseQuality::high, observer);
  });
}

}  // namespace

void bind_pictures(nb::module_& module) {
  nb::class_<Image> image(module, "Image");
  bind_bytes<Image>(image);
  image.def_static("make", &make_image, nb::arg("pixels"), nb::arg("pitch").none());
  image.def_prop_ro("pixels", [](nb::handle self) { return pixels(self, nb::cast<Image&>(self)); });
  image.def_prop_rw(
      "pitch", [](const Image& i) { return i.pitch; },
      [](Image& i, nb::handle pitch) { i.pitch = to_length(pitch, "pitch"); });
  image.def_prop_ro("channels", [](const Image& i) { return i.channels; });
  image.def("save", [](const Image& i, const std::string& path, double white, int bits) {
    const nb::gil_scoped_release release;
    save_image(path, i, white > 0 ? white : common_white({i}, 0), bits);
  });
  module.def("load_image", [](const std::string& path) {
    const nb::gil_scoped_release release;
    return load_image(path);
  });
  module.def("common_white", &common_white);
  module.def("denoise", &denoise_image, nb::arg("image"), nb::arg("albedo").none(), nb::arg("normals").none(),
             nb::arg("fast"), nb::arg("watch"));
  module.def("look_for_denoiser_in", &look_for_denoiser_in);

  nb::class_<FocalStack> stack(module, "FocalStack");
  bind_bytes<FocalStack>(stack);
  stack.def_static("make", &make_stack, nb::arg("pictures"), nb::arg("distances").none(), nb::arg("pitch").none());
  stack.def_ro("distances", &FocalStack::distances);
  stack.def_prop_ro("pitch", [](const FocalStack& s) { return s.grid.pitch; });
  stack.def_prop_ro("pictures", [](const FocalStack& s) { return s.pictures; });
  stack.def("save", [](const FocalStack& s, const std::string& path) {
    const nb::gil_scoped_release release;
    save_focal_stack(path, s);
  });
  nb::class_<LightField> light_field(module, "LightField");
  bind_bytes<LightField>(light_field);
  light_field.def_static("make", &make_light_field, nb::arg("views"), nb::arg("columns"), nb::arg("cell").none(),
                         nb::arg("pitch").none(), nb::arg("distance").none(), nb::arg("lens_z").none());
  light_field.def_ro("columns", &LightField::columns);
  light_field.def_ro("rows", &LightField::rows);
  light_field.def_prop_ro("cell", &LightField::cell_width);
  light_field.def_ro("lens_z", &LightField::lens_z);
  light_field.def_prop_ro("pitch", [](const LightField& f) { return f.plane.pitch; });
  light_field.def_ro("distance", &LightField::distance);
  light_field.def_ro("views", &LightField::views);
  light_field.def("save", [](const LightField& f, const std::string& path) {
    const nb::gil_scoped_release release;
    save_light_field(path, f);
  });
  module.def("load_light_field", [](const std::string& path, bool allow_outside) {
    const nb::gil_scoped_release release;
    return load_light_field(path, allow_outside ? Outside::allowed : Outside::refused);
  });
  module.def("load_focal_stack", [](const std::string& path, bool allow_outside) {
    const nb::gil_scoped_release release;
    return load_focal_stack(path, allow_outside ? Outside::allowed : Outside::refused);
  });
}

}  // namespace holotrace::python
