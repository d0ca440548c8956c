#include "tables.h"

#include <limits>

#include "arrays.h"
#include "values.h"

namespace holotrace::python {
namespace {

template <class T>
In2<T> rows_of(nb::handle array, size_t columns, const char* what) {
  const auto rows = nb::cast<In2<T>>(array);
  require(rows.shape(1) == columns, "expected {} of the shape (n, {}), got ({}, {})", what, columns, rows.shape(0),
          rows.shape(1));
  return rows;
}

std::vector<Vec3> vectors_of(const nb::dict& dict, const char* key) {
  std::vector<Vec3> vectors;
  if (!dict.contains(key)) return vectors;
  const auto rows = rows_of<double>(dict[key], 3, key);
  for (size_t i = 0; i < rows.shape(0); ++i) {
    vectors.push_back({rows(i, 0), rows(i, 1), rows(i, 2)});
    require(is_finite(vectors.back()), "expected finite numbers in {}, got others in row {}", key, i);
  }
  return vectors;
}

void check_count(const char* what, size_t count, size_t vertices) {
  require(count == 0 || count == vertices, "expected one of {} for each of {} vertices, got {}", what, vertices, count);
}

// The package has converted the arrays: float64, and int64 for the faces.
Mesh to_mesh(const nb::dict& dict) {
  Mesh mesh;
  mesh.name = "the mesh of arrays";
  mesh.positions = vectors_of(dict, "vertices");
  mesh.normals = vectors_of(dict, "normals");
  mesh.colours = vectors_of(dict, "colours");
  for (Vec3& normal : mesh.normals) {
    require(length(normal) > 0, "expected normals longer than 0, got one of length 0");
    normal = normalize(normal);
  }
  if (dict.contains("uv")) {
    const auto rows = rows_of<double>(dict["uv"], 2, "uv");
    for (size_t i = 0; i < rows.shape(0); ++i) mesh.texture_coordinates.push_back({rows(i, 0), rows(i, 1)});
  }
  const size_t count = mesh.positions.size();
  check_count("normals", mesh.normals.size(), count);
  check_count("colours", mesh.colours.size(), count);
  check_count("uv", mesh.texture_coordinates.size(), count);
  const auto faces = rows_of<int64_t>(dict["faces"], 3, "faces");
  for (size_t i = 0; i < faces.shape(0); ++i) {
    for (size_t c = 0; c < 3; ++c)
      require(faces(i, c) >= 0 && faces(i, c) < int64_t(count),
              "expected indices of {} vertices in faces, got {} in row {}", count, faces(i, c), i);
    mesh.triangles.push_back({uint32_t(faces(i, 0)), uint32_t(faces(i, 1)), uint32_t(faces(i, 2))});
  }
  return mesh;
}

std::vector<ScenePoint> to_points(const nb::dict& dict) {
  const std::vector<Vec3> places = vectors_of(dict, "positions");
  const auto amplitudes = nb::cast<In1<float>>(dict["amplitudes"]), phases = nb::cast<In1<float>>(dict["phases"]);
  check_count("amplitudes", amplitudes.shape(0), places.size());
  check_count("phases", phases.shape(0), places.size());
  std::vector<ScenePoint> points(places.size());
  for (size_t i = 0; i < places.size(); ++i) points[i] = {places[i], amplitudes(i), phases(i)};
  return points;
}

class Converter {
 public:
  explicit Converter(SceneArrays& arrays) : arrays_(arrays) {}

  toml::table table(const nb::dict& dict) {
    toml::table table;
    for (const auto& [key, value] : dict) {
      require(PyUnicode_Check(key.ptr()), "expected texts as keys of a scene, got {}", shown(key));
      if (value.is_none()) continue;
      const std::string name = nb::cast<std::string>(key);
      toml::array one;
      append(value, name, one);
      table.insert(name, std::move(*one.begin()));
    }
    return table;
  }

 private:
  void append(nb::handle value, const std::string& key, toml::array& to) {
    if (PyUnicode_Check(value.ptr())) {
      to.push_back(nb::cast<std::string>(value));
    } else if (PyBool_Check(value.ptr())) {
      to.push_back(PyObject_IsTrue(value.ptr()) == 1);
    } else if (PyFloat_Check(value.ptr())) {
      to.push_back(PyFloat_AsDouble(value.ptr()));
    } else if (PyIndex_Check(value.ptr()) && !PySequence_Check(value.ptr())) {
      to.push_back(to_count(value, key.c_str()));
    } else if (nb::isinstance<Image>(value)) {
      arrays_.images.push_back(nb::cast<const Image&>(value));
      to.push_back(int64_t(arrays_.images.size() - 1));
    } else if (nb::isinstance<nb::dict>(value)) {
      append_dict(nb::cast<nb::dict>(value), to);
    } else if (PyNumber_Check(value.ptr()) && !PySequence_Check(value.ptr())) {
      to.push_back(to_number(value, key.c_str()));
    } else {
      require(nb::hasattr(value, "__iter__"),
              "expected a text, a number, a list, a dict or an image for \"{}\", got {}", key, shown(value));
      toml::array array;
      for (const nb::handle item : nb::iter(value)) append(item, key, array);
      to.push_back(std::move(array));
    }
  }

  // The package puts arrays of a mesh or of points into a dict of their own.
  void append_dict(const nb::dict& dict, toml::array& to) {
    if (dict.contains("vertices")) {
      arrays_.meshes.push_back(to_mesh(dict));
      to.push_back(int64_t(arrays_.meshes.size() - 1));
    } else if (dict.contains("positions") && dict.contains("amplitudes")) {
      arrays_.points.push_back(to_points(dict));
      to.push_back(int64_t(arrays_.points.size() - 1));
    } else {
      to.push_back(table(dict));
    }
  }

  SceneArrays& arrays_;
};

}  // namespace

toml::table to_table(const nb::dict& dict, SceneArrays& arrays) { return Converter(arrays).table(dict); }

}  // namespace holotrace::python
