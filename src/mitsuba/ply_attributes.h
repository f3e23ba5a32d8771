// Which properties of a PLY file are attributes of vertices or faces, as Mitsuba groups them.
#pragma once

#include <string>
#include <vector>

#include "mitsuba/mesh.h"
#include "mitsuba/ply_header.h"

namespace burnish::mitsuba {

struct AttributeColumns {
    std::vector<MeshAttribute> attributes;  ///< values grow as rows are read
    std::vector<int> of_property;           ///< the attribute of each property; -1: of none

    void add(std::size_t property, float value) {
        attributes[static_cast<std::size_t>(of_property[property])].values.push_back(value);
    }
};

/// Consecutive properties prefix_x, prefix_y, prefix_z (or 0 1 2, 1 2 3) or the first of them alone
/// are an attribute `prefix`, prefix_r, prefix_g, prefix_b one of the name prefix_color; r, g, b
/// and red, green, blue, with or without alpha, are the colour. Others, of two or four, are none.
/// start: "vertex_" or "face_".
AttributeColumns attribute_columns(const PlyElement& element, const std::string& start);

}  // namespace burnish::mitsuba
