#pragma once

#include <string>
#include <utility>
#include <vector>

#include "holotrace/data/field.h"
#include "holotrace/data/scene.h"
#include "holotrace/io/mesh/mesh_file.h"

namespace holotrace {

/// How far behind a panel models stand [m]: 19.5 panel widths, 300 mm for `pluto`.
double distance_of_models(const Grid& panel);

/// The frames that move, and that scale.
Frame shift(Vec3 by);
Frame scale(double factor);

void move(const Frame& frame, std::vector<Mesh>& meshes);

/// The distance up to which is a part of all areas; 0 if there are none.
double part_of(std::vector<std::pair<double, double>>& distances_and_areas, double part);

/// The camera of a model of that name or, if none has it, of that number, from 1.
/// @throws Error naming the file if it has no such camera
const ModelCamera& camera_named(const std::string& name, const std::string& path, const LoadedModel& model);

/// How models stand before the panel as a camera of their file sees them: the height of its picture, where half of what it sees is
/// nearer, is that of the panel.
class CameraPlacing {
 public:
  /// @param meshes    at the time by which the model is placed at all times
  /// @param distance  from the panel to where half of what the camera sees is nearer [m]
  /// @throws Error naming the file if nothing is in the camera's picture
  CameraPlacing(const std::string& path, const ModelCamera& camera, std::vector<Mesh> meshes, const Grid& panel,
                double distance);

  /// Places meshes, without what the camera does not see and would stand before what it sees: the panel's rays are nearly
  /// parallel, those of a camera come from one place.
  /// @return the frame by which they were moved
  Frame place(const ModelCamera& camera, std::vector<Mesh>& meshes) const;

 private:
  double distance_, aspect_, middle_ = 0, factor_ = 1;
};

}  // namespace holotrace
