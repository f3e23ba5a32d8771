// How many pictures are read at once, by the memory that this takes.
#pragma once

#include <vector>

#include "captures/pictures.h"
#include "scene/scene.h"

namespace burnish {

/// What the pictures of views take, with progress.
std::vector<PictureBytes> bytes_of_pictures(const std::vector<CapturedView>& views, double scale);

/// Pictures that are read at once, and their bytes.
struct AtOnce {
    std::size_t count = 0;
    double bytes = 0;
};
/// As many as fit whichever they are, but one at least. each: bytes of each.
AtOnce fitting(std::vector<double> each, double room, std::size_t threads);

/// What of half of the machine's memory a scene leaves, bytes.
double room_beside(const Scene& scene);
/// How many of the views' pictures may be read at once in so many bytes, where none is kept.
std::size_t pictures_at_once(const std::vector<CapturedView>& views, double room);

}  // namespace burnish
