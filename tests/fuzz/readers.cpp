#include "fuzz/readers.h"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <fstream>
#include <string>

#include "burnish/checkpoint.h"
#include "burnish/photograph.h"
#include "captures/capture.h"
#include "captures/colmap_model.h"
#include "captures/pictures.h"
#include "captures/views_transforms.h"
#include "cli/batch_jobs.h"
#include "cli/mesh_file.h"
#include "cli/options_file.h"
#include "core/hash.h"
#include "file_bytes.h"
#include "image/image.h"
#include "mitsuba/load.h"
#include "mitsuba/obj.h"
#include "mitsuba/ply.h"
#include "mitsuba/serialized.h"
#include "mitsuba/spectra.h"

namespace burnish::fuzz {

namespace fs = std::filesystem;

namespace {

/// The bytes are the fields of a state: behind a header whose size and hash fit, which no mutation
/// would find.
void read_state(const fs::path& file) {
    constexpr std::size_t kSize = 12, kHash = 20, kFields = 28;  // offsets: docs/reference/state.md
    std::string bytes = save_state(State()).substr(0, kFields) + test::bytes_of(file);
    const std::uint64_t size = bytes.size() - kFields;
    const std::uint64_t hash = hash_of(std::string_view(bytes).substr(kFields));
    std::memcpy(bytes.data() + kSize, &size, sizeof size);
    std::memcpy(bytes.data() + kHash, &hash, sizeof hash);
    load_state(bytes);
}

/// The bytes are the sizes of two sections of a checkpoint, and three sections: behind a header
/// whose sizes and hashes fit. One of two processes reads it, too.
void read_checkpoint_sections(const fs::path& file) {
    constexpr std::size_t kSections = 16;  // offset of their sizes: docs/reference/checkpoint.md
    static const std::string start =
        test::bytes_of(fs::path(BURNISH_FUZZ_CORPUS) / "checkpoint/whole.burnish")
            .substr(0, kSections);
    const std::string given = test::bytes_of(file);
    std::array<std::uint32_t, 2> sizes{};
    std::memcpy(sizes.data(), given.data(), std::min(given.size(), sizeof sizes));
    std::string_view left = std::string_view(given).substr(std::min(given.size(), sizeof sizes));
    std::string header = start, sections;
    const auto add = [](std::string& to, std::uint64_t number) {
        to.append(reinterpret_cast<const char*>(&number), sizeof number);
    };
    for (std::size_t i = 0; i < 3; ++i) {
        const std::string_view section = left.substr(0, i < 2 ? sizes[i] : left.size());
        left.remove_prefix(section.size());
        add(header, section.size()), add(header, hash_of(section));
        sections += section;
    }
    add(header, hash_of(header));
    std::ofstream(file, std::ios::binary) << header << sections;
    const std::string folder = file.parent_path().string();
    try {
        load_checkpoint(folder, {1, 2, {}});
    } catch (const Error&) {
    }
    load_checkpoint(folder);
}

/// Bytes that do not begin as a file does are a mesh before it is compressed: mutations of a
/// compressed one would not come past zlib's checksum.
void read_serialized_mesh(const fs::path& file) {
    constexpr std::string_view kStart("\x1c\x04\x04\0", 4);
    const std::string mesh = test::bytes_of(file);
    if (!mesh.starts_with(kStart.substr(0, 2))) {
        uLongf size = compressBound(mesh.size());
        std::string packed(size, '\0');
        compress2(reinterpret_cast<Bytef*>(packed.data()), &size,
                  reinterpret_cast<const Bytef*>(mesh.data()), mesh.size(), 1);
        packed.resize(size);
        const std::string list(8, '\0'), count("\x01\0\0\0", 4);
        std::ofstream(file, std::ios::binary) << kStart << packed << list << count;
    }
    mitsuba::read_serialized(file, 0);
}

void read_spectrum(const fs::path& file) {
    mitsuba::rgb_of_spectrum(mitsuba::read_spectrum_file(file), mitsuba::SpectrumUse::kReflectance,
                             {});
}

/// Some files can be read without the texture coordinates of corners alone.
void read_ply(const fs::path& file) {
    try {
        mitsuba::read_ply_file(file);
    } catch (const Error&) {
    }
    mitsuba::read_ply_file(file, {.corner_uvs = true});
}

/// A run reads the headers of its pictures first.
void read_picture(const fs::path& file) {
    try {
        read_image_header(file);
    } catch (const Error&) {
    }
    read_photograph(file.string());
}
void read_glb_mesh(const fs::path& file) { read_mesh(file); }

/// Arguments name files of options: those of the reader's folder are read. What may name another is
/// left out, as a read of a device may never end.
void read_job_list(const fs::path& file) {
    const std::string text = test::bytes_of(file);
    const auto has = [&](const char* part) { return text.find(part) != std::string::npos; };
    if (has("\\u") || has("\\/") || (has("--options") && has("/"))) return;
    const fs::path before = fs::current_path();
    fs::current_path(file.parent_path());
    try {
        read_jobs(file.string());
    } catch (...) {
        fs::current_path(before);
        throw;
    }
    fs::current_path(before);
}

constexpr Reader kReaders[] = {
    {"scene", "scene.xml", [](const fs::path& file) { load_scene(file); }},
    {"ply", "read.ply", read_ply},
    {"obj", "read.obj", [](const fs::path& file) { mitsuba::read_obj_file(file); }},
    {"glb", "read.glb", read_glb_mesh},
    {"serialized", "read.serialized", read_serialized_mesh},
    {"spectrum", "read.spd", read_spectrum},
    {"exr", "read.exr", read_picture},
    {"png", "read.png", read_picture},
    {"jpeg", "read.jpg", read_picture},
    {"hdr", "read.hdr", read_picture},
    {"pfm", "read.pfm", read_picture},
    {"tga", "read.tga", read_picture},
    {"bmp", "read.bmp", read_picture},
    {"mask", "mask.png", [](const fs::path& file) { read_mask(file, Turning::kUpright); }},
    {"capture", "capture.json", [](const fs::path& file) { read_capture(file.string()); }},
    {"transforms", "transforms.json",
     [](const fs::path& file) { read_transforms(file.string(), ""); }},
    {"colmap_cameras_text", "cameras.txt",
     [](const fs::path& file) { read_cameras_text(file.string()); }},
    {"colmap_images_text", "images.txt",
     [](const fs::path& file) { read_images_text(file.string()); }},
    {"colmap_cameras_binary", "cameras.bin",
     [](const fs::path& file) { read_cameras_binary(file.string()); }},
    {"colmap_images_binary", "images.bin",
     [](const fs::path& file) { read_images_binary(file.string()); }},
    {"options", "options.json", [](const fs::path& file) { read_options_file(file.string()); }},
    {"jobs", "jobs.json", read_job_list},
    {"checkpoint", "0000000001.burnish",
     [](const fs::path& file) { load_checkpoint(file.parent_path().string()); }},
    {"checkpoint_sections", "0000000001.burnish", read_checkpoint_sections},
    {"state", "state", read_state},
};

void copy_from_corpus(const char* name, const fs::path& to) {
    fs::copy_file(fs::path(BURNISH_FUZZ_CORPUS) / name, to);
}

}  // namespace

std::span<const Reader> readers() { return kReaders; }

const Reader* find_reader(std::string_view name) {
    const auto found = std::find_if(std::begin(kReaders), std::end(kReaders),
                                    [&](const Reader& r) { return name == r.name; });
    return found == std::end(kReaders) ? nullptr : found;
}

Folder::Folder(const Reader& reader) : reader_(reader) {
    copy_from_corpus("png/rgb.png", folder_.path / "image.png");
    copy_from_corpus("ply/ascii.ply", folder_.path / "mesh.ply");
    copy_from_corpus("obj/quad.obj", folder_.path / "mesh.obj");
    copy_from_corpus("serialized/two.serialized", folder_.path / "mesh.serialized");
    copy_from_corpus("spectrum/lamp.spd", folder_.path / "lamp.spd");
    copy_from_corpus("scene/diffuse_point.xml", folder_.path / "part.xml");
    copy_from_corpus("options/settings.json", folder_.path / "options.json");
}

void Folder::read(std::string_view bytes) const {
    const fs::path file = folder_.path / reader_.file;
    std::ofstream(file, std::ios::binary)
        .write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    reader_.read(file);
}

}  // namespace burnish::fuzz
