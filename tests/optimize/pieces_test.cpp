// What the first process takes of the others comes whole and in order, in as few slices as fit.
#include "optimize/pieces.h"

#include <gtest/gtest.h>

#include "burnish/error.h"
#include "optimize/thread_ranks.h"

namespace burnish {
namespace {

constexpr std::size_t kPieces = 40;

/// Piece i of a rank; some are empty, two in a row and the last one, too.
std::string piece(int rank, std::size_t i) {
    const bool is_empty = i % 10 == 4 || i % 10 == 5 || i + 1 == kPieces;
    return std::string(is_empty ? 0 : i * 37 % 101,
                       static_cast<char>('a' + (static_cast<int>(i) + rank) % 26));
}

Pieces pieces_of(int rank) {
    return {kPieces, [rank](std::size_t i, const ByteSink& sink) {
                const std::string bytes = piece(rank, i);
                const std::size_t half = bytes.size() / 2;
                sink(bytes.data(), half);
                sink(bytes.data() + half, bytes.size() - half);
            }};
}

Ranks with_count(const Ranks& ranks, int& exchanges) {
    return {ranks.rank, ranks.count, [&](std::vector<std::string> messages) {
                ++exchanges;
                return ranks.exchange(std::move(messages));
            }};
}

/// Takes the first `count` pieces of all others, and compares them.
void expect_pieces(TakenPieces& from, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i)
        for (int r = 1; r < from.ranks.count; ++r) {
            std::string bytes;
            ArchiveWriter archive(sink_into(bytes));
            take_piece(from, r, archive);
            EXPECT_EQ(bytes, piece(r, i)) << "piece " << i << " of process " << r;
            std::size_t left = 0;
            for (const TakenPieces::Slice& s : from.slices) left += s.bytes.size() - s.at;
            EXPECT_LE(left, from.bytes) << "of all others together";
        }
}

/// The exchanges of a process, where the first one takes all that the others have.
int exchanges_of(const Ranks& ranks, std::size_t bytes) {
    int exchanges = 0;
    const Ranks own = with_count(ranks, exchanges);
    if (ranks.rank > 0) {
        give_pieces(own, pieces_of(ranks.rank));
    } else {
        TakenPieces from{own, bytes};
        expect_pieces(from, kPieces);
        end_pieces(own);
    }
    return exchanges;
}

TEST(Pieces, ComeWholeAndInOrderWhateverTheSlice) {
    for (const int count : {2, 3, 5})
        for (const std::size_t bytes : {13u, 64u, 1000u, 100000u})
            test::on_ranks(count, [&](const Ranks& ranks) { exchanges_of(ranks, bytes); });
}

TEST(Pieces, SmallOnesOfAllComeAtOnce) {
    for (const int count : {2, 3, 5})
        test::on_ranks(count, [&](const Ranks& ranks) {
            EXPECT_EQ(exchanges_of(ranks, 100000), 3) << "what is asked for, the pieces, the end";
        });
}

TEST(Pieces, LargeOnesComeInSlices) {
    test::on_ranks(2, [&](const Ranks& ranks) {
        std::size_t bytes = 0;
        for (std::size_t i = 0; i < kPieces; ++i) bytes += piece(1, i).size() + 8;
        const std::size_t slices = (bytes + 49) / 50;  // each of half the bytes
        EXPECT_EQ(exchanges_of(ranks, 100), 2 * static_cast<int>(slices) + 1);
    });
}

/// As where writing failed, and is tried again.
TEST(Pieces, BeginAgainWithTheFirst) {
    for (const std::size_t bytes : {50u, 100000u})
        test::on_ranks(3, [&](const Ranks& ranks) {
            if (ranks.rank > 0) return give_pieces(ranks, pieces_of(ranks.rank));
            for (const std::size_t count : {kPieces / 2, kPieces}) {
                TakenPieces from{ranks, bytes};
                expect_pieces(from, count);
            }
            end_pieces(ranks);
        });
}

TEST(Pieces, MoreThanThereAreAreRefused) {
    test::on_ranks(2, [&](const Ranks& ranks) {
        if (ranks.rank > 0) return give_pieces(ranks, pieces_of(ranks.rank));
        TakenPieces from{ranks, 1000};
        expect_pieces(from, kPieces);
        ArchiveWriter archive([](const void*, std::size_t) {});
        EXPECT_THROW(take_piece(from, 1, archive), Error);
        end_pieces(ranks);
    });
}

}  // namespace
}  // namespace burnish
