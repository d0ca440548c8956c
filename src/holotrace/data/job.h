#pragma once

#include <string>
#include <vector>

#include "holotrace/data/chosen.h"
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

/// The content of a scene file: the scene, the light, the panel, and the parameters of each stage.
struct Job {
  Scene scene;
  std::vector<double> wavelengths;  ///< wavelengths [m], at least one; single-coloured commands use the first
  Slm slm;
  TraceParams trace;
  RenderParams render;
  SynthesizeParams synthesize;
  EncodeParams encode;
  ShowParams show;
  PropagateParams propagate;
  CameraParams camera;
  bool are_distances_given = true;    ///< camera.distances; else choose_missing takes them from the scene's depths
  std::vector<std::string> warnings;  ///< features of the files that are not shown, and old names of keys
  std::vector<Chosen> chosen;         ///< what the job does not give, and was chosen for it (run/choose.h)
};

}  // namespace holotrace
