#pragma once

#include <string>
#include <vector>

#include "holotrace/data/params/camera.h"
#include "holotrace/data/params/encode.h"
#include "holotrace/data/params/propagate.h"
#include "holotrace/data/params/render.h"
#include "holotrace/data/params/show.h"
#include "holotrace/data/params/synthesize.h"
#include "holotrace/data/params/trace.h"
#include "holotrace/data/scene.h"
#include "holotrace/data/slm.h"

namespace holotrace {

/// All that a scene file says: the scene, the light, the panel, and the parameters of each stage.
struct Job {
  Scene scene;
  std::vector<double> wavelengths;  ///< [m], at least one; the first is that of single-coloured commands
  Slm slm;
  TraceParams trace;
  RenderParams render;
  SynthesizeParams synthesize;
  EncodeParams encode;
  ShowParams show;
  PropagateParams propagate;
  CameraParams camera;
  std::vector<std::string> warnings;  ///< what the files ask for and is not shown, and old names of keys
};

}  // namespace holotrace
