// The XML layer of the scene language: text -> a tree of nodes in which defaults are substituted
// and includes are spliced in. Every node knows where it was written; what a node means is decided
// by the plugin readers.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace burnish::mitsuba {

/// Where something was written; line and column count from 1, column in bytes.
struct Place {
    std::string file;
    int line = 0, column = 0;
};

/// "FILE:LINE:COLUMN: text" as one sentence.
std::string sentence(const Place& place, const std::string& text);
/// Throws that sentence as InputError.
[[noreturn]] void fail(const Place& place, const std::string& text);

struct Node {
    std::string tag;
    std::vector<std::pair<std::string, std::string>>
        attributes;              ///< $parameters already substituted
    std::vector<Node> children;  ///< without default, include, path and alias
    Place place;
    int order = 0;  ///< position in document order, over all files
};

/// The value of an attribute; empty where it is absent.
const std::string& attribute(const Node& node, const std::string& name);

struct Document {
    Node root;  ///< the <scene>
    std::map<std::string, const Node*>
        ids;  ///< ids and aliases -> nodes below root; the tree must not change any more
    std::filesystem::path top_folder;  ///< of the top-level scene: nothing outside is read
    std::vector<std::filesystem::path> search_folders;  ///< <path>, in order
    std::vector<std::string> warnings, notes;
};

/// Reads a scene and its includes. `definitions` win over <default>. Throws InputError: malformed
/// XML, an unknown tag or attribute, an unresolved $parameter, a missing or recursive include, a
/// duplicate id. An open $integrator is "direct", said in a note.
Document parse_document(const std::filesystem::path& file,
                        const std::map<std::string, std::string>& definitions);

/// The node that a <ref> names; throws InputError where there is none.
const Node& resolve_ref(const Document& document, const Node& ref);

/// The file that a name of the scene means: beside the file that names it, in the <path> folders,
/// or beside the top-level scene. Throws InputError: empty, missing, or outside the folder of the
/// top-level scene.
std::filesystem::path resolve_file(const Document& document, const Place& place,
                                   const std::string& name);

}  // namespace burnish::mitsuba
