#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "holotrace/data/job.h"
#include "holotrace/io/mesh/mesh_file.h"
#include "holotrace/io/scene/toml_table.h"

namespace holotrace {

/// The objects of a scene file: reads [[object]] and [[shape.NAME]] tables and puts their meshes and
/// points into a job's scene. Materials and shapes come first.
class SceneObjects {
 public:
  /// @param job  gets materials, meshes, points and warnings; outlives this
  explicit SceneObjects(Job& job) : job_(job) {}

  void add_material(const std::string& name, const Material& material);
  void add_shapes(TomlTable& shapes);  ///< the table that holds every [[shape.NAME]]

  /// @throws Error with file:line:column for unknown types, keys and names, for what a shape or a
  ///         file refuses, and for an object that reaches the panel (z ≥ 0)
  void add_object(TomlTable object);

  /// Reads the shapes that no object showed, for the errors in them.
  void check_unused_shapes();

 private:
  // Meshes and points on their way to the scene; material -1 is for whoever uses them to say.
  struct Geometry {
    std::vector<Mesh> meshes;
    std::vector<ScenePoint> points;
  };

  Geometry read_object(TomlTable& object);
  Geometry read_type(TomlTable& object, const std::string& type);
  Geometry read_shape(TomlTable& object);
  Geometry read_parts(const std::string& shape);
  Geometry read_mesh_file(TomlTable& object);
  int read_material_name(TomlTable& object);
  std::string read_file_name(TomlTable& object, const char* key);

  struct Model {
    LoadedModel loaded;
    int first_material = -1;  // where its materials stand in the scene; -1: not there yet
  };

  Job& job_;
  std::map<std::string, int> materials_;
  std::map<std::string, std::vector<TomlTable>> shapes_;
  std::set<std::string> open_shapes_;  // being read, to stop a shape that holds itself
  std::set<std::string> used_shapes_;
  std::map<std::string, Model> models_;
  int default_material_ = -1;
};

}  // namespace holotrace
