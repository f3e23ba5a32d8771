#include "live/packets.h"

#include <bit>
#include <cstdint>

namespace burnish {

namespace {

static_assert(std::endian::native == std::endian::little, "the packets' numbers are little-endian");

enum class Kind : char { kClose = 2, kCreate = 4, kUpdate = 6, kOpen = 7 };

class PacketWriter {
  public:
    explicit PacketWriter(Kind kind) {
        add(std::uint32_t{0});  // the length
        bytes_ += static_cast<char>(kind);
    }
    template <class Number>
    PacketWriter& add(Number number) {
        bytes_.append(reinterpret_cast<const char*>(&number), sizeof number);
        return *this;
    }
    PacketWriter& add(bool flag) {
        bytes_ += flag ? '\1' : '\0';
        return *this;
    }
    /// Up to a zero.
    PacketWriter& add(const std::string& text) {
        bytes_.append(text.c_str());
        bytes_ += '\0';
        return *this;
    }
    PacketWriter& add(const float* values, std::size_t count) {
        bytes_.append(reinterpret_cast<const char*>(values), count * sizeof *values);
        return *this;
    }
    std::string finish() {
        const auto length = static_cast<std::uint32_t>(bytes_.size());
        bytes_.replace(0, sizeof length, reinterpret_cast<const char*>(&length), sizeof length);
        return std::move(bytes_);
    }

  private:
    std::string bytes_;
};

/// The number of channels, and a name for each.
void add_channels(const Image& image, PacketWriter& packet) {
    packet.add(std::int32_t{image.channels});
    const char* names = image.channels < 3 ? "LA" : "RGBA";
    for (int c = 0; c < image.channels; ++c) packet.add(std::string(1, names[c]));
}

}  // namespace

std::string open_packet(const std::string& path) {
    const std::string all_channels;
    return PacketWriter(Kind::kOpen).add(true).add(path).add(all_channels).finish();
}

std::string create_packet(const std::string& name, const Image& image, bool to_front) {
    PacketWriter packet(Kind::kCreate);
    packet.add(to_front).add(name).add(std::int32_t{image.width}).add(std::int32_t{image.height});
    add_channels(image, packet);
    return packet.finish();
}

std::string update_packet(const std::string& name, const Image& image, int first, int count) {
    PacketWriter packet(Kind::kUpdate);
    packet.add(false).add(name);
    add_channels(image, packet);
    for (const int number : {0, first, image.width, count}) packet.add(std::int32_t{number});
    // Where the values of a channel begin, and how far apart they are: channels alternate.
    for (int c = 0; c < image.channels; ++c) packet.add(std::int64_t{c});
    for (int c = 0; c < image.channels; ++c) packet.add(std::int64_t{image.channels});
    const std::size_t begin = image.index(0, first), end = image.index(0, first + count);
    return packet.add(image.values.data() + begin, end - begin).finish();
}

std::string close_packet(const std::string& name) {
    return PacketWriter(Kind::kClose).add(name).finish();
}

}  // namespace burnish
