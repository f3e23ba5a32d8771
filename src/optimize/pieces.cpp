#include "optimize/pieces.h"

#include <algorithm>

#include "burnish/error.h"

namespace burnish {

namespace {

enum class Ask : std::uint64_t { kFromStart, kMore, kNoMore };

/// Of the first process, to one of the others.
struct Request {
    Ask ask = Ask::kNoMore;
    std::uint64_t bytes = 0;  ///< at most
};

/// Where the next slice of a process begins: in a piece and its size, which stands before it.
struct Place {
    std::size_t piece = 0;
    std::uint64_t at = 0, size = 0;
};

/// Passes over what is written, but for the bytes [at, at + size).
struct Window {
    std::string& bytes;
    std::uint64_t at = 0, size = 0, begin = 0;  ///< begin: of what comes next

    void take(const void* from, std::size_t count) {
        const std::uint64_t first = std::clamp(at, begin, begin + count);
        const std::uint64_t last = std::clamp(at + size, begin, begin + count);
        bytes.append(static_cast<const char*>(from) + (first - begin), last - first);
        begin += count;
    }
};

std::uint64_t size_of(const Pieces& pieces, std::size_t piece) {
    std::uint64_t size = 0;
    pieces.write(piece, [&](const void*, std::size_t count) { size += count; });
    return size;
}

/// As many bytes, or all that are left.
std::string next_slice(const Pieces& pieces, std::uint64_t bytes, Place& place) {
    std::string slice;
    while (place.piece < pieces.count && slice.size() < bytes) {
        if (place.at == 0) place.size = size_of(pieces, place.piece);
        Window window{slice, place.at, bytes - slice.size()};
        window.take(&place.size, sizeof place.size);
        pieces.write(place.piece, [&](const void* from, std::size_t n) { window.take(from, n); });
        place.at = std::min(window.begin, window.at + window.size);
        if (place.at == window.begin) place = {place.piece + 1};
    }
    return slice;
}

/// For a rank whose slice is taken: what its piece needs, at most half of the bytes. Of all ranks a
/// share of the other half lies here, too, so that small pieces of many come at once.
void refill(TakenPieces& from, std::size_t wanted, std::uint64_t size) {
    const auto count = static_cast<std::size_t>(from.ranks.count);
    const std::uint64_t half = std::max<std::uint64_t>(1, from.bytes / 2);
    const std::uint64_t share = half / (count - 1);
    const Ask ask = from.slices.empty() ? Ask::kFromStart : Ask::kMore;
    from.slices.resize(count);
    std::vector<std::string> requests;
    for (std::size_t r = 0; r < count; ++r) {
        TakenPieces::Slice& slice = from.slices[r];
        slice = {slice.bytes.substr(slice.at)};
        const std::uint64_t room =
            r == wanted ? std::max<std::uint64_t>(1, std::clamp(size, share, half)) : share;
        const Request request{ask, room - std::min<std::uint64_t>(room, slice.bytes.size())};
        requests.push_back(message_of(&request));
    }
    from.ranks.exchange(std::move(requests));
    const std::vector<std::string> came = from.ranks.exchange(to_each(from.ranks));
    for (std::size_t r = 0; r < count; ++r) from.slices[r].bytes += came[r];
}

void take(TakenPieces& from, std::size_t rank, std::uint64_t size, const ByteSink& sink) {
    const auto is_taken = [&] {
        return from.slices.empty() || from.slices[rank].at == from.slices[rank].bytes.size();
    };
    while (size > 0) {
        if (is_taken()) refill(from, rank, size);
        if (is_taken()) throw Error("an exchange gave no bytes, expected more of a piece");
        TakenPieces::Slice& slice = from.slices[rank];
        const auto count =
            static_cast<std::size_t>(std::min<std::uint64_t>(size, slice.bytes.size() - slice.at));
        sink(slice.bytes.data() + slice.at, count);
        slice.at += count, size -= count;
    }
}

}  // namespace

void give_pieces(const Ranks& ranks, const Pieces& pieces) {
    Place place;
    while (true) {
        const auto request = value_in<Request>(ranks.exchange(to_each(ranks)).front());
        if (request.ask == Ask::kNoMore) return;
        if (request.ask == Ask::kFromStart) place = {};
        std::vector<std::string> messages = to_each(ranks);
        messages.front() = next_slice(pieces, request.bytes, place);
        ranks.exchange(std::move(messages));
    }
}

void take_piece(TakenPieces& from, int rank, ArchiveWriter& archive) {
    const auto r = static_cast<std::size_t>(rank);
    std::string size;
    take(from, r, sizeof(std::uint64_t), sink_into(size));
    take(from, r, value_in<std::uint64_t>(size),
         [&](const void* bytes, std::size_t count) { archive.raw(bytes, count); });
}

void end_pieces(const Ranks& ranks) {
    const Request request;
    ranks.exchange(to_each(ranks, message_of(&request)));
}

}  // namespace burnish
