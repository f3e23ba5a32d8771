// Everything that Burnish reads, as functions of bytes: for fuzzers, and for the replay of their
// corpus.
#pragma once

#include <filesystem>
#include <span>
#include <string_view>

#include "temporary_folder.h"

namespace burnish::fuzz {

/// A reader of files. Its corpus is tests/fuzz/corpus/NAME, its dictionary tests/fuzz/NAME.dict.
struct Reader {
    const char* name;
    const char* file;  ///< what its files are called on the disk
    void (*read)(const std::filesystem::path& file);
};

std::span<const Reader> readers();

/// Null: there is none of this name.
const Reader* find_reader(std::string_view name);

/// A folder of its own for the files of one reader: with what a scene may name, an image
/// `image.png`, meshes `mesh.ply`, `mesh.obj` and `mesh.serialized`, a spectrum `lamp.spd` and a
/// scene `part.xml`; with options `options.json`, which jobs may name. It goes with the object.
class Folder {
  public:
    explicit Folder(const Reader& reader);

    /// Reads the bytes as a file. Throws what the reader throws.
    void read(std::string_view bytes) const;

  private:
    const Reader& reader_;
    test::TemporaryFolder folder_;
};

}  // namespace burnish::fuzz
