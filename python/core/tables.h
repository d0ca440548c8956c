#pragma once

#include <nanobind/nanobind.h>
#include <toml++/toml.h>

#include "holotrace/io/scene/scene_tables.h"

namespace holotrace::python {

namespace nb = nanobind;

/// A dict with the keys of a scene file as a table. Objects of the core's class Image become indices of arrays.images;
/// in a table of the type mesh or points, arrays become an index of arrays.meshes or arrays.points.
/// @throws Error  for values that no scene file can hold
toml::table to_table(const nb::dict& dict, SceneArrays& arrays);

}  // namespace holotrace::python
