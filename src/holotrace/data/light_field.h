#pragma once

#include <vector>

#include "holotrace/data/grid.h"
#include "holotrace/data/image.h"

namespace holotrace {

/// The light that leaves a panel, by place and direction: one picture for each cell of a lens, which is the panel itself or a
/// part of a plane in front of it. The pixels of all pictures are in one plane behind the panel.
struct LightField {
  Grid panel;                 ///< the panel: rays pass it within its acceptance
  Grid lens;                  ///< divided evenly into cells; its own samples do not matter
  double lens_z = 0;          ///< z of the lens [m]: 0, or in front of the panel
  int columns = 0, rows = 0;  ///< number of cells along each side of the lens; row 0 is the top row
  Grid plane;                 ///< pixels of the pictures, in the plane z = −distance
  double distance = 0;        ///< distance of that plane from the panel [m]
  /// Mean radiance [W/m²/sr] of the rays from cell (column, row) through each pixel, at views[row·columns + column];
  /// 1 or 3 channels, shape of `plane`.
  std::vector<Image> views;

  /// The same without its pictures.
  LightField without_views() const { return {panel, lens, lens_z, columns, rows, plane, distance, {}}; }

  double cell_width() const { return lens.width() / columns; }
  double cell_height() const { return lens.height() / rows; }
  double left() const { return lens.centre_x - lens.width() / 2; }  ///< left side of the lens [m]
  double top() const { return lens.centre_y + lens.height() / 2; }  ///< upper side of the lens [m]
};

/// @throws Error unless the light field has cells, for each a picture of the size of its plane with one number of channels, 1 or
///         3, a lens that is not behind the panel, and a plane at a finite distance that is not that of the lens.
void check_light_field(const LightField& field);

/// @throws Error for a view with a value that is not finite, or below 0
void check_radiance(const LightField& field);

/// Pictures of one scene in several planes behind the panel or in front of it, each with that plane in focus. The panel is the lens: a
/// pixel is the mean radiance of the rays that leave the panel and, followed backwards, cross the pixel.
struct FocalStack {
  Grid grid;                      ///< pixels of every plane, centred on the axis, with the panel's pitch
  std::vector<double> distances;  ///< distances of the planes from the panel [m], negative in front of it
  std::vector<Image> pictures;    ///< linear radiance [W/m²/sr], one per plane, 1 or 3 channels, shape of `grid`
};

/// @throws Error unless the stack has planes at finite distances other than 0, and for each a picture of the grid's size with
///         one number of channels, 1 or 3, and finite values of 0 or more.
void check_focal_stack(const FocalStack& stack);

}  // namespace holotrace
