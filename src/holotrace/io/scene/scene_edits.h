#pragma once

#include <toml++/toml.h>

#include <string>
#include <vector>

namespace holotrace {

/// A value of a scene file that is replaced before the scene is read.
struct SceneEdit {
  /// Where it stands: the names of tables and keys, and the numbers of lists from 1, joined by dots: "camera.pupil",
  /// "object.2.position"
  std::string key;
  /// TOML (0.5, [1, 0, 0], "3 mm"); what is none is a text: 3 mm
  std::string value;

  friend bool operator==(const SceneEdit&, const SceneEdit&) = default;
};

/// The edit of a text KEY=VALUE. @throws Error for a text without a key, a value, or the sign between them
SceneEdit parse_scene_edit(const std::string& text);

/// Puts the values into the tables of a scene. A table on the way that is not there is made; a list has no new elements.
/// Errors about such a value start with "--set KEY".
/// @param files  gets the name of each edit in errors
/// @throws Error for a key that leads through a value that is no table or list, and for numbers beyond a list
void apply_edits(const std::vector<SceneEdit>& edits, toml::table& scene, std::vector<std::string>& files);

/// Whether a value is of the kinds that editable_values lists: it cannot name a file.
bool is_editable(const SceneEdit& edit);

/// A value of a scene that may be changed.
struct SceneValue {
  SceneEdit edit;  ///< with the value that it has
  std::string of;  ///< what its table is: its type with its name or shape, such as "box" or "shape king"; "" if unknown

  friend bool operator==(const SceneValue&, const SceneValue&) = default;
};

/// What stands in the tables of a scene and may be changed while one looks: numbers, colours, and texts with a number, such as
/// lengths, places and rotations, of objects, the parts of shapes, lights, materials and surroundings, without keys over time;
/// and the place of an object that gives none.
std::vector<SceneValue> editable_values(const toml::table& scene);

}  // namespace holotrace
