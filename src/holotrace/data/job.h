#pragma once

#include <string>
#include <vector>

#include "holotrace/data/params.h"
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
  std::vector<std::string> warnings;  ///< what the files ask for and is not shown
};

}  // namespace holotrace
