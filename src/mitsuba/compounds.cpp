// Shapes that hold others: shapegroup, instance, merge.
#include <fmt/format.h>

#include <cmath>
#include <stdexcept>

#include "mitsuba/loader.h"

namespace burnish::mitsuba {

namespace {

/// Few bytes can name many: each instance holds all shapes of its group, and a `merge` may hold
/// another one twice, which does the same.
constexpr std::size_t kMaxShapes = 2'000'000;

/// Calls read with each shape inside. Those that are not supported are left out one by one.
template <class Read>
void read_members(Loader& loader, Properties& group, const Read& read) {
    for (const Property* child : take_tag(group, "shape")) {
        if (++loader.members > kMaxShapes)
            fail(child->site->place,
                 fmt::format("the scene holds more than {} shapes inside of others, expected at "
                             "most as many",
                             kMaxShapes));
        read_or_leave_out(loader, "the scene goes on without it", [&] { read(*child); });
    }
    warn_unknown(group, loader.result.warnings);
}

void refuse_emitters(Loader& loader, Properties& properties) {
    for (const Property* emitter : take_tag(properties, "emitter"))
        leave_out(loader,
                  Unsupported(sentence(emitter->site->place,
                                       "an emitter inside \"shapegroup\" is not supported yet: "
                                       "expected one on a shape of its own")),
                  "its shape does not shine");
}

/// The shapes inside, of which `merge` gives its own.
void add_members(Loader& loader, Properties& group, std::vector<Shape>& members) {
    read_members(loader, group, [&](const Property& child) {
        Properties properties = open_properties(loader.document, *child.node);
        if (properties.type == "merge") return add_members(loader, properties, members);
        if (is_compound(properties.type))
            fail(child.site->place,
                 fmt::format("found \"{}\" inside \"{}\", expected shapes that hold no others",
                             properties.type, group.type));
        refuse_emitters(loader, properties);
        members.push_back(read_shape(loader, properties, false));
        warn_unknown(properties, loader.result.warnings);
    });
}

const ShapeGroup& load_group(Loader& loader, const Node& node) {
    const auto known = loader.groups.find(&node);
    if (known != loader.groups.end()) return known->second;
    Properties properties = open_properties(loader.document, node);
    std::vector<Shape> members;
    add_members(loader, properties, members);
    if (members.empty() && !loader.options.ignore_unsupported)
        fail(node.place, "the shapegroup is empty, expected a shape inside");
    Box box;
    for (const Shape& member : members) box.include(burnish::box_of(member.geometry));
    auto& prototypes = loader.result.scene.prototypes;
    const ShapeGroup group{static_cast<std::uint32_t>(prototypes.size()),
                           static_cast<std::uint32_t>(members.size()), box};
    prototypes.insert(prototypes.end(), std::make_move_iterator(members.begin()),
                      std::make_move_iterator(members.end()));
    return loader.groups.emplace(&node, group).first->second;
}

/// The inverse, which takes rays to the shapes of an instance; they overflow where it is too large.
Transform to_local_of(const Place& place, const Transform& to_world) {
    Transform to_local;
    try {
        to_local = inverse(to_world);
    } catch (const std::domain_error&) {
        fail(place,
             "\"to_world\" of the instance has no inverse, expected an invertible transform");
    }
    constexpr double kMaxScale = 1e12, kMaxShift = 1e15;
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 4; ++column)
            if (!(std::abs(to_local(row, column)) <= (column < 3 ? kMaxScale : kMaxShift)))
                fail(place,
                     fmt::format(
                         "\"to_world\" of the instance shrinks its shapes beyond what a ray "
                         "can follow, expected a scale of {:g} or more and a shift of at most "
                         "{:g} scales",
                         1 / kMaxScale, kMaxShift));
    return to_local;
}

void load_instance(Loader& loader, Properties& properties) {
    const Place& place = properties.node->place;
    const std::vector<const Property*> shapes = take_tag(properties, "shape");
    if (shapes.size() != 1 || attribute(*shapes[0]->node, "type") != "shapegroup")
        fail(place, "the instance names no shapegroup or several, expected one");
    for (const char* tag : {"bsdf", "emitter"})
        for (const Property* child : take_tag(properties, tag))
            fail(child->site->place,
                 fmt::format("found \"{}\" inside \"instance\", expected it on the shapes of the "
                             "shapegroup",
                             tag));
    const Transform to_world = take_transform(properties, "to_world").value_or(Transform{});
    const Transform to_local = to_local_of(place, to_world);
    const std::string id =
        id_or_made_up(loader, *properties.node, fmt::format("shape_{}", loader.shapes++));
    const ShapeGroup group = load_group(loader, *shapes[0]->node);
    if (!group.box.empty()) require_reach(place, transform_box(to_world, group.box));
    Scene& scene = loader.result.scene;
    if (scene.shapes.size() + group.count > kMaxShapes)
        fail(place, fmt::format("the scene holds more than {} shapes with those of this instance, "
                                "expected at most as many",
                                kMaxShapes));
    for (std::uint32_t i = group.first; i < group.first + group.count; ++i)
        scene.shapes.push_back({group.count == 1 ? id : id + "." + scene.prototypes[i].id,
                                Instance{i, to_world, to_local},
                                scene.prototypes[i].material,
                                {}});
    warn_unknown(properties, loader.result.warnings);
}

}  // namespace

bool is_compound(const std::string& type) {
    return type == "instance" || type == "shapegroup" || type == "merge";
}

void begin_reading(Loader& loader, const Node& shape) {
    constexpr std::size_t kMin = 4096;  // the smallest takes time, too
    loader.is_read_again = !loader.shapes_read.insert(&shape).second;
    count_again(loader, shape, kMin + size_of(shape));
}

void count_again(Loader& loader, const Node& shape, std::size_t bytes) {
    if (loader.is_read_again) add_again(loader, shape, bytes);
}

void add_again(Loader& loader, const Node& node, std::size_t bytes) {
    constexpr std::size_t kMax = std::size_t{1} << 29;
    loader.read_again += bytes;
    if (loader.read_again > kMax)
        fail(node.place, fmt::format("the {} is read again for each that holds it: such elements "
                                     "and their files take more than {} bytes, expected at most "
                                     "as many",
                                     node.tag, kMax));
}

void load_compound(Loader& loader, Properties& properties) {
    if (properties.type == "instance") return load_instance(loader, properties);
    if (properties.type == "shapegroup") {
        load_group(loader, *properties.node);
        return;
    }
    read_members(loader, properties,
                 [&](const Property& child) { load_shape(loader, *child.node); });
}

}  // namespace burnish::mitsuba
