#pragma once

#include <vector>

#include "holotrace/data/grid.h"
#include "holotrace/data/image.h"

namespace holotrace {

/// The light that leaves a panel, by place and direction: one picture for each cell of the panel. The pixels of all
/// pictures are in one plane behind the panel.
struct LightField {
  Grid panel;                 ///< the panel, divided evenly into cells
  int columns = 0, rows = 0;  ///< number of cells along each side of the panel; row 0 is the top row
  Grid plane;                 ///< pixels of the pictures, in the plane z = −distance
  double distance = 0;        ///< distance of that plane from the panel [m]
  /// Mean radiance [W/m²/sr] of the rays from cell (column, row) through each pixel, at views[row·columns + column];
  /// 1 or 3 channels, shape of `plane`.
  std::vector<Image> views;

  double cell_width() const { return panel.width() / columns; }
  double cell_height() const { return panel.height() / rows; }
  double left() const { return panel.centre_x - panel.width() / 2; }  ///< left side of the panel [m]
  double top() const { return panel.centre_y + panel.height() / 2; }  ///< upper side of the panel [m]
};

}  // namespace holotrace
