#include "mitsuba/upgrade.h"
#include "core/lower_case.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstddef>
#include <set>

namespace burnish::mitsuba {

namespace {

bool is_lower(char c) { return std::islower(static_cast<unsigned char>(c)) != 0; }
bool is_upper(char c) { return std::isupper(static_cast<unsigned char>(c)) != 0; }

/// Takes the child of that name out of the node; its value, or the fallback where there is none.
std::string take_value(Node& node, const char* name, const char* fallback) {
    const auto found = std::find_if(node.children.begin(), node.children.end(),
                                    [&](const Node& n) { return attribute(n, "name") == name; });
    if (found == node.children.end()) return fallback;
    std::string value = attribute(*found, "value");
    node.children.erase(found);
    return value;
}

bool has_child(const Node& node, const char* name) {
    return std::any_of(node.children.begin(), node.children.end(),
                       [&](const Node& n) { return attribute(n, "name") == name; });
}

/// uoffset, voffset, uscale, vscale -> to_uv: the offset first, then the scale.
void upgrade_uv(Node& texture) {
    constexpr std::array kNames{"uoffset", "voffset", "uscale", "vscale"};
    if (std::none_of(kNames.begin(), kNames.end(),
                     [&](const char* name) { return has_child(texture, name); }))
        return;
    const auto element = [&](const char* tag, const char* u, const char* v, const char* fallback) {
        return Node{
            tag,
            {{"x", take_value(texture, u, fallback)}, {"y", take_value(texture, v, fallback)}},
            {},
            texture.place,
            kNew};
    };
    Node offset = element("translate", "uoffset", "voffset", "0");
    Node scale = element("scale", "uscale", "vscale", "1");
    texture.children.push_back({"transform",
                                {{"name", "to_uv"}},
                                {std::move(offset), std::move(scale)},
                                texture.place,
                                kNew});
}

/// "trilinear" and "ewa" look at more texels than one look-up; bilinear is what is left of them.
/// Any of them may have capitals.
void upgrade_filter(Node& texture) {
    for (Node& child : texture.children)
        if (attribute(child, "name") == "filter_type")
            if (std::string* value = find_attribute(child, "value")) {
                *value = lower_case(*value);
                if (*value == "trilinear" || *value == "ewa") *value = "bilinear";
            }
}

/// Texels of gamma 1 are numbers. Any other gamma is left to be warned of.
void upgrade_gamma(Node& texture) {
    for (Node& child : texture.children)
        if (attribute(child, "name") == "gamma")
            if (const std::string value = attribute(child, "value"); value == "1" || value == "1.0")
                child = make_value("boolean", "raw", "true", child.place);
}

/// The scale of a bump map is that of a texture around its own, or around a reference to that,
/// which goes.
void upgrade_bump_map(Node& bsdf) {
    for (Node& child : bsdf.children) {
        if (child.tag != "texture" || attribute(child, "type") != "scale") continue;
        const auto inner =
            std::find_if(child.children.begin(), child.children.end(),
                         [](const Node& n) { return n.tag == "texture" || n.tag == "ref"; });
        if (inner == child.children.end()) return;
        Node texture = std::move(*inner);
        Node scale = make_value("float", "scale", take_value(child, "scale", "1"), child.place);
        child = std::move(texture);
        bsdf.children.push_back(std::move(scale));
        return;
    }
}

void rename_child(Node& node, const char* from, const char* to) {
    for (Node& child : node.children)
        if (std::string* name = find_attribute(child, "name"); name && *name == from) *name = to;
}

void rename_type(Node& node, const std::set<std::string>& from, const char* to) {
    if (std::string* type = find_attribute(node, "type"); type && from.count(*type)) *type = to;
}

void replace_film(Node& film) {
    static const std::set<std::string> kFormats{"openexr", "exr", "rgbe", "pfm"};
    drop_children(film, {"banner", "gamma", "attach_log", "high_quality_edges"});
    rename_type(film, {"ldrfilm"}, "hdrfilm");
    std::erase_if(film.children, [](const Node& n) {
        return attribute(n, "name") == "file_format" &&
               kFormats.count(lower_case(attribute(n, "value"))) == 0;
    });
    for (Node& child : film.children)
        if (attribute(child, "name") == "pixel_format")
            if (std::string* value = find_attribute(child, "value");
                value && lower_case(*value) == "luminancealpha")
                *value = "luminance_alpha";
}

void replace_sampler(Node& sampler) {
    rename_type(sampler, {"sobol", "halton", "hammersley"}, "independent");
    drop_children(sampler, {"scramble", "dimension"});
    const std::string type = attribute(sampler, "type");
    if (type != "orthogonal") drop_children(sampler, {"strength"});
    if (type == "independent" || type == "ldsampler") drop_children(sampler, {"jitter"});
}

}  // namespace

std::string snake_case(const std::string& name) {
    std::string result;
    for (std::size_t i = 0; i < name.size(); ++i) {
        if (i == 0 || !is_upper(name[i]) || !is_lower(name[i - 1])) {
            result += name[i];
            continue;
        }
        result += '_';
        for (; i < name.size() && is_upper(name[i]); ++i) result += lower_case(name[i]);
        --i;
    }
    return result;
}

void upgrade(Node& node) {
    if (node.tag == "lookAt") node.tag = "lookat";
    if (std::string* name = find_attribute(node, "name")) *name = snake_case(*name);
    for (Node& child : node.children) upgrade(child);
    if (node.tag == "bsdf" && attribute(node, "type") == "diffuse")
        rename_child(node, "diffuse_reflectance", "reflectance");
    if (node.tag == "bsdf" && attribute(node, "type") == "bumpmap") upgrade_bump_map(node);
    if (node.tag == "texture") {
        upgrade_uv(node);
        upgrade_filter(node);
        upgrade_gamma(node);
    }
    if (node.tag == "scene")
        if (std::string* version = find_attribute(node, "version")) *version = "3.0.0";
}

void replace_old_plugins(Node& node) {
    for (Node& child : node.children) replace_old_plugins(child);
    if (node.tag == "integrator") {
        drop_children(node, {"strict_normals"});
        rename_type(node, {"volpath_simple", "bdpt", "mlt", "pssmlt", "erpt"}, "path");
    }
    if (node.tag == "film") replace_film(node);
    if (node.tag == "sampler") replace_sampler(node);
    if (node.tag == "texture") drop_children(node, {"cache", "max_anisotropy"});
    // A focal length, which is 50mm where nothing is said, has its field of view on the diagonal.
    if ((node.tag == "sensor" || node.tag == "emitter") && !has_child(node, "fov"))
        drop_children(node, {"fov_axis"});
}

}  // namespace burnish::mitsuba
