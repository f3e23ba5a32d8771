#include "mitsuba/serialized.h"

#include <fmt/format.h>
#include <zlib.h>

#include <bit>
#include <cmath>
#include <string>
#include <string_view>

#include "burnish/error.h"
#include "core/bytes.h"
#include "image/files.h"

namespace burnish::mitsuba {

namespace {

static_assert(std::endian::native == std::endian::little, "the file's numbers are little-endian");

constexpr std::uint16_t kMagic = 0x041C;
constexpr std::uint32_t kNormals = 1, kUvs = 2, kColors = 8, kDouble = 0x2000;

[[noreturn]] void fail(const std::string& name, const std::string& what) {
    throw InputError(fmt::format("{}: damaged serialized mesh: {}", name, what));
}

/// Where a mesh lies.
struct Extent {
    std::size_t begin = 0, end = 0;
    int version = 0;
};

Extent find_mesh(const std::string& name, std::string_view bytes, std::size_t index) {
    const auto version_at = [&](std::size_t at) {
        const std::uint64_t magic = number_at(bytes, at, 2), version = number_at(bytes, at + 2, 2);
        if (magic != kMagic || (version != 3 && version != 4))
            fail(name, fmt::format("found the signature {:#06x} of version {}, expected {:#06x} of "
                                   "version 3 or 4",
                                   magic, version, kMagic));
        return static_cast<int>(version);
    };
    if (bytes.size() < 4) fail(name, "the file ends too early");
    const std::size_t width = version_at(0) == 4 ? 8 : 4;
    const std::size_t tail = bytes.size() - sizeof(std::uint32_t);
    const std::size_t count = number_at(bytes, tail, 4);
    if (count == 0 || count > tail / width)
        fail(name, "its list of meshes is longer than the file");
    const std::size_t list = tail - count * width;
    if (index >= count)
        throw InputError(fmt::format("{}: there is no mesh {}, expected one from 0 to {}", name,
                                     index, count - 1));
    const auto begin_of = [&](std::size_t i) -> std::size_t {
        return number_at(bytes, list + i * width, width);
    };
    Extent extent{begin_of(index), index + 1 < count ? begin_of(index + 1) : list, 0};
    if (extent.begin > list || extent.end > list || extent.end < extent.begin ||
        extent.end - extent.begin < 4)
        fail(name, fmt::format("mesh {} lies outside of the file", index));
    extent.version = version_at(extent.begin);
    extent.begin += 4;
    return extent;
}

/// A zlib stream, decompressed as it is read.
class Stream {
  public:
    Stream(std::string name, std::string_view bytes) : name_(std::move(name)), bytes_(bytes) {
        if (bytes.size() > 0xffffffffu) fail(name_, "a mesh has more than 4 GiB");
        // The library does not write to its input.
        z_.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
        z_.avail_in = static_cast<uInt>(bytes.size());
        if (inflateInit(&z_) != Z_OK) throw ResourceError(name_ + ": zlib could not start");
    }
    ~Stream() { inflateEnd(&z_); }
    Stream(const Stream&) = delete;
    Stream& operator=(const Stream&) = delete;

    const std::string& name() const { return name_; }
    /// What the stream can hold at most: deflate makes no more of a byte.
    double capacity() const { return 1032.0 * static_cast<double>(bytes_.size()) + 64; }

    void read(void* to, std::size_t size) {
        auto* out = static_cast<Bytef*>(to);
        while (size > 0) {
            const auto part = static_cast<uInt>(std::min<std::size_t>(size, 1u << 30));
            z_.next_out = out, z_.avail_out = part;
            while (z_.avail_out > 0) {
                const int status = inflate(&z_, Z_NO_FLUSH);
                if (z_.avail_out == 0) break;
                if (status == Z_MEM_ERROR) throw std::bad_alloc();
                if (status != Z_OK)
                    fail(name_, "its data ends too early or cannot be decompressed");
            }
            out += part, size -= part;
        }
    }
    template <class T>
    T read() {
        T value;
        read(&value, sizeof(T));
        return value;
    }

