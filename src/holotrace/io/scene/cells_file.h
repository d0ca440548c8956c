#pragma once

#include <string>

#include "holotrace/data/scene.h"

namespace holotrace {

/// Reads cells from a file: .npy of float32 or float64, of the shape (planes, rows, columns), or .nvdb (nanovdb_file.h).
/// @param name  of the grid, in files that hold several
/// @throws Error naming the path if it is another kind of file, or damaged
Cells load_cells(const std::string& path, const std::string& name);

}  // namespace holotrace
