// The XML layer of the scene language: text -> a tree of nodes in which defaults are substituted
// and includes are spliced in. Every node knows where it was written; what a node means is decided
// by the plugin readers.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "mitsuba/node.h"

namespace burnish::mitsuba {

/// Of a <path>.
struct SearchFolder {
    std::filesystem::path named, real;  ///< as the scene has it, and behind links
};

struct Document {
    Node root;  ///< the <scene>
    /// Ids and aliases -> nodes below root; the tree must not change any more.
    std::map<std::string, const Node*> ids;
    std::filesystem::path top_folder;    ///< of the top-level scene: nothing outside is read
    std::filesystem::path named_folder;  ///< the same as the scene was named, behind a link another
    std::vector<SearchFolder> search_folders;  ///< in order
    /// What find_file has found with these folders: the folder that names a file, and the name.
    mutable std::map<std::pair<std::string, std::string>, std::filesystem::path> files;
    std::vector<std::string> notes, warnings;
    std::size_t referred = 0;  ///< bytes of the values that references meant, as often as read
};

/// Reads a scene and its includes. `definitions` win over <default>. Throws InputError: malformed
/// XML, an unknown tag or attribute, an unresolved $parameter, a definition that nothing uses, a
/// missing or recursive include, a duplicate id. An open $integrator is "direct", said in a note.
Document parse_document(const std::filesystem::path& file,
                        const std::map<std::string, std::string>& definitions);

/// The node that a <ref> names; throws InputError where there is none.
const Node& resolve_ref(const Document& document, const Node& ref);
/// The element itself, or the one that it refers to.
const Node& target_of(const Document& document, const Node& node);

/// The file that a name of the scene means: in the <path> folders, the last one first, beside the
/// top-level scene, or beside the included file that names it. Throws InputError: empty, missing,
/// or outside the folder of the top-level scene.
std::filesystem::path resolve_file(const Document& document, const Place& place,
                                   const std::string& name);
/// The same; empty where that throws.
std::filesystem::path find_file(const Document& document, const Place& place,
                                const std::string& name);

}  // namespace burnish::mitsuba
