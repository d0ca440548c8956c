#pragma once

#include <vector>

#include "holotrace/data/params/trace.h"
#include "holotrace/trace/geometry/first_hits.h"
#include "holotrace/trace/paths/path.h"
#include "holotrace/trace/tiles.h"
#include "holotrace/trace/trace_report.h"
#include "holotrace/trace/waves/merge_waves.h"
#include "holotrace/trace/waves/wave_sets.h"

// The waves of single rays and points, before they are joined to sets (trace.cpp).

namespace holotrace {

/// Data shared by all rays of a tracing.
struct Tracing {
  const PathScene& scene;
  const TraceParams& params;
  const FirstHits* pattern;  // nullptr for a scene of points alone
  const std::vector<PanelTile>& tiles;
  const std::vector<WaveSet>& sets;
  double side;  // side of the cells of equal phase [m]
  const Grid& panel;
  double widest;  // wavelength whose acceptance contains all boxes [m]
};

/// Results of one task.
struct Block {
  std::vector<TracedWaves> sets;
  PathCounts counts;
  int64_t first_hits = 0, far_waves = 0;
  Brightness surfaces;
};

/// Follows ray `index` to its first hit and traces light there.
void trace_sample(const Tracing& t, int64_t index, Block& block);

/// Adds the luminous points that the panel's centre (for `tiled`: any tile) sees.
void add_points(const Tracing& t, std::vector<TracedWaves>& sets, Brightness& brightness);

}  // namespace holotrace
