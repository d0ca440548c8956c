#pragma once

#include "holotrace/base/array.h"
#include "holotrace/data/image.h"
#include "holotrace/data/params/trace.h"

namespace holotrace {

/// A picture and the depth of each of its pixels (RGB-D); both have the same size.
struct DepthImage {
  Image picture;         ///< linear light, 1 or 3 channels; 1 is white
  Array2D<float> depth;  ///< depth behind the panel, below 0 in front of it [m]; 0: nothing there
};

/// Position of the picture's pixels in space. Orthographic: side by side as on a slide, at the same width in every
/// slice of depth. Perspective: on the rays from the panel's centre through them.
enum class Projection { orthographic, perspective };

/// Quantity that the grey values of a depth picture have in equal steps: the depth, or its inverse (disparity).
enum class DepthScale { depth, disparity };

/// How a picture with depth becomes light.
struct DepthImageParams {
  /// Depths of white and black [m], below 0 in front of the panel; both 0: the file has metres.
  double near = 0, far = 0;
  DepthScale scale = DepthScale::depth;              ///< what is in equal steps between them
  double width = 0;                                  ///< width of the picture [m]; 0: the panel's (orthographic)
  Projection projection = Projection::orthographic;  ///< projection of the pixels into space
  double field_of_view = 0;                          ///< half angle over the width [rad]; 0: the panel's acceptance
  SourcePhase phase = SourcePhase::random;           ///< phase of the light, random or constant
  int64_t seed = 1;                                  ///< seed for random phases
  bool has_common_cone = true;                       ///< all wavelengths keep to the cone of the shortest
};

template <class Visitor>
void describe(Visitor&& v, DepthImageParams& p) {
  v(length("near", p.near, range::any,
           "depth of white in the depth image, behind the panel; below 0: in front of it; larger than that of black if "
           "black is nearer; not for EXR files, whose values are metres"));
  v(length("far", p.far, range::any, "depth of black in the depth image, behind the panel; below 0: in front of it"));
  v(choice("depth_scale", p.scale, {{"depth", DepthScale::depth}, {"disparity", DepthScale::disparity}},
           "quantity in equal steps of grey between white and black: the depth, or its inverse (disparity), as stereo "
           "cameras and many depth estimators give it"));
  v(length("width", p.width, range::not_negative, "orthographic: width of the picture; 0 m: the panel's"));
  v(choice("projection", p.projection,
           {{"orthographic", Projection::orthographic}, {"perspective", Projection::perspective}},
           "projection of the picture: the same width at every depth, or perspective from the panel's centre"));
  v(angle("field_of_view", p.field_of_view, range::half_angle,
          "perspective: half angle over the width; 0 deg: the panel's acceptance asin(lambda/2p)"));
  v(choice("phase", p.phase, {{"random", SourcePhase::random}, {"constant", SourcePhase::constant}},
           "phase of the light: random (scatters everywhere, with speckle) or constant (0: smooth, sent "
           "straight ahead)"));
  v(count("seed", p.seed, range::not_negative, "seed for random phases"));
  v(flag("common_cone", p.has_common_cone,
         "common cone for all wavelengths, that of the shortest; avoids a coloured border of the view; false: each "
         "wavelength uses its own cone"));
}

/// Takes as empty (depth 0) what can show no light: pixels whose depth is not finite or 10 km or more, and dark pixels behind all that have
/// light, which hide nothing.
void leave_out_empty_pixels(DepthImage& image);

/// @throws Error  for sizes that differ or are 0, for light that is negative, light or depths that are not finite, and no pixel with a depth
void check_depth_image(const DepthImage& image);

}  // namespace holotrace
