// Which lanes of packets hold finite numbers.
#pragma once

#include <limits>

#include "core/packet.h"
#include "core/vec.h"

namespace burnish {

inline Mask finite_lanes(const Packet& v) {
    return abs(v) <= Packet(std::numeric_limits<float>::max());
}
inline Mask finite_lanes(const Rgb<Packet>& v) {
    return finite_lanes(v.x) && finite_lanes(v.y) && finite_lanes(v.z);
}

}  // namespace burnish
