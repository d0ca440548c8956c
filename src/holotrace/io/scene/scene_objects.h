#pragma once

#include <map>
#include <set>
#include <string>
#include <tuple>
#include <vector>

#include "holotrace/data/job.h"
#include "holotrace/io/mesh/mesh_file.h"
#include "holotrace/io/scene/toml_table.h"

namespace holotrace {

/// Reads the objects of a scene file, the tables [[object]] and [[shape.NAME]], and adds their meshes and
/// points to a job's scene. Add materials and shapes before objects.
class SceneObjects {
 public:
  /// @param job  receives materials, meshes, points and warnings; must outlive this object
  /// @param outside  whether models may name files outside their folders
  SceneObjects(Job& job, Outside outside) : job_(job), outside_(outside) {}

  void add_material(const std::string& name, const Material& material);
  void add_shapes(TomlTable& shapes);  ///< the table with all [[shape.NAME]]

  /// @throws Error with file:line:column for unknown types, keys and names, for errors in a shape or a
  ///         file, and for an object that reaches the panel (z ≥ 0)
  void add_object(TomlTable object);

  /// Reads the shapes that no object uses, to report errors in them.
  void check_unused_shapes();

  /// Warns of models of which a camera sees little: the unit of a file is not always the one that its user thinks. The job is complete.
  void warn_of_models_beside_the_view();

 private:
  // Meshes and points before they are added to the scene; material -1: set by the code that uses them.
  struct Geometry {
    std::vector<Mesh> meshes;
    std::vector<ScenePoint> points;
    std::vector<Light> lights{};
    bool is_animated = false;  // parts of it may be hidden at this time
  };

  struct Model {
    LoadedModel loaded;
    int first_material = -1;  // index of its first material in the scene; -1: not added yet
  };

  Geometry read_object(TomlTable& object);
  /// Gives the scaled parts of models that absorb light materials of their own.
  void scale_absorption_of_models(double factor, Geometry& geometry);
  void check_growth(TomlTable& object, const Geometry& geometry, size_t copies);
  Geometry read_type(TomlTable& object, const std::string& type);
  Geometry read_shape(TomlTable& object);
  Geometry read_parts(const std::string& shape);
  Geometry read_mesh_file(TomlTable& object);
  Geometry read_picture(TomlTable& object);
  /// A model where a camera of its file sees it (CameraPlacing).
  Geometry placed_by_camera(TomlTable& object, const std::string& camera, Geometry local);
  void add_warning(const std::string& sentence);  ///< once

  struct PlacedModel {
    std::string where;  ///< in the file
    Vec3 low, high;     ///< bounds [m]
  };
  std::vector<PlacedModel> models_placed_;  ///< of files and arrays that rest, each in one place
  Model& load_model(TomlTable& object, const PoseTime& at);
  PoseTime pose_of(TomlTable& object);
  int read_material_name(TomlTable& object);
  std::string read_file_name(TomlTable& object, const char* key);

  Job& job_;
  Outside outside_;
  std::map<std::string, int> materials_;
  std::map<std::string, std::vector<TomlTable>> shapes_;
  std::set<std::string> open_shapes_;  // shapes being read, to refuse a shape that contains itself
  size_t objects_ = 0;                 // objects read, parts of shapes each time anew
  std::set<std::string> used_shapes_;
  // By file, pose, variant and files per second.
  std::map<std::tuple<std::string, double, std::string, bool, std::string, double>, Model> models_;
  std::set<int> materials_of_models_;             // those that absorb light
  std::map<std::pair<int, double>, int> scaled_;  // the same of models that are scaled, by material and factor
  int default_material_ = -1;
};

}  // namespace holotrace
