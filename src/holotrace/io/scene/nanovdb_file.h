#pragma once

#include <string>

#include "holotrace/data/scene.h"

namespace holotrace {

/// Reads a grid of 32-bit floating-point numbers from a file of NanoVDB (.nvdb, version 32 of the format, of OpenVDB 9 to 11;
/// uncompressed or compressed by zlib) as cells.
///
/// The cells are the voxels of the box of all active voxels of all such grids in the file, so that grids of one file fit each other;
/// sparse grids become dense ones, of 4 bytes a cell. Nodes are read by their offsets in the file, each checked against its size.
///
/// @param name  the grid that is wanted; if the file has one grid, that one in any case
/// @throws Error naming the path if it is no such file, damaged, compressed by Blosc, larger than memory, or has no such grid
///
/// Reference: K. Museth, NanoVDB, SIGGRAPH 2021 Talks; its PNanoVDB.h lists the layout of the nodes.
Cells load_nanovdb(const std::string& path, const std::string& name);

}  // namespace holotrace