  private:
    std::string name_;
    std::string_view bytes_;
    z_stream z_{};
};

/// `count` vectors of N components, of floats or doubles.
template <class Vec, std::size_t N>
std::vector<Vec> read_vectors(Stream& stream, std::size_t count, bool doubles) {
    std::vector<Vec> result(count);
    for (Vec& v : result) {
        std::array<float, N> x;
        for (float& c : x) {
            c = doubles ? static_cast<float>(stream.read<double>()) : stream.read<float>();
            if (!std::isfinite(c)) fail(stream.name(), "a vertex is not finite");
        }
        if constexpr (N == 3)
            v = {x[0], x[1], x[2]};
        else
            v = {x[0], x[1]};
    }
    return result;
}

struct Counts {
    std::uint32_t flags = 0;
    std::size_t vertices = 0, triangles = 0;
};

void skip_name(Stream& stream) {
    constexpr int kMaxName = 4096;
    for (int length = 0; stream.read<char>() != '\0'; ++length)
        if (length == kMaxName) fail(stream.name(), "the name of a mesh is longer than 4096 bytes");
}

/// A mesh of version 4 has its name between its flags and its numbers.
Counts read_counts(Stream& stream, int version) {
    Counts c;
    c.flags = stream.read<std::uint32_t>();
    if (version == 4) skip_name(stream);
    const auto vertices = stream.read<std::uint64_t>(), triangles = stream.read<std::uint64_t>();
    const double scalar = c.flags & kDouble ? 8 : 4;
    const double vertex = scalar * (3 + (c.flags & kNormals ? 3 : 0) + (c.flags & kUvs ? 2 : 0) +
                                    (c.flags & kColors ? 3 : 0));
    const double bytes =
        vertex * static_cast<double>(vertices) + 12.0 * static_cast<double>(triangles);
    if (vertices == 0 || triangles == 0 || vertices > 0x7fffffffu || triangles > 0x7fffffffu ||
        bytes > stream.capacity())
        fail(stream.name(), fmt::format("it says {} vertices and {} triangles, which its stream "
                                        "cannot hold",
                                        vertices, triangles));
    c.vertices = static_cast<std::size_t>(vertices);
    c.triangles = static_cast<std::size_t>(triangles);
    return c;
}

}  // namespace

MeshFile read_serialized(const std::filesystem::path& file, std::size_t index,
                         const BeforeMesh& before_mesh) {
    const std::string name = file.string(), bytes = read_bytes(file);
    const Extent extent = find_mesh(name, bytes, index);
    Stream stream(name, std::string_view(bytes).substr(extent.begin, extent.end - extent.begin));
    const Counts counts = read_counts(stream, extent.version);
    if (before_mesh) before_mesh(min_bytes(counts.vertices, counts.triangles));
    const bool doubles = (counts.flags & kDouble) != 0;
    Mesh mesh;
    mesh.positions = read_vectors<Vec3f, 3>(stream, counts.vertices, doubles);
    if (counts.flags & kNormals)
        mesh.normals = read_vectors<Vec3f, 3>(stream, counts.vertices, doubles);
    if (counts.flags & kUvs) mesh.uvs = read_vectors<Vec2f, 2>(stream, counts.vertices, doubles);
    if (counts.flags & kColors) read_vectors<Vec3f, 3>(stream, counts.vertices, doubles);
    mesh.triangles.resize(counts.triangles);
    for (Triangle& t : mesh.triangles)
        for (std::uint32_t& i : t.vertex)
            if ((i = stream.read<std::uint32_t>()) >= counts.vertices)
                fail(name, fmt::format("found the vertex index {}, expected one in [0, {}]", i,
                                       counts.vertices - 1));
    return {std::move(mesh)};
}

}  // namespace burnish::mitsuba
