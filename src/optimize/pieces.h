// Bytes that the first process takes from the others, piece after piece. They come in slices: of
// small pieces all at once, of large ones some at a time, so that few of them lie here twice.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "core/archive.h"
#include "optimize/ranks.h"

namespace burnish {

/// What one of the others has.
struct Pieces {
    std::size_t count = 0;
    /// Writes the same bytes each time: it is called for each slice with bytes of the piece.
    std::function<void(std::size_t piece, const ByteSink& sink)> write;
};

/// Of each of the others: gives its pieces until the first process calls end_pieces.
void give_pieces(const Ranks& ranks, const Pieces& pieces);

/// Of the first process: where it is in what the others have. A new one begins with their first
/// pieces again.
struct TakenPieces {
    struct Slice {
        std::string bytes;
        std::size_t at = 0;  ///< those before it are taken
    };
    const Ranks& ranks;
    std::size_t bytes = 0;           ///< that lie here at once, of all others together
    std::vector<Slice> slices = {};  ///< of each rank; none: nothing was asked for
};

/// The next piece of a rank. Throws Error where it has none.
void take_piece(TakenPieces& from, int rank, ArchiveWriter& archive);

void end_pieces(const Ranks& ranks);

}  // namespace burnish
