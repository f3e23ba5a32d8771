// The header of a PLY file: which elements with which properties follow, and where.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace burnish::mitsuba {

enum class PlyFormat { kAscii, kLittleEndian, kBigEndian };
enum class PlyType { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kFloat32, kFloat64 };

std::size_t size_of(PlyType type);  ///< bytes

struct PlyProperty {
    std::string name;
    PlyType type = PlyType::kFloat32;
    bool is_list = false;
    PlyType count_type = PlyType::kUint8;  ///< of a list
};

struct PlyElement {
    std::string name;
    std::size_t count = 0;
    std::vector<PlyProperty> properties;
};

struct PlyHeader {
    PlyFormat format = PlyFormat::kAscii;
    std::vector<PlyElement> elements;
    std::size_t data_offset = 0;  ///< of the first byte after end_header
    int data_line = 1;            ///< its line, from 1
};

/// Throws InputError "NAME:LINE: ..."; the counts are checked against the bytes that the file has.
PlyHeader read_ply_header(const std::string& name, std::string_view bytes);

}  // namespace burnish::mitsuba
