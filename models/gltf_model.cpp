#include "models/gltf_model.h"

#include "burnish/error.h"
#include "core/box.h"
#include "models/gltf_numbers.h"

namespace burnish {

namespace {

constexpr int kArrayBuffer = 34962, kElementArrayBuffer = 34963;  ///< targets of buffer views

int push(GltfModel& model, const char* array, const GltfJson& value) {
    model.json[array].push_back(value);
    return static_cast<int>(model.json[array].size()) - 1;
}

void pad(std::string& bytes, char with) {
    while (bytes.size() % 4 != 0) bytes += with;
}

/// target: what the bytes are for; 0: no vertices.
int add_view(GltfModel& model, std::string_view bytes, int target) {
    pad(model.bytes, '\0');
    GltfJson view{{"buffer", 0}, {"byteOffset", model.bytes.size()}, {"byteLength", bytes.size()}};
    if (target != 0) view["target"] = target;
    model.bytes += bytes;
    return push(model, "bufferViews", view);
}

template <class T>
int add_accessor(GltfModel& model, std::span<const T> data, GltfJson accessor, int target) {
    const std::string_view bytes(reinterpret_cast<const char*>(data.data()), data.size_bytes());
    accessor["bufferView"] = add_view(model, bytes, target);
    accessor["count"] = data.size();
    return push(model, "accessors", accessor);
}

GltfJson as_json(const Vec3f& v) { return GltfJson::array({v.x, v.y, v.z}); }

int sampler(GltfModel& model, TextureFilter filter, TextureWrap wrap) {
    constexpr int kNearest = 9728, kLinear = 9729, kRepeat = 10497, kMirror = 33648, kClamp = 33071;
    const int f = filter == TextureFilter::kNearest ? kNearest : kLinear;
    const int w = wrap == TextureWrap::kRepeat   ? kRepeat
                  : wrap == TextureWrap::kMirror ? kMirror
                                                 : kClamp;
    return index_in(model, "samplers",
                    {{"magFilter", f}, {"minFilter", f}, {"wrapS", w}, {"wrapT", w}});
}

void append_word(std::string& bytes, std::size_t word) {
    if (word > 0xFFFFFFFFu) throw InputError("the model is larger than 4 GiB, which GLB ends at");
    for (int i = 0; i < 4; ++i) bytes += static_cast<char>((word >> (8 * i)) & 0xFF);
}

/// What stands before the data of a chunk.
void append_chunk_head(std::string& bytes, std::uint32_t type, const std::string& data) {
    append_word(bytes, data.size());
    append_word(bytes, type);
}

/// The index of the image with these bytes, which are added unless they are there already.
int index_of_image(GltfModel& model, std::string_view png) {
    const GltfJson& images = model.json["images"];
    for (std::size_t i = 0; i < images.size(); ++i) {
        const GltfJson& view =
            model.json["bufferViews"][images[i]["bufferView"].get<std::size_t>()];
        const auto offset = view["byteOffset"].get<std::size_t>();
        const auto size = view["byteLength"].get<std::size_t>();
        if (std::string_view(model.bytes).substr(offset, size) == png) return static_cast<int>(i);
    }
    return push(model, "images",
                {{"bufferView", add_view(model, png, 0)}, {"mimeType", "image/png"}});
}

}  // namespace

int index_in(GltfModel& model, const char* array, const GltfJson& value) {
    GltfJson& all = model.json[array];
    for (std::size_t i = 0; i < all.size(); ++i)
        if (all[i] == value) return static_cast<int>(i);
    return push(model, array, value);
}

int add_positions(GltfModel& model, std::span<const Vec3f> positions) {
    Box box;
    for (const Vec3f& p : positions) box.include(p);
    return add_accessor(model, positions,
                        {{"componentType", gltf::kFloat},
                         {"type", "VEC3"},
                         {"min", as_json(box.low)},
                         {"max", as_json(box.high)}},
                        kArrayBuffer);
}

int add_normals(GltfModel& model, std::span<const Vec3f> normals) {
    std::vector<Vec3f> unit(normals.begin(), normals.end());
    for (Vec3f& n : unit) n = length_squared(n) > 0 ? normalize(n) : Vec3f{0, 0, 1};
    return add_accessor(model, std::span<const Vec3f>(unit),
                        {{"componentType", gltf::kFloat}, {"type", "VEC3"}}, kArrayBuffer);
}

int add_uvs(GltfModel& model, std::span<const Vec2f> uvs) {
    return add_accessor(model, uvs, {{"componentType", gltf::kFloat}, {"type", "VEC2"}},
                        kArrayBuffer);
}

int add_indices(GltfModel& model, std::span<const std::uint32_t> indices) {
    return add_accessor(model, indices, {{"componentType", gltf::kUint32}, {"type", "SCALAR"}},
                        kElementArrayBuffer);
}

int add_texture(GltfModel& model, const GltfTexture& texture) {
    const int source = index_of_image(model, texture.png);
    return index_in(
        model, "textures",
        {{"source", source}, {"sampler", sampler(model, texture.filter, texture.wrap)}});
}

void use_extension(GltfModel& model, const char* name) { index_in(model, "extensionsUsed", name); }

std::string glb_bytes(GltfModel model) {
    model.json["buffers"] = GltfJson::array({{{"byteLength", model.bytes.size()}}});
    std::string text = model.json.dump(-1, ' ', false, GltfJson::error_handler_t::replace);
    pad(model.bytes, '\0');
    pad(text, ' ');
    std::string head;
    append_word(head, gltf::kMagic);
    append_word(head, 2);
    append_word(head, 12 + 8 + text.size() + 8 + model.bytes.size());
    append_chunk_head(head, gltf::kJsonChunk, text);
    head += text;
    append_chunk_head(head, gltf::kBinaryChunk, model.bytes);
    model.bytes.insert(0, head);
    return std::move(model.bytes);
}

}  // namespace burnish
