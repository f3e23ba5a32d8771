#include "mitsuba/node.h"

#include <fmt/format.h>

#include <utility>

#include "burnish/error.h"

namespace burnish::mitsuba {

std::string place_text(const Place& place) {
    return fmt::format("{}:{}:{}", place.file, place.line, place.column);
}

std::string sentence(const Place& place, const std::string& text) {
    return place_text(place) + ": " + text;
}

void fail(const Place& place, const std::string& text) { throw InputError(sentence(place, text)); }

void fail_unsupported(const Place& place, const std::string& text) {
    throw Unsupported(sentence(place, text));
}

const std::string& attribute(const Node& node, const std::string& name) {
    static const std::string empty;
    for (const auto& [key, value] : node.attributes)
        if (key == name) return value;
    return empty;
}

std::string* find_attribute(Node& node, const std::string& name) {
    for (auto& [key, value] : node.attributes)
        if (key == name) return &value;
    return nullptr;
}

std::string id_or(const Node& node, std::string fallback) {
    const std::string& id = attribute(node, "id");
    return id.empty() ? std::move(fallback) : id;
}

Node make_value(const std::string& tag, const std::string& name, const std::string& value,
                const Place& place) {
    return {tag, {{"name", name}, {"value", value}}, {}, place, kNew};
}

bool is_value(const Node& node) {
    static const std::set<std::string> kValues{"float", "integer", "boolean", "string",   "rgb",
                                               "srgb",  "point",   "vector",  "transform"};
    return kValues.count(node.tag) > 0 ||
           (node.tag == "spectrum" && attribute(node, "type").empty());
}

std::size_t size_of(const Node& node) {
    std::size_t size = sizeof(Node);
    for (const auto& [key, value] : node.attributes)
        size += sizeof(std::pair<std::string, std::string>) + value.size();
    for (const Node& child : node.children) size += size_of(child);
    return size;
}

void add_referred(std::size_t& bytes, const Node& ref, const Node& target) {
    constexpr std::size_t kMax = std::size_t{1} << 28;
    bytes += size_of(target);
    if (bytes > kMax)
        fail(ref.place,
             fmt::format("the values that references mean hold more than {} bytes", kMax));
}

void drop_children(Node& node, const std::set<std::string>& names) {
    std::erase_if(node.children,
                  [&](const Node& n) { return names.count(attribute(n, "name")) > 0; });
}

}  // namespace burnish::mitsuba
