#pragma once

#include "holotrace/data/image.h"

namespace holotrace {

/// What the surfaces in a picture look like without light: means over the same light paths as the picture's, on its
/// pixels. A denoiser tells edges and textures from noise by them. Both are empty where there are no guides.
///
/// A path's surface is the first one that scatters light. Mirrors and smooth glass show the surface behind them, in the
/// colour that they give it.
struct DenoiseGuides {
  Image albedo;   ///< fraction of the light that the surface reflects, in red, green and blue
  Image normals;  ///< unit normal on the viewer's side, three channels, x right, y up, z toward the viewer
};

}  // namespace holotrace
