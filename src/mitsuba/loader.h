// What the plugin readers share: the document, the scene in the making, and what has been built
// from which element. To add a plugin: its reader in the file of its family, and its name in that
// family's dispatch.
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <string>
#include <tuple>
#include <unordered_set>
#include <vector>

#include "mitsuba/loaded_scene.h"
#include "mitsuba/mesh.h"
#include "mitsuba/properties.h"
#include "mitsuba/xml.h"
#include "scene/value_range.h"

namespace burnish::mitsuba {

/// The prototypes of a shapegroup; none where all its shapes were left out.
struct ShapeGroup {
    std::uint32_t first = 0, count = 0;
    Box box = {};  ///< around all of them
};

/// The triangles of a mesh and what is known at its vertices or faces, for textures that read it.
struct AttributeSource {
    std::filesystem::path file = {};
    std::vector<Triangle> triangles = {};
    std::vector<MeshAttribute> attributes = {};
};

/// How many values of a texture lie outside of what materials read.
struct OutsideValues {
    std::string texture;                    ///< what messages call it
    std::ptrdiff_t of_one = 0, of_two = 0;  ///< outside [0, 1] and [0, 2]
};

struct FoundParameter {
    int order = 0;  ///< in the document
    Parameter parameter;
    ParameterSource source;
};

struct Loader {
    Document document;
    LoadOptions options;
    LoadedScene result;
    std::map<const Node*, TextureId> textures;
    std::map<const Node*, OutsideValues> outside;  ///< of textures, until they are warned of
    std::map<const Node*, BsdfId> bsdfs;
    std::map<const Node*, MaterialId> materials;
    /// By what their tables depend on: shape, alpha, eta.
    std::map<std::tuple<FacetShape, float, float>, RoughPlastic> rough_plastics;
    std::vector<FoundParameter> parameters;
    std::vector<const Node*> children;  ///< of the scene, but those whose name a later one has, too
    const Node* environment = nullptr;  ///< the envmap or constant emitter
    std::map<const Node*, ShapeGroup> groups;
    AttributeSource attributes;                     ///< of the shape that is being read
    std::map<const Node*, bool> attribute_readers;  ///< whether an element reads one, once asked
    int bsdfs_inside = 0;     ///< the bsdf that is being read, itself among them
    int shapes = 0;           ///< seen so far, for made-up ids
    std::size_t members = 0;  ///< shapes inside of others, read so far
    std::unordered_set<const Node*> shapes_read;
    bool is_read_again = false;  ///< the shape that is being read was read before
    std::unordered_set<const Node*> surfaces_read;  ///< bsdfs, emitters of shapes, also if left out
    std::size_t read_again = 0;  ///< bytes of what several elements hold, but for the first reading
    double kept = 0;             ///< bytes of the meshes and images that were read
};

void log_warning(Loader& loader, const Place& place, const std::string& text);
void note(Loader& loader, const Place& place, const std::string& text);

/// The id of an element; where it has none, the made-up one, with "_" behind it while the scene
/// gives that to another element.
std::string id_or_made_up(const Loader& loader, const Node& node, std::string made_up);

// One reader per family. All throw InputError with file:line:column.
void load_integrator(Loader& loader, const Node& node);
/// Warns where `volpath` goes further than `path`, as which it is read. Of a scene that is read.
void warn_short_paths(Loader& loader, const Node& integrator);
Film read_film(Loader& loader, const Node& node);
/// That of a sensor without one.
Film default_film(const LoadOptions& options);
/// Returns the samples per pixel.
int read_sampler(Loader& loader, const Node& node, int fallback);
/// number: of the sensor, from 0. The first one sets the scene's sample count.
SceneSensor read_sensor(Loader& loader, const Node& node, std::size_t number);
/// A camera that sees the whole scene, for a scene without one.
SceneSensor default_sensor(Loader& loader);
void load_shape(Loader& loader, const Node& node);
/// A shape element that is none of the kinds below. Where it emits, its emitter is added to the
/// scene, whose next shape it must become.
Shape read_shape(Loader& loader, Properties& properties, bool emits);
/// A shape is read, with its file, for each that holds it, and few bytes can name it many times:
/// begin_reading says which is read, and count_again adds bytes of it where it was read before.
/// Both throw InputError where all these are too many.
void begin_reading(Loader& loader, const Node& shape);
void count_again(Loader& loader, const Node& shape, std::size_t bytes);
/// Adds to the same bytes those of any element that is read again.
void add_again(Loader& loader, const Node& node, std::size_t bytes);
/// Refuses a shape with a coordinate beyond kMaxDistance: distances overflow far beyond, and
/// nothing would be hit. The box must not be empty.
void require_reach(const Place& place, const Box& box);
/// Refuses a camera or a light, `what`, that stands further than kMaxDistance from the origin, or
/// where transforms overflow.
void require_reach(const Place& place, const char* what, const Vec3<double>& position);
/// The shapes `instance`, `shapegroup` and `merge`, which hold others.
bool is_compound(const std::string& type);
void load_compound(Loader& loader, Properties& properties);
/// Warns where something is left out, with ignore_unsupported; else throws on.
void leave_out(Loader& loader, const Unsupported& error, const std::string& what);
/// Calls body, which is left out where it throws Unsupported. Whether it was not.
template <class Body>
bool read_or_leave_out(Loader& loader, const std::string& what, const Body& body) {
    try {
        body();
    } catch (const Unsupported& error) {
        leave_out(loader, error, what);
        return false;
    }
    return true;
}
/// An emitter that is no part of a shape.
void load_emitter(Loader& loader, const Node& node);
/// The `area` emitter inside a shape.
AreaEmitter load_area_emitter(Loader& loader, const Node& node, ShapeId shape);
/// The material of a bsdf element, built once; `id` names it where the scene does not.
MaterialId load_material(Loader& loader, const Node& node, const std::string& id);
/// What a texture is read for: a material's share or colour, its `diff_trans`, or what may have any
/// value (light, heights, what nobody has referred to yet).
enum class TextureUse { kMaterial, kDiffTrans, kAny };
/// Values of a material from 0 up to this are not warned of.
inline float max_of(TextureUse use) { return use == TextureUse::kDiffTrans ? kMaxDiffTrans : 1.0f; }
/// The tables of all `roughplastic`, which take some 20 ms for each that differs.
void make_rough_plastics(Loader& loader);
/// The texture of an element, built once. Values that it has beyond its use are warned of once.
TextureId load_texture(Loader& loader, const Node& node, TextureUse use = TextureUse::kMaterial);
/// texture: what messages call it. The values are finite and read times `scale`.
OutsideValues outside_values(std::string texture, const std::vector<float>& values,
                             float scale = 1);
/// Horizontal, in degrees, from fov, fov_axis or focal_length; aspect: width / height. A note where
/// fov_axis has no effect.
double take_fov_x(Loader& loader, Properties& properties, double aspect);

/// Calls LoadOptions::before_reading. bytes: beside those of the file.
void tell_reading(const Loader& loader, const std::filesystem::path& file, double bytes);
/// An image file that the scene names, with the place in its errors.
ImageFile load_image(Loader& loader, const Place& place, const std::string& name);
/// Replaces what is not finite by 0 and says how many there were.
void replace_non_finite(Loader& loader, const Place& place, const std::string& name,
                        std::vector<float>& values);

}  // namespace burnish::mitsuba
