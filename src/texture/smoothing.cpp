#include "texture/smoothing.h"

#include <algorithm>

#include "core/packet.h"
#include "core/parallel.h"

namespace burnish {

namespace {

constexpr std::size_t kSide = kLanes;  ///< lines that are solved together, one in each lane

/// Lines of texels, one in each lane.
struct Lines {
    std::vector<Packet> values;  ///< [length, channels]
    std::vector<Packet> links;   ///< [length], to the next texel: 0 or 1; 0 for the last
    std::vector<Packet> carry;   ///< [length], work memory

    Lines(std::size_t length, std::size_t channels)
        : values(length * channels), links(length), carry(length) {}
};

/// What has faded out is nothing: numbers below the normal range are slow.
Packet faded(const Packet& v) { return select(abs(v) < Packet(1e-30f), Packet(0.0f), v); }

/// Thomas's algorithm for (1 + l_before + l_on) x_i - l_before x_(i-1) - l_on x_(i+1) = r_i, l = 0
/// or lambda, in every channel.
void solve(float lambda, std::size_t channels, Lines& lines) {
    Packet back = 0.0f, carry_before = 0.0f;
    for (std::size_t i = 0; i < lines.links.size(); ++i) {
        const Packet on = lines.links[i] * Packet(lambda);
        const Packet scale =
            Packet(1.0f) / (Packet(1.0f) + back * (Packet(1.0f) - carry_before) + on);
        Packet* v = &lines.values[i * channels];
        for (std::size_t c = 0; c < channels; ++c) {
            const Packet before = i > 0 ? *(v + c - channels) : Packet(0.0f);
            v[c] = faded((v[c] + back * before) * scale);
        }
        lines.carry[i] = carry_before = on * scale;
        back = on;
    }
    for (std::size_t i = lines.links.size() - 1; i-- > 0;) {
        Packet* v = &lines.values[i * channels];
        for (std::size_t c = 0; c < channels; ++c)
            v[c] = faded(v[c] + lines.carry[i] * v[c + channels]);
    }
}

/// Calls body(begin, count) for the blocks of at most kSide that `size` is made of.
template <class Body>
void for_blocks(std::size_t size, const Body& body) {
    for (std::size_t i = 0; i < size; i += kSide) body(i, std::min(kSide, size - i));
}

/// A square of numbers as packets: number x of row y becomes lane y of packet x. Rows and numbers
/// beyond the counts are 0.
template <class T>
void gather_square(const T* from, std::size_t row_size, std::size_t rows, std::size_t count,
                   PacketBlock& square) {
    for (std::size_t y = 0; y < kSide; ++y) {
        std::array<float, kSide> row{};
        if (y < rows)
            for (std::size_t x = 0; x < count; ++x)
                row[x] = static_cast<float>(from[y * row_size + x]);
        square[y] = load(row.data());
    }
    transpose(square);
}

void scatter_square(PacketBlock& square, std::size_t row_size, std::size_t rows, std::size_t count,
                    float* to) {
    transpose(square);
    for (std::size_t y = 0; y < rows; ++y) {
        std::array<float, kSide> row;
        store(row.data(), square[y]);
        std::copy_n(row.data(), count, to + y * row_size);
    }
}

/// kSide rows, or what there is, from `from` on: number x of row y becomes lane y of to[x].
template <class T>
void gather_rows(const T* from, std::size_t row_size, std::size_t rows, std::vector<Packet>& to) {
    for_blocks(row_size, [&](std::size_t x, std::size_t count) {
        PacketBlock square;
        gather_square(from + x, row_size, rows, count, square);
        std::copy_n(square.data(), count, &to[x]);
    });
}

void scatter_rows(const std::vector<Packet>& from, std::size_t row_size, std::size_t rows,
                  float* to) {
    for_blocks(row_size, [&](std::size_t x, std::size_t count) {
        PacketBlock square{};
        std::copy_n(&from[x], count, square.data());
        scatter_square(square, row_size, rows, count, to + x);
    });
}

}  // namespace

TexelLinks link_texels(int width, int height, const ChartMap& charts) {
    const auto w = static_cast<std::size_t>(width), h = static_cast<std::size_t>(height);
    TexelLinks links{width, height, std::vector<std::uint8_t>(w * h, 0),
                     std::vector<std::uint8_t>(w * h, 0)};
    const auto linked = [&](std::size_t a, std::size_t b) -> std::uint8_t {
        return charts.empty() || (charts[a] == charts[b] && charts[a] != 0);
    };
    for (std::size_t y = 0; y < h; ++y)
        for (std::size_t x = 0; x < w; ++x) {
            const std::size_t i = y * w + x;
            if (x + 1 < w) links.right[i] = linked(i, i + 1);
            if (y + 1 < h) links.down[i] = linked(i, i + w);
        }
    return links;
}

void smooth_rows(const TexelLinks& links, float lambda, Image& image) {
    const auto width = static_cast<std::size_t>(image.width),
               height = static_cast<std::size_t>(image.height),
               channels = static_cast<std::size_t>(image.channels);
    constexpr std::size_t kRows = 4 * kSide;
    parallel_chunks(height, kRows, [&](std::size_t begin, std::size_t end) {
        Lines lines(width, channels);
        for (std::size_t y = begin; y < end; y += kSide) {
            const std::size_t rows = std::min(kSide, end - y);
            float* values = &image.values[y * width * channels];
            gather_rows(&links.right[y * width], width, rows, lines.links);
            gather_rows(values, width * channels, rows, lines.values);
            solve(lambda, channels, lines);
            scatter_rows(lines.values, width * channels, rows, values);
        }
    });
}

void smooth_columns(const TexelLinks& links, float lambda, Image& image) {
    const auto width = static_cast<std::size_t>(image.width),
               height = static_cast<std::size_t>(image.height),
               channels = static_cast<std::size_t>(image.channels), floats = width * channels;
    constexpr std::size_t kColumns = 4 * kSide;
    parallel_chunks(floats, kColumns, [&](std::size_t begin, std::size_t end) {
        Lines lines(height, 1);
        for (std::size_t x = begin; x < end; x += kSide) {
            const std::size_t count = std::min(kSide, end - x);
            std::array<std::size_t, kSide> texel{};
            for (std::size_t i = 0; i < count; ++i) texel[i] = (x + i) / channels;
            for (std::size_t y = 0; y < height; ++y) {
                std::array<float, kSide> row{}, on{};
                std::copy_n(&image.values[y * floats + x], count, row.data());
                for (std::size_t i = 0; i < count; ++i) on[i] = links.down[y * width + texel[i]];
                lines.values[y] = load(row.data()), lines.links[y] = load(on.data());
            }
            solve(lambda, 1, lines);
            for (std::size_t y = 0; y < height; ++y) {
                std::array<float, kSide> row;
                store(row.data(), lines.values[y]);
                std::copy_n(row.data(), count, &image.values[y * floats + x]);
            }
        }
    });
}

}  // namespace burnish
