#include "texture/pyramid_part.h"

namespace burnish {

namespace {

/// Flags the blocks of the rows of a level of `fine_size` that read the ranges of the next coarser
/// one.
void mark_read_rows(const Prolongation& prolongation, const KeptBlocks& coarse,
                    const Vec2<int>& coarse_size, const Vec2<int>& fine_size, int channels,
                    DirtyBlocks& flags) {
    const auto row = static_cast<std::size_t>(coarse_size.x * channels),
               fine_row = static_cast<std::size_t>(fine_size.x * channels);
    for (const IndexRange& range : coarse.ranges)
        for (std::size_t y = range.begin / row; y * row < range.end; ++y)
            for_readers(prolongation, static_cast<int>(y), fine_size.y, [&](int fine) {
                const std::size_t begin = static_cast<std::size_t>(fine) * fine_row;
                mark_dirty(flags, begin, begin + fine_row);
            });
}

std::size_t floats_of(const Vec2<int>& size, int channels) {
    return static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y) *
           static_cast<std::size_t>(channels);
}

}  // namespace

PyramidPart part_of(const PyramidMaps& maps, int channels, int part, int parts) {
    PyramidPart levels(maps.sizes.size());
    for (std::size_t i = levels.size(); i-- > 0;) {
        const std::size_t floats = floats_of(maps.sizes[i], channels);
        LevelPart& level = levels[i];
        level.own = own_range(floats, part, parts);
        DirtyBlocks flags(dirty_blocks_in(floats));
        if (level.own.size() > 0) mark_dirty(flags, level.own.begin, level.own.end);
        if (i + 1 < levels.size())
            mark_read_rows(maps.prolongation, levels[i + 1].read, maps.sizes[i + 1], maps.sizes[i],
                           channels, flags);
        level.read = kept_blocks(flags, floats);
    }
    return levels;
}

void keep_part(PyramidState& state, int part, int parts) {
    for_parted_arrays(state, [&](auto& array, std::size_t floats, std::size_t per) {
        if (array.size() != entries_of({0, floats}, per).size()) return;
        const IndexRange own = entries_of(own_range(floats, part, parts), per);
        if (own.size() == array.size()) return;
        const auto begin = array.begin() + static_cast<std::ptrdiff_t>(own.begin);
        array = {begin, begin + static_cast<std::ptrdiff_t>(own.size())};
    });
}

}  // namespace burnish
