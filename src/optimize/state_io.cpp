// States as bytes: a header, then every field in the order of `fields` below, numbers as they lie
// in memory (little-endian), arrays behind their count. To add a field to a state: here too, and a
// new kVersion.
#include <algorithm>
#include <bit>
#include <concepts>
#include <cstring>
#include <string_view>
#include <type_traits>

#include "burnish/error.h"
#include "optimize/state.h"

namespace burnish {

namespace {

static_assert(std::endian::native == std::endian::little, "states are little-endian");

constexpr char kMagic[8] = {'B', 'U', 'R', 'N', 'I', 'S', 'H', 'S'};
constexpr std::uint32_t kVersion = 5;

/// Of bytes, eight at a time. Every step is a bijection of the sum and of the word, so that a
/// change of one word always shows.
std::uint64_t checksum(std::string_view bytes) {
    std::uint64_t sum = bytes.size();
    while (!bytes.empty()) {
        std::uint64_t word = 0;
        const std::size_t count = std::min(bytes.size(), sizeof word);
        std::memcpy(&word, bytes.data(), count);
        sum = std::rotl((sum ^ word) * 0x9e3779b97f4a7c15u, 31);
        bytes.remove_prefix(count);
    }
    return sum;
}

/// T or const T.
template <class S, class T>
concept Is = std::same_as<std::remove_const_t<S>, T>;

// The fields of every struct in a state, once for writing and reading.
void fields(auto& archive, Is<Image> auto& v) { archive(v.width, v.height, v.channels, v.values); }
void fields(auto& archive, Is<TextureId> auto& v) { archive(v.value); }
void fields(auto& archive, Is<BsdfId> auto& v) { archive(v.value); }
void fields(auto& archive, Is<Vec2f> auto& v) { archive(v.x, v.y); }
void fields(auto& archive, Is<Vec3f> auto& v) { archive(v.x, v.y, v.z); }
void fields(auto& archive, Is<ThetaTexture> auto& v) { archive(v.texture, v.values); }
void fields(auto& archive, Is<Theta> auto& v) { archive(v.textures); }
void fields(auto& archive, Is<TexelKey> auto& v) { archive(v.slot, v.texel); }
void fields(auto& archive, Is<CameraSample> auto& v) { archive(v.pixel, v.iteration, v.pass); }
void fields(auto& archive, Is<PathSample> auto& v) { archive(v.camera, v.technique); }
void fields(auto& archive, Is<PathRecord> auto& v) {
    archive(v.pixel, v.technique, v.bsdf, v.film_pass, v.uv, v.wi_local, v.wo_local,
            v.radiance_over_pdf);
}
void fields(auto& archive, Is<HistorySample> auto& v) {
    archive(v.key, v.q, v.W, v.path, v.record);
}
void fields(auto& archive, Is<History> auto& v) {
    archive(v.samples, v.confidence, v.theta, v.normalized_adjoint);
}
void fields(auto& archive, Is<PixelStatistics> auto& v) { archive(v.seen, v.squares, v.counts); }
void fields(auto& archive, Is<RecordRun> auto& v) { archive(v.bsdf, v.begin, v.end); }
void fields(auto& archive, Is<TileRecords> auto& v) { archive(v.blocks, v.runs, v.count); }
void fields(auto& archive, Is<CachedPass> auto& v) { archive(v.film_pass, v.tiles); }
void fields(auto& archive, Is<CacheHalf> auto& v) { archive(v.passes, v.passes_traced); }
void fields(auto& archive, Is<PathCacheState> auto& v) { archive(v.halves[0], v.halves[1]); }
void fields(auto& archive, Is<ReservoirsState> auto& v) { archive(v.history, v.pixels, v.image); }
void fields(auto& archive, Is<MonteCarloState> auto& v) { archive(v.pixels, v.image); }
void fields(auto& archive, Is<BlockGate> auto& v) { archive(v.sum, v.count); }
void fields(auto& archive, Is<AdamState> auto& v) {
    archive(v.mean, v.square, v.noise, v.initial, v.gates, v.mean_gate, v.steps, v.visited);
}
void fields(auto& archive, Is<LevelState> auto& v) { archive(v.values, v.adam); }
void fields(auto& archive, Is<PyramidState> auto& v) { archive(v.levels, v.visits); }
void fields(auto& archive, Is<Background> auto& v) { archive(v.mean, v.counts, v.passes); }
void fields(auto& archive, Is<PatienceState> auto& v) { archive(v.min_loss, v.failed); }
void fields(auto& archive, Is<ViewState> auto& v) {
    archive(v.visits, v.estimator, v.backgrounds, v.exposure[0], v.exposure[1], v.exposure[2]);
}
void fields(auto& archive, Is<State::Values> auto& v) {
    archive(v.iteration, v.theta, v.pyramids, v.views, v.patience, v.searched);
}

/// Written as it lies in memory: numbers, and structs of numbers without gaps.
template <class T>
inline constexpr bool kPlain = std::is_arithmetic_v<T> || std::is_enum_v<T>;
template <>
inline constexpr bool kPlain<RecordBlock> = true;

template <class T>
concept Resizable = requires(T v) {
    v.resize(1);
    v.begin();
};

class Writer {
  public:
    std::string bytes;

