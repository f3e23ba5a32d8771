#include "cli/picture_memory.h"

#include <algorithm>
#include <functional>
#include <utility>

#include "cli/process_memory.h"
#include "cli/progress.h"
#include "core/parallel.h"
#include "optimize/memory.h"

namespace burnish {

std::vector<PictureBytes> bytes_of_pictures(const std::vector<CapturedView>& views, double scale) {
    const TickingLine line("measuring the pictures");
    std::vector<PictureBytes> pictures(views.size());
    parallel_tasks(pictures.size(),
                   [&](std::size_t i) { pictures[i] = picture_bytes(views[i], scale); });
    return pictures;
}

AtOnce fitting(std::vector<double> each, double room, std::size_t threads) {
    std::ranges::sort(each, std::greater<>());
    AtOnce fit;
    for (const double bytes : each) {
        if (fit.count == threads || (fit.count > 0 && fit.bytes + bytes > room)) break;
        ++fit.count, fit.bytes += bytes;
    }
    return fit;
}

double room_beside(const Scene& scene) { return physical_memory() / 2 - scene_memory(scene); }

std::size_t pictures_at_once(const std::vector<CapturedView>& views, double room) {
    std::vector<double> reading;
    for (const PictureBytes& bytes : bytes_of_pictures(views, 1)) reading.push_back(bytes.reading);
    return fitting(std::move(reading), room, threads_of(0)).count;
}

}  // namespace burnish
