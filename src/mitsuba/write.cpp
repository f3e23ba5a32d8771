#include "mitsuba/write.h"

#include <fmt/format.h>

#include <pugixml.hpp>
#include <sstream>

#include "burnish/error.h"
#include "core/variant.h"
#include "image/files.h"

namespace burnish {

namespace fs = std::filesystem;

namespace mitsuba {

namespace {

/// N: Node or const Node.
template <class N>
N* find_element(N& node, int order) {
    if (node.order == order) return &node;
    for (N& child : node.children)
        if (N* found = find_element(child, order)) return found;
    return nullptr;
}

/// `format` goes as well: Mitsuba's half floats would round.
void set_file(Node& texture, const std::string& file) {
    drop_children(texture, {"filename", "format"});
    texture.children.insert(texture.children.begin(), make_value("string", "filename", file));
}

Node new_bitmap(const std::string& name, const BitmapFile& bitmap) {
    Node texture{"texture", {{"type", "bitmap"}, {"name", name}}, {}, {}, kNew};
    set_file(texture, bitmap.file);
    texture.children.push_back(make_value("boolean", "raw", bitmap.raw ? "true" : "false"));
    return texture;
}

void apply(const NewValue& change, Node& root) {
    const auto* bitmap = std::get_if<BitmapFile>(&change.value);
    if (bitmap && change.at.texture >= 0) {
        if (Node* texture = find_element(root, change.at.texture)) set_file(*texture, bitmap->file);
        return;
    }
    Node* bsdf = find_element(root, change.at.bsdf);
    if (!bsdf) return;
    const std::string& name = change.at.property;
    drop_children(*bsdf, {name});
    bsdf->children.push_back(match(
        change.value, [&](const BitmapFile& b) { return new_bitmap(name, b); },
        [&](float v) { return make_value("float", name, fmt::format("{}", v)); },
        [&](const Rgbf& c) {
            return make_value("rgb", name, fmt::format("{}, {}, {}", c.x, c.y, c.z));
        }));
}

/// Throws InputError where the file lies outside of the scene's folder: it may have become a link
/// since the scene was read.
std::string relative_name(const SceneSource& source, const fs::path& file) {
    status_of(file);  // says why it cannot be opened
    const fs::path name = real_path(file).lexically_relative(source.folder);
    if (name.empty() || *name.begin() == "..")
        throw InputError(
            fmt::format("{}: leads out of the scene's folder, expected a file inside {}",
                        file.string(), source.folder.string()));
    return name.string();
}

void copy_in(const fs::path& from, const fs::path& to) {
    make_folder(to.parent_path());
    write_bytes(to, read_bytes(from));
}

/// Copies what the elements name, and names the copies.
void copy_files(const SceneSource& source, const fs::path& folder, Node& node) {
    if (const auto found = source.files.find(node.order); found != source.files.end()) {
        const std::string name = relative_name(source, found->second);
        copy_in(found->second, folder / name);
        if (std::string* value = find_attribute(node, "value")) *value = name;
    }
    for (Node& child : node.children) copy_files(source, folder, child);
}

/// A $ of a value is no parameter.
std::string escaped(const std::string& value) {
    std::string text;
    for (const char c : value) {
        if (c == '$') text += '\\';
        text += c;
    }
    return text;
}

void append(pugi::xml_node parent, const Node& node) {
    pugi::xml_node xml = parent.append_child(node.tag.c_str());
    for (const auto& [key, value] : node.attributes)
        xml.append_attribute(key.c_str()) = escaped(value).c_str();
    for (const Node& child : node.children) append(xml, child);
}

std::string xml_text(const Node& root) {
    pugi::xml_document document;
    append(document, root);
    std::ostringstream text;
    document.save(text, "    ", pugi::format_default | pugi::format_no_declaration,
                  pugi::encoding_utf8);
    return text.str();
}

}  // namespace

}  // namespace mitsuba

void write_scene(const SceneSource& source, const std::vector<NewValue>& values,
                 const fs::path& folder) {
    mitsuba::Node root = source.root;
    for (const NewValue& value : values) mitsuba::apply(value, root);
    make_folder(folder);
    mitsuba::copy_files(source, folder, root);
    write_bytes(folder / "scene.xml", mitsuba::xml_text(root));
}

std::string file_of(const SceneSource& source, const ParameterSource& parameter) {
    if (parameter.texture < 0) return {};
    const mitsuba::Node* texture = mitsuba::find_element(source.root, parameter.texture);
    if (!texture) return {};
    for (const mitsuba::Node& child : texture->children)
        if (const auto found = source.files.find(child.order); found != source.files.end())
            return mitsuba::relative_name(source, found->second);
    return {};
}

std::vector<std::string> files_of(const SceneSource& source) {
    std::vector<std::string> names;
    for (const auto& [order, file] : source.files)
        names.push_back(mitsuba::relative_name(source, file));
    return names;
}

}  // namespace burnish