    template <class... T>
    void operator()(const T&... values) {
        (write(values), ...);
    }

  private:
    void put(const void* from, std::size_t size) {
        bytes.append(static_cast<const char*>(from), size);
    }
    template <class T>
    void write(const T& v) {
        if constexpr (kPlain<T>) {
            put(&v, sizeof v);
        } else if constexpr (Resizable<T>) {
            write(std::uint64_t{v.size()});
            if constexpr (kPlain<typename T::value_type> && requires { v.data(); })
                put(v.data(), v.size() * sizeof(typename T::value_type));
            else
                for (const auto& item : v) write(item);
        } else if constexpr (requires { v.index(); }) {
            write(static_cast<std::uint32_t>(v.index()));
            std::visit([this](const auto& own) { this->write(own); }, v);
        } else {
            fields(*this, v);
        }
    }
};

class Reader {
  public:
    explicit Reader(const std::string& bytes) : bytes_(bytes) {}

    template <class... T>
    void operator()(T&... values) {
        (read(values), ...);
    }
    std::size_t left() const { return bytes_.size() - at_; }
    [[noreturn]] void fail(const std::string& found, const std::string& expected) const {
        throw InputError("the state, byte " + std::to_string(at_) + ": found " + found +
                         ", expected " + expected);
    }

  private:
    void take(void* to, std::size_t size) {
        if (size > left())
            fail(std::to_string(left()) + " bytes more", "at least " + std::to_string(size));
        if (size > 0) std::memcpy(to, bytes_.data() + at_, size);
        at_ += size;
    }
    /// The count of items that follow. No more than bytes that are left may hold: a wrong count
    /// allocates nothing.
    template <class Item>
    std::size_t count() {
        std::uint64_t n = 0;
        take(&n, sizeof n);
        Writer least;
        least(Item{});
        if (n > left() / least.bytes.size())
            fail("an array of " + std::to_string(n) + " items",
                 "at most " + std::to_string(left() / least.bytes.size()));
        return static_cast<std::size_t>(n);
    }
    template <std::size_t I = 0, class Variant>
    void read_alternative(std::size_t index, Variant& v) {
        if constexpr (I < std::variant_size_v<Variant>) {
            if (index == I)
                read(v.template emplace<I>());
            else
                read_alternative<I + 1>(index, v);
        } else {
            fail("estimator " + std::to_string(index), "a known one");
        }
    }
    template <class T>
    void read(T& v) {
        if constexpr (kPlain<T>) {
            take(&v, sizeof v);
        } else if constexpr (Resizable<T>) {
            v.resize(count<typename T::value_type>());
            if constexpr (kPlain<typename T::value_type> && requires { v.data(); })
                take(v.data(), v.size() * sizeof(typename T::value_type));
            else
                for (auto& item : v) read(item);
        } else if constexpr (requires { v.index(); }) {
            std::uint32_t index = 0;
            read(index);
            read_alternative(index, v);
        } else {
            fields(*this, v);
        }
    }

    const std::string& bytes_;
    std::size_t at_ = 0;
};

}  // namespace

std::string save_state(const State& state) {
    Writer fields_of_state;
    fields_of_state(state.values());
    const std::string& payload = fields_of_state.bytes;
    Writer writer;
    for (const char c : kMagic) writer(c);
    writer(kVersion, std::uint64_t{payload.size()}, checksum(payload));
    return writer.bytes + payload;
}

State load_state(const std::string& bytes) {
    Reader reader(bytes);
    char magic[8] = {};
    for (char& c : magic) reader(c);
    if (std::memcmp(magic, kMagic, sizeof magic) != 0) reader.fail("other bytes", "a state");
    std::uint32_t version = 0;
    reader(version);
    if (version != kVersion)
        reader.fail("version " + std::to_string(version), "version " + std::to_string(kVersion));
    std::uint64_t size = 0, sum = 0;
    reader(size, sum);
    if (size != reader.left())
        reader.fail(std::to_string(reader.left()) + " bytes more", std::to_string(size));
    if (sum != checksum(std::string_view(bytes).substr(bytes.size() - reader.left())))
        reader.fail("damaged fields", "those of the checksum before them");
    State::Values values;
    reader(values);
    if (reader.left() > 0) reader.fail(std::to_string(reader.left()) + " bytes more", "the end");
    return State(std::move(values));
}

}  // namespace burnish
