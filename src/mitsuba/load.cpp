#include "mitsuba/load.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <map>
#include <set>
#include <string_view>
#include <unordered_set>
#include <utility>

#include "burnish/error.h"
#include "mitsuba/attributes.h"
#include "mitsuba/colors.h"
#include "mitsuba/loader.h"
#include "mitsuba/upgrade.h"

namespace burnish {

namespace mitsuba {

void log_warning(Loader& loader, const Place& place, const std::string& text) {
    loader.result.warnings.push_back(sentence(place, text));
}

void note(Loader& loader, const Place& place, const std::string& text) {
    loader.result.notes.push_back(sentence(place, text));
}

std::string id_or_made_up(const Loader& loader, const Node& node, std::string made_up) {
    while (loader.document.ids.contains(made_up)) made_up += '_';
    return id_or(node, std::move(made_up));
}

void leave_out(Loader& loader, const Unsupported& error, const std::string& what) {
    if (!loader.options.ignore_unsupported) throw error;
    loader.result.warnings.push_back(fmt::format("{}: left out, {}", error.what(), what));
}

namespace {

/// The children that count: as in Mitsuba, where they are properties of the scene, of a name the
/// last one, whatever it is. What has an id can still be referred to.
void find_children(Loader& loader) {
    static const std::set<std::string> kSeen{"shape", "emitter", "sensor", "integrator"};
    const std::vector<Node>& children = loader.document.root.children;
    std::map<std::string_view, const Node*> last;
    for (const Node& node : children)
        if (const std::string& name = attribute(node, "name"); !name.empty() && node.tag != "ref")
            last[name] = &node;
    for (const Node& node : children) {
        const std::string& name = attribute(node, "name");
        const auto later = last.find(name);
        if (later == last.end() || later->second == &node || !kSeen.count(node.tag)) {
            loader.children.push_back(&node);
            continue;
        }
        log_warning(loader, node.place,
                    fmt::format("the {} named \"{}\" is left out: the element at {} has the same "
                                "name, and of a name the last one counts",
                                node.tag, name, place_text(later->second->place)));
    }
}

/// The first element of a tag; a note where there are more.
const Node* first_of(Loader& loader, const char* tag) {
    const Node* first = nullptr;
    for (const Node* node : loader.children) {
        if (node->tag != tag) continue;
        if (first)
            note(loader, node->place,
                 fmt::format("the scene has a second {}: the first is taken", tag));
        else
            first = node;
    }
    return first;
}

/// Emitters that the shapes below an element refer to: they stand at the top of the scene but
/// belong to the shape.
void find_emitters_of_shapes(const Document& document, const Node& node,
                             std::set<const Node*>& found) {
    for (const Node& child : node.children) {
        if (child.tag == "shape") find_emitters_of_shapes(document, child, found);
        if (node.tag != "shape" || child.tag != "ref") continue;
        const Node& target = resolve_ref(document, child);
        if (target.tag == "emitter") found.insert(&target);
    }
}

/// Materials and textures at the top of the scene that read mesh attributes are built with the
/// shapes that have these.
void load_object(Loader& loader, const Node& node, const std::set<const Node*>& owned,
                 int& materials) {
    if (is_color_plugin(node)) return;  // read where it is referred to
    if (node.tag == "shape") {
        load_shape(loader, node);
    } else if (node.tag == "bsdf") {
        const std::string id = id_or_made_up(loader, node, fmt::format("bsdf_{}", materials++));
        if (!reads_attribute(loader, node)) load_material(loader, node, id);
    } else if (node.tag == "texture") {
        if (!reads_attribute(loader, node)) load_texture(loader, node, TextureUse::kAny);
    } else if (node.tag == "emitter") {
        loader.attributes = {};  // it is of no shape
        if (!owned.count(&node)) load_emitter(loader, node);
    } else if (node.tag == "medium" || node.tag == "phase" || node.tag == "volume") {
        fail_unsupported(node.place,
                         fmt::format("<{}> (participating media) is not supported yet: expected "
                                     "surfaces only",
                                     node.tag));
    } else if (!std::set<std::string>{"integrator", "sensor", "ref"}.count(node.tag) &&
               attribute(node, "id").empty()) {  // with one it is for those that refer to it
        log_warning(loader, node.place,
                    fmt::format("<{}> has no meaning directly inside <scene>: ignored", node.tag));
    }
}

void load_objects(Loader& loader) {
    std::set<const Node*> owned;
    find_emitters_of_shapes(loader.document, loader.document.root, owned);
    int materials = 0;
    for (const Node* node : loader.children)
        read_or_leave_out(loader, "the scene goes on without it",
                          [&] { load_object(loader, *node, owned, materials); });
    make_rough_plastics(loader);
}

/// The first sensor must be one that can be read; of the others those that can.
void load_sensors(Loader& loader) {
    Scene& scene = loader.result.scene;
    std::size_t number = 0;
    for (const Node* node : loader.children) {
        if (node->tag != "sensor") continue;
        try {
            scene.sensors.push_back(read_sensor(loader, *node, number++));
        } catch (const InputError& e) {
            const bool go_on =
                loader.options.ignore_unsupported && dynamic_cast<const Unsupported*>(&e);
            if (scene.sensors.empty() && !go_on) throw;
            loader.result.notes.push_back(std::string(e.what()) + ": the sensor is left out");
        }
    }
    if (scene.sensors.size() > 1)
        note(loader, loader.document.root.place,
             fmt::format("the scene has {} sensors: \"{}\" is taken where none is named",
                         scene.sensors.size(), scene.sensors.front().id));
}

void use_first_sensor(Scene& scene) {
    scene.camera = scene.sensors.front().camera;
    scene.film = scene.sensors.front().film;
}

/// Returns it; null: there is none.
const Node* load_integrator_of_scene(Loader& loader) {
    const Node* integrator = first_of(loader, "integrator");
    if (integrator)
        read_or_leave_out(loader, "\"direct\" is taken",
                          [&] { load_integrator(loader, *integrator); });
    else
        note(loader, loader.document.root.place,
             "the scene has no integrator: \"direct\" is taken");
    return integrator;
}

void collect_parameters(Loader& loader) {
    std::stable_sort(loader.parameters.begin(), loader.parameters.end(),
                     [](const auto& a, const auto& b) { return a.order < b.order; });
    for (FoundParameter& found : loader.parameters) {
        loader.result.scene.parameters.push_back(std::move(found.parameter));
        loader.result.source.parameters.push_back(std::move(found.source));
    }
}

/// What stands in the place of a reference to a value.
Node value_at(const Node& ref, const Node& target) {
    Node value = target;
    std::erase_if(value.attributes, [](const auto& a) { return a.first == "name"; });
    if (const std::string& name = attribute(ref, "name"); !name.empty())
        value.attributes.emplace_back("name", name);
    value.place = ref.place;
    value.order = ref.order;
    return value;
}

/// Attributes that have no meaning and that Mitsuba 3 refuses.
void drop_attributes(Node& node) {
    const bool is_step = node.tag == "translate" || node.tag == "scale" || node.tag == "rotate";
    const bool has_id = !is_step && !is_value(node);
    std::erase_if(node.attributes, [&](const auto& a) {
        return (a.first == "id" && !has_id) || (a.first == "name" && is_step) ||
               (a.first == "version" && node.tag != "scene") || a.first == "unit";
    });
}

/// A colour that is sRGB-encoded, which Mitsuba 3 has as a plugin alone.
void write_linear(Node& srgb) {
    const Rgbf color = read_color({attribute(srgb, "name"), &srgb, &srgb});
    srgb.tag = "rgb";
    *find_attribute(srgb, "value") = fmt::format("{}, {}, {}", color.x, color.y, color.z);
}

/// References name the id that their target was given, not an alias; a value takes their place.
/// copied: bytes of such values so far.
void resolve_reference(const Document& document, Node& ref, std::size_t& copied) {
    const Node& target = resolve_ref(document, ref);
    if (!is_value(target)) {
        *find_attribute(ref, "id") = attribute(target, "id");
        return;
    }
    add_referred(copied, ref, target);
    ref = value_at(ref, target);
}

/// Whether an element refers to a value without a name, which nothing reads.
bool means_nothing(const Document& document, const Node& node) {
    return node.tag == "ref" && attribute(node, "name").empty() &&
           is_value(resolve_ref(document, node));
}

/// Resolves references, and finds the files that elements name: elements that nobody has read can
/// name some that are not there.
void resolve_names(const Document& document, Node& node, SceneSource& source, std::size_t& copied) {
    if (node.tag == "ref") resolve_reference(document, node, copied);
    drop_attributes(node);
    std::erase_if(node.children, [&](const Node& n) { return means_nothing(document, n); });
    if (node.tag == "string" && attribute(node, "name") == "filename")
        if (auto file = find_file(document, node.place, attribute(node, "value")); !file.empty())
            source.files.emplace(node.order, std::move(file));
    if (node.tag == "srgb") write_linear(node);
    for (Node& child : node.children) resolve_names(document, child, source, copied);
}

/// Films get the size that replaces theirs; a sensor without one gets a film.
void set_film_sizes(const Loader& loader, Node& node) {
    const auto is_film = [&](const Node& n) { return target_of(loader.document, n).tag == "film"; };
    if (node.tag == "sensor" && std::none_of(node.children.begin(), node.children.end(), is_film))
        node.children.push_back({"film", {{"type", "hdrfilm"}}, {}, node.place, kNew});
    for (Node& child : node.children) set_film_sizes(loader, child);
    if (node.tag != "film") return;
    drop_children(
        node, {"width", "height", "crop_width", "crop_height", "crop_offset_x", "crop_offset_y"});
    const auto set = [&](const char* name, int value) {
        node.children.push_back(make_value("integer", name, std::to_string(value), node.place));
    };
    set("width", loader.options.width);
    set("height", loader.options.height);
}

/// What was read, to be written again. The document is spent.
void keep_source(Loader& loader) {
    SceneSource& source = loader.result.source;
    source.folder = loader.document.top_folder;
    source.bsdfs.resize(loader.result.scene.bsdfs.size(), -1);
    source.root = loader.document.root;
    std::erase_if(source.root.children, [&](const Node& n) {  // they are where they are meant
        return is_value(target_of(loader.document, n));
    });
    std::size_t copied = 0;
    resolve_names(loader.document, source.root, source, copied);
    replace_old_plugins(source.root);
    if (loader.options.width > 0 && loader.options.height > 0) set_film_sizes(loader, source.root);
}

/// What several elements refer to is read, and warned of, for each of them.
void drop_repeated(std::vector<std::string>& sentences) {
    std::unordered_set<std::string> said;
    std::erase_if(sentences, [&](const std::string& text) { return !said.insert(text).second; });
}

}  // namespace

}  // namespace mitsuba

LoadedScene load_scene(const std::filesystem::path& file, const LoadOptions& options) {
    using namespace mitsuba;
    Loader loader;
    loader.options = options;
    loader.document = parse_document(file, options.definitions);
    loader.result.notes = loader.document.notes;
    loader.result.warnings = loader.document.warnings;
    find_children(loader);
    const Node* integrator = load_integrator_of_scene(loader);
    load_sensors(loader);
    load_objects(loader);
    if (integrator) warn_short_paths(loader, *integrator);
    std::vector<SceneSensor>& sensors = loader.result.scene.sensors;
    if (sensors.empty()) sensors.push_back(default_sensor(loader));
    use_first_sensor(loader.result.scene);
    if (loader.result.scene.emitters.empty())
        log_warning(loader, loader.document.root.place,
                    "the scene has no emitter: everything is black");
    collect_parameters(loader);
    keep_source(loader);
    drop_repeated(loader.result.warnings);
    drop_repeated(loader.result.notes);
    return std::move(loader.result);
}

}  // namespace burnish
