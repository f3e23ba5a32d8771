// The packets of tev's protocol: their length in bytes, itself included, as 32 bits; a byte that
// says what they are; then what belongs to it. Numbers are little-endian, texts end with a zero,
// and names of channels follow each other.
#pragma once

#include <string>

#include "burnish/image.h"

namespace burnish {

/// An image file, of the viewer's machine.
std::string open_packet(const std::string& path);
/// A black image, in the place of one of that name. to_front: the viewer turns to it.
std::string create_packet(const std::string& name, const Image& image, bool to_front);
/// The values of `count` rows from `first` on.
std::string update_packet(const std::string& name, const Image& image, int first, int count);
std::string close_packet(const std::string& name);

}  // namespace burnish
