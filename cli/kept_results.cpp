#include "cli/kept_results.h"

#include <fmt/format.h>

#include <cstdint>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <system_error>
#include <utility>

#include "burnish/error.h"
#include "cli/console.h"
#include "cli/folder_content.h"
#include "core/hash.h"
#include "image/files.h"

namespace burnish {

namespace {

constexpr const char* kProgram = "/proc/self/exe";

/// The file that the code was loaded from: the program, or the library where that is shared.
std::filesystem::path code_file() {
    const auto here = reinterpret_cast<std::uintptr_t>(&keep_results);
    std::ifstream maps("/proc/self/maps");
    for (std::string line; std::getline(maps, line);) {
        unsigned long begin = 0, end = 0;
        if (std::sscanf(line.c_str(), "%lx-%lx", &begin, &end) != 2) continue;
        if (here < begin || here >= end || line.find('/') == std::string::npos) continue;
        const std::filesystem::path file = line.substr(line.find('/'));
        std::error_code is_gone;
        const bool is_program = std::filesystem::equivalent(file, kProgram, is_gone);
        return is_program || is_gone ? kProgram : file;
    }
    return kProgram;
}

}  // namespace

std::filesystem::path kept_folder(const std::filesystem::path& report) {
    std::filesystem::path path = report.lexically_normal();
    if (path.filename() == "." || path.filename() == "..")  // a name within another folder
        path = std::filesystem::absolute(path).lexically_normal();
    return without_slash(path) += ".kept";
}

KeptResults keep_results(std::filesystem::path folder) {
    std::error_code ignored;
    const bool is_there = std::filesystem::exists(folder, ignored);
    make_folder(folder);
    require_writable(folder / "trial");
    if (!is_there) std::filesystem::remove(folder, ignored);
    return {std::move(folder), fmt::format("{:016x}", hash_of(read_bytes(code_file())))};
}

std::filesystem::path kept_path(const KeptResults& kept, const std::string& name,
                                const nlohmann::json& made_of) {
    const std::string text =
        made_of.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);  // of any file name
    return kept.folder / fmt::format("{}-{:016x}", name, hash_of(text + kept.program));
}

std::optional<nlohmann::json> find_kept(const KeptResults& kept, const std::string& name,
                                        const nlohmann::json& made_of) {
    const auto file = kept_path(kept, name, made_of);
    if (!std::filesystem::exists(file)) return {};
    try {
        nlohmann::json all = nlohmann::json::from_cbor(read_bytes(file));
        if (all.at("made_of") == made_of && all.at("program") == kept.program)
            return std::move(all.at("result"));
        return {};
    } catch (const nlohmann::json::exception&) {
    } catch (const InputError&) {
    }
    log_info(fmt::format("{} is damaged: it is made again", file.string()));
    return {};
}

void keep(const KeptResults& kept, const std::string& name, const nlohmann::json& made_of,
          const nlohmann::json& result) {
    make_folder(kept.folder);
    std::string bytes;
    nlohmann::json::to_cbor({{"program", kept.program}, {"made_of", made_of}, {"result", result}},
                            nlohmann::detail::output_adapter<char>(bytes));
    write_bytes(kept_path(kept, name, made_of), bytes);
}

void to_json(nlohmann::json& j, const Image& image) {
    std::vector<std::uint8_t> bytes(image.values.size() * sizeof(float));
    std::memcpy(bytes.data(), image.values.data(), bytes.size());
    j = {{"width", image.width},
         {"height", image.height},
         {"channels", image.channels},
         {"values", nlohmann::json::binary(std::move(bytes))}};
}

void from_json(const nlohmann::json& j, Image& image) {
    image = make_image(j.at("width"), j.at("height"), j.at("channels"));
    const auto& bytes = j.at("values").get_binary();
    if (bytes.size() != image.values.size() * sizeof(float))
        throw nlohmann::json::other_error::create(500, "an image of another size", &j);
    std::memcpy(image.values.data(), bytes.data(), bytes.size());
}

void to_json(nlohmann::json& j, const ReproduceOptions& options) {
    // An option that is added does not compile until it is named here.
    const auto& [width, height, texture_side, image_samples, image_window, target_samples,
                 reference_samples, evaluation_samples, iterations, budget, sweep_seconds,
                 max_samples, seed, runs] = options;
    const auto& [budget_iterations, long_iterations, derivative_seconds, seconds] = budget;
    j = {width,
         height,
         texture_side,
         image_samples,
         image_window,
         target_samples,
         reference_samples,
         evaluation_samples,
         iterations,
         budget_iterations,
         long_iterations,
         derivative_seconds,
         seconds,
         sweep_seconds,
         max_samples,
         seed,
         runs};
}

}  // namespace burnish
