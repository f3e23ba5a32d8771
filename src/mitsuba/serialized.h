// Mitsuba's serialized meshes, versions 3 and 4: one zlib stream for each mesh, and at the end of
// the file where each begins.
#pragma once

#include <filesystem>

#include "mitsuba/mesh.h"

namespace burnish::mitsuba {

/// The mesh number `index`, from 0, in object space. Throws InputError: no such mesh, damaged,
/// truncated, counts that the stream cannot hold, indices out of range, non-finite vertices.
MeshFile read_serialized(const std::filesystem::path& file, std::size_t index,
                         const BeforeMesh& before_mesh = {});

}  // namespace burnish::mitsuba
