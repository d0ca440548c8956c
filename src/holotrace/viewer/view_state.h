#pragma once

#include <cstddef>
#include <vector>

#include "holotrace/data/params/camera.h"
#include "holotrace/data/params/propagate.h"
#include "holotrace/data/params/show.h"

namespace holotrace {

/// What the page asks to see: the settings of `holotrace show`, and some of the session's holograms.
struct ViewState {
  ShowParams show;
  CameraParams camera;  ///< one distance, no sweep
  PropagateParams propagation;
  std::vector<size_t> shown{};  ///< numbers of the holograms, from 0; empty: all of them
  bool is_draft = false;  ///< coarser and faster, while something moves: one frame, samples instead of pixel areas
  int step = 1;           ///< of a draft: 2 means only every second pixel of every second row
};

}  // namespace holotrace
