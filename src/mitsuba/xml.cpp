#include "mitsuba/xml.h"

#include <fmt/format.h>

#include <algorithm>
#include <pugixml.hpp>
#include <set>
#include <string_view>
#include <system_error>

#include "core/utf8.h"
#include "image/files.h"
#include "mitsuba/spectra.h"
#include "mitsuba/substitute.h"
#include "mitsuba/tags.h"
#include "mitsuba/upgrade.h"

namespace burnish::mitsuba {

namespace fs = std::filesystem;

namespace {

constexpr int kMaxDepth = 64;             ///< nested elements
constexpr std::size_t kMaxIncludes = 15;  ///< nested files
// Of a scene with all that it includes: far more than any has, little enough to give up soon.
constexpr int kMaxElements = 1'000'000;
constexpr std::size_t kMaxFiles = 4096, kMaxText = std::size_t{1} << 28;
constexpr std::uintmax_t kMaxIncluded = std::uintmax_t{1} << 29;  ///< bytes of all files
// Of <path>: each file may be looked for in all of them.
constexpr std::size_t kMaxFolders = 64;

struct Parser {
    Document document;
    Definitions definitions;
    std::vector<fs::path> open_files;  ///< the chain of includes
    std::vector<std::pair<Node, std::string>> aliases;
    int order = 0;
    std::size_t files = 0, text = 0;  ///< so far; text: bytes of attributes
    std::uintmax_t included = 0;      ///< bytes so far
};

/// Offsets of the starts of lines -> places. LF, CR or CR LF ends a line.
struct Lines {
    std::string file;
    std::vector<std::size_t> starts{0};

