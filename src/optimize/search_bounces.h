// The colours of a start where light bounces. A region's colour is found under light that other
// surfaces reflect as if their unknowns were 0.5: where they reflect more, it is brighter than
// that, and all regions together are too bright, in a closed room by any factor.
#pragma once

#include "optimize/search_view.h"

namespace burnish {

/// Moves the colours that were found towards 0.5, in quarters of the way, for as long as what is
/// rendered with them loses less. frames: of one plan; their passes are drawn anew. textures: of
/// all of its unknowns. The same for any number of threads.
void draw_back_colors(std::span<SearchFrame> frames, std::vector<Image>& textures);

}  // namespace burnish
