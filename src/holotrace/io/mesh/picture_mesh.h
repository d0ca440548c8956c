#pragma once

#include <string>

#include "holotrace/data/depth_image.h"
#include "holotrace/io/files/series.h"
#include "holotrace/io/mesh/mesh_file.h"

namespace holotrace {

/// A picture that shines, or pictures that follow each other: a series (io/files/series.h), or a film.
struct PictureSource {
  std::string file;
  std::string depth{};       ///< depth of each pixel; a series or a film if `file` is one; "": the picture is flat
  double near = 0, far = 0;  ///< as load_depth_image takes them
  DepthScale scale = DepthScale::depth;
};

/// Whether a path names pictures that follow each other: a series of pictures, or a film (is_film_file).
bool is_picture_series(const std::string& path);

/// The picture of a source at a time as a surface that faces +z and reflects nothing: its radiance is the light of the picture, 1 for
/// white [W/m²/sr]. It is one rectangle about the z axis at z = 0; with depths it is one for each pixel, at z = −depth, and pixels without
/// a depth are left out.
///
/// Light between the centres of pixels is interpolated.
/// @param width  of the picture [m]; pixels are square
/// @param time   of a series; the rate of a film is that of its file
/// @throws Error as load_image, load_depth_image, file_at and read_film_picture do
LoadedModel load_picture(const PictureSource& source, double width, const SeriesTime& time = {});

}  // namespace holotrace