    Lines(std::string name, const std::string& text) : file(std::move(name)) {
        for (std::size_t i = 0; i < text.size(); ++i)
            if (text[i] == '\n' || (text[i] == '\r' && text.substr(i + 1, 1) != "\n"))
                starts.push_back(i + 1);
    }
    Place at(std::size_t offset) const {
        const auto next = std::upper_bound(starts.begin(), starts.end(), offset);
        return {file, static_cast<int>(next - starts.begin()),
                static_cast<int>(offset - *std::prev(next)) + 1};
    }
};

/// An integrator that the scene leaves to the command line.
bool is_open_integrator(const Node& node, const std::string& name, const std::string& text,
                        const Parser& parser) {
    return node.tag == "integrator" && name == "type" && text == "$integrator" &&
           !is_defined(parser.definitions, "integrator");
}

void add_text(Parser& parser, std::size_t bytes, const Place& place) {
    parser.text += bytes;
    if (parser.text > kMaxText)
        fail(place, fmt::format("the attributes of the scene hold more than {} bytes", kMaxText));
}

void read_attributes(Parser& parser, const pugi::xml_node& xml, Node& node) {
    for (const pugi::xml_attribute& a : xml.attributes()) {
        std::string value = a.value();
        if (is_open_integrator(node, a.name(), value, parser)) {
            value = "direct";
            parser.document.notes.push_back(
                sentence(node.place, "the scene leaves $integrator open: \"direct\" is taken"));
        } else if (!(node.tag == "default" && std::string_view(a.name()) == "name")) {
            value = substitute(parser.definitions, value, node.place);
        }
        add_text(parser, value.size(), node.place);
        node.attributes.emplace_back(a.name(), std::move(value));
    }
    check_attributes(node);
}

/// Puts what the file of a spectrum holds in the place of its name.
void read_spectrum(Parser& parser, Node& spectrum) {
    for (auto& [name, value] : spectrum.attributes) {
        if (name != "filename") continue;
        if (!attribute(spectrum, "value").empty())
            fail(spectrum.place,
                 "<spectrum> has the attributes \"value\" and \"filename\", expected one");
        value = read_spectrum_file(resolve_file(parser.document, spectrum.place, value));
        name = "value";
        add_text(parser, value.size(), spectrum.place);
        return;
    }
}

int major_version(const Node& root) {
    const std::string& version = attribute(root, "version");
    int major = -1;
    if (version.empty() || version.find_first_not_of("0123456789.") != std::string::npos ||
        (major = std::atoi(version.substr(0, 4).c_str()), major < 0))
        fail(root.place,
             fmt::format("found the version \"{}\", expected one such as \"3.0.0\"", version));
    if (major > 3)
        fail(root.place, fmt::format("found the version \"{}\", expected at most 3: later "
                                     "languages are not known",
                                     version));
    return major;
}

/// Files before version 2.0 are upgraded; an included one that does not say is as old as the file
/// that includes it.
void read_version(Parser& parser, Node& root) {
    if (root.tag != "scene" && attribute(root, "version").empty()) return;
    const std::string version = attribute(root, "version");
    if (major_version(root) >= 2) return;
    parser.document.notes.push_back(sentence(
        root.place,
        fmt::format("version {} is upgraded: old names become those of version 3.0.0", version)));
    upgrade(root);
}

void read_children(Parser& parser, const Lines& lines, const pugi::xml_node& xml, Node& node,
                   int depth);
Node read_file(Parser& parser, const fs::path& file, const std::string& shown, const Place* from);

void read_include(Parser& parser, const Node& include, Node& parent) {
    const fs::path file =
        resolve_file(parser.document, include.place, attribute(include, "filename"));
    Node root = read_file(parser, file, file.string(), &include.place);
    if (root.tag != "scene")
        parent.children.push_back(std::move(root));
    else
        std::move(root.children.begin(), root.children.end(), std::back_inserter(parent.children));
}

void read_path(Parser& parser, const Node& path) {
    const fs::path folder = resolve_file(parser.document, path.place, attribute(path, "value"));
    if (!fs::is_directory(status_of(folder)))
        fail(path.place,
             fmt::format("<path> names \"{:.200}\", which is no folder", attribute(path, "value")));
    const fs::path real = real_path(folder);
    std::vector<SearchFolder>& folders = parser.document.search_folders;
    if (!folders.empty() && folders.back().real.native() == real.native()) return;
    parser.document.files.clear();
    const auto listed = std::find_if(folders.begin(), folders.end(), [&](const SearchFolder& f) {
        return f.real.native() == real.native();
    });
    if (listed != folders.end()) {
        std::rotate(listed, listed + 1, folders.end());
        return;
    }
    if (folders.size() == kMaxFolders)
        fail(path.place, fmt::format("<path> names more than {} folders, expected at most as many",
                                     kMaxFolders));
    folders.push_back({folder, real});
}

/// Acts on default, include, path and alias; false for every other element.
bool read_directive(Parser& parser, const Node& node, Node& parent) {
    if (node.tag == "default") {
        define(parser.definitions, attribute(node, "name"), attribute(node, "value"), node.place);
    } else if (node.tag == "include") {
        read_include(parser, node, parent);
    } else if (node.tag == "path" || node.tag == "alias") {
        if (parent.tag != "scene")
            fail(node.place,
                 fmt::format("found <{}> inside <{}>, expected it directly inside <scene>",
                             node.tag, parent.tag));
        if (node.tag == "path")
            read_path(parser, node);
        else
            parser.aliases.emplace_back(node, attribute(node, "as"));
    } else {
        return false;
    }
    return true;
}

Node read_node(Parser& parser, const Lines& lines, const pugi::xml_node& xml, int depth) {
    Node node;
    node.tag = xml.name();
    // pugixml points behind the '<'.
    node.place =
        lines.at(static_cast<std::size_t>(std::max<std::ptrdiff_t>(xml.offset_debug() - 1, 0)));
    node.order = parser.order++;
    if (parser.order > kMaxElements)
        fail(node.place, fmt::format("the scene has more than {} elements", kMaxElements));
    if (depth > kMaxDepth)
        fail(node.place, fmt::format("elements are nested deeper than {}", kMaxDepth));
    check_tag(node);
    read_attributes(parser, xml, node);
    if (node.tag == "spectrum") read_spectrum(parser, node);
    read_children(parser, lines, xml, node, depth);
    return node;
}

void read_children(Parser& parser, const Lines& lines, const pugi::xml_node& xml, Node& node,
                   int depth) {
    bool is_text_told = false;
    for (const pugi::xml_node& child : xml.children()) {
        if (child.type() != pugi::node_element) {
            if (!is_text_told)
                parser.document.warnings.push_back(
                    sentence(node.place, fmt::format("the text \"{:.40}\" inside <{}> is left out",
                                                     child.value(), node.tag)));
            is_text_told = true;
            continue;
        }
        Node read = read_node(parser, lines, child, depth + 1);
        if (read.tag == "scene")
            fail(read.place, "found <scene> inside another element, expected it at the top");
        if (!read_directive(parser, read, node)) node.children.push_back(std::move(read));
    }
}

/// Before it is read.
void add_included(Parser& parser, const fs::path& file, const Place& place) {
    std::error_code error;
    const std::uintmax_t size = fs::file_size(file, error);
    if (!error) parser.included += size;  // reading it says why not
    if (parser.included > kMaxIncluded)
        fail(place, fmt::format("the files that the scene includes hold more than {} bytes, "
                                "expected at most as many",
                                kMaxIncluded));
}

Node read_file(Parser& parser, const fs::path& file, const std::string& shown, const Place* from) {
    const fs::path key = real_path(file);
    if (from && std::find(parser.open_files.begin(), parser.open_files.end(), key) !=
                    parser.open_files.end())
        fail(*from, fmt::format("the include of \"{}\" is a cycle", shown));
    if (from && parser.open_files.size() > kMaxIncludes)
        fail(*from, fmt::format("includes are nested deeper than {}", kMaxIncludes));
    if (++parser.files > kMaxFiles)
        fail(*from, fmt::format("the scene includes more than {} files", kMaxFiles - 1));
    parser.open_files.push_back(key);

    if (from) add_included(parser, file, *from);
    require_short_text(file, "a Mitsuba scene");
    const std::string text = read_text_bytes(file);
    const Lines lines(shown, text);
    if (const std::size_t end = utf8_prefix(text); end < text.size())
        fail(lines.at(end),
             "found text that is not UTF-8, expected a scene that is saved as UTF-8");
    pugi::xml_document xml;
    const pugi::xml_parse_result result =
        xml.load_buffer(text.data(), text.size(), pugi::parse_default, pugi::encoding_utf8);
    if (result.status == pugi::status_no_document_element)
        fail(lines.at(0), "found no XML, expected a Mitsuba scene");
    if (!result)
        fail(lines.at(static_cast<std::size_t>(std::max<std::ptrdiff_t>(result.offset, 0))),
             fmt::format("malformed XML: {}", result.description()));
    const pugi::xml_node top = xml.document_element();
    if (!top) fail(lines.at(0), "found no element, expected <scene version=\"3.0.0\">");
    if (!from && std::string_view(top.name()) != "scene")
        fail(lines.at(static_cast<std::size_t>(top.offset_debug() - 1)),
             fmt::format("found <{}> at the top, expected <scene version=\"3.0.0\">", top.name()));
    Node root = read_node(parser, lines, top, 0);
    read_version(parser, root);
    parser.open_files.pop_back();
    return root;
}

void collect_ids(Document& document, const Node& node) {
    const std::string& id = node.tag == "ref" ? std::string() : attribute(node, "id");
    if (!id.empty()) {
        const auto [earlier, is_new] = document.ids.emplace(id, &node);
        if (!is_new)
            fail(node.place,
                 fmt::format("the id \"{}\" is taken by the element at {}, expected another", id,
                             place_text(earlier->second->place)));
    }
    for (const Node& child : node.children) collect_ids(document, child);
}

void add_aliases(Document& document, const std::vector<std::pair<Node, std::string>>& aliases) {
    for (const auto& [node, name] : aliases) {
        const auto found = document.ids.find(attribute(node, "id"));
        if (found == document.ids.end())
            fail(node.place, fmt::format("no element has the id \"{}\" that <alias> names",
                                         attribute(node, "id")));
        if (!document.ids.emplace(name, found->second).second)
            fail(node.place,
                 fmt::format("the id \"{}\" is taken, expected another for <alias>", name));
    }
}

/// Depth-first over children and references: a node met again while it is open closes a cycle.
void check_cycles(const Document& document, const Node& node, std::set<const Node*>& open,
                  std::set<const Node*>& done) {
    if (done.count(&node)) return;
    if (open.size() > 4 * kMaxDepth)
        fail(node.place, "elements and references are nested too deeply");
    open.insert(&node);
    for (const Node& child : node.children) {
        const Node& target = target_of(document, child);
        if (open.count(&target))
            fail(child.place,
                 fmt::format("the reference to \"{}\" is a cycle", attribute(child, "id")));
        check_cycles(document, target, open, done);
    }
    open.erase(&node);
    done.insert(&node);
}

}  // namespace

const Node& resolve_ref(const Document& document, const Node& ref) {
    const auto found = document.ids.find(attribute(ref, "id"));
    if (found == document.ids.end())
        fail(ref.place,
             fmt::format("no element has the id \"{}\" that <ref> names", attribute(ref, "id")));
    return *found->second;
}

const Node& target_of(const Document& document, const Node& node) {
    return node.tag == "ref" ? resolve_ref(document, node) : node;
}

Document parse_document(const fs::path& file, const std::map<std::string, std::string>& given) {
    Parser parser;
    parser.definitions = command_line_definitions(given);
    parser.document.top_folder = real_path(file).parent_path();
    parser.document.named_folder = file.parent_path();
    parser.document.root = read_file(parser, file, file.string(), nullptr);
    check_given(parser.definitions, file.string());
    Document document = std::move(parser.document);
    for (const Node& child : document.root.children) collect_ids(document, child);
    add_aliases(document, parser.aliases);
    std::set<const Node*> open, done;
    check_cycles(document, document.root, open, done);
    return document;
}

}  // namespace burnish::mitsuba
