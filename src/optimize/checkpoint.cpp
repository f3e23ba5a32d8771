#include "optimize/checkpoint.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <fstream>
#include <functional>
#include <utility>

#include "burnish/error.h"
#include "core/hash.h"
#include "core/require.h"
#include "core/version.h"
#include "image/files.h"
#include "optimize/ranks.h"
#include "optimize/run_inputs.h"
#include "optimize/whole_state.h"

namespace burnish {

namespace fs = std::filesystem;

void fields(auto& archive, Is<Iteration> auto& v) {
    archive(v.number, v.loss, v.held_out_loss, v.seconds, v.image_seconds, v.derivative_seconds,
            v.step_seconds, v.paths, v.derivatives, v.texels, v.reservoirs, v.rejected_image,
            v.rejected_derivatives);
}
void fields(auto& archive, Is<RunCounts> auto& v) {
    archive(v.iterations, v.paths, v.derivatives, v.rejected_image, v.rejected_derivatives);
}
void fields(auto& archive, Is<SearchedValues> auto& v) { archive(v.values, v.loss, v.regions); }
void fields(auto& archive, Is<SearchedGroup> auto& v) { archive(v.unknowns, v.tried, v.guides); }
// The sections but the state.
void fields(auto& archive, Is<Checkpoint> auto& v) {
    archive(v.program, v.problem, v.settings, v.files);
}
void fields(auto& archive, Is<Summary> auto& v) {
    archive(v.iterations, v.counts, v.seconds, v.search_seconds, v.searched);
}

namespace {

constexpr std::size_t kDigits = 10;  // of the number of iterations, in a name
constexpr const char* kExtension = ".burnish";

std::string file_name(std::uint32_t iterations) {
    return fmt::format("{:0{}}{}", iterations, kDigits, kExtension);
}

bool is_checkpoint_name(const std::string& name) {
    return name.find_first_not_of("0123456789") == kDigits && name.substr(kDigits) == kExtension;
}

}  // namespace

std::vector<fs::path> checkpoints_in(const fs::path& folder) {
    std::vector<fs::path> files;
    std::error_code error, ignored;
    const fs::directory_iterator entries(folder, error);
    if (error && error != std::errc::no_such_file_or_directory &&
        error != std::errc::not_a_directory)
        throw OutputError(folder.string() + ": cannot be read: " + error.message());
    for (const auto& entry : entries)
        if (is_checkpoint_name(entry.path().filename().string()) && entry.is_regular_file(ignored))
            files.push_back(entry.path());
    std::sort(files.begin(), files.end());
    return files;
}

namespace {

constexpr char kCheckpointMagic[] = {'B', 'U', 'R', 'N', 'I', 'S', 'H', 'C'};
constexpr std::uint32_t kVersion = 4;

constexpr std::size_t kKept = 2;

struct Header {
    std::array<char, 8> magic = std::to_array(kCheckpointMagic);
    std::uint32_t version = kVersion, state_version = kStateVersion;
    std::array<std::uint64_t, 6> sections{};  ///< bytes and hash of each of the three
    std::uint64_t hash = 0;                   ///< of all before
};
static_assert(sizeof(Header) == 72);

std::uint64_t header_hash(const Header& header) {
    return hash_of({reinterpret_cast<const char*>(&header), offsetof(Header, hash)});
}

void remove(const std::vector<fs::path>& files) {
    std::error_code ignored;
    for (const fs::path& file : files) fs::remove(file, ignored);
}

/// The oldest go.
void keep(std::size_t count, std::vector<fs::path> files) {
    files.resize(files.size() - std::min(count, files.size()));
    remove(files);
}

template <class T>
void write_section(const T& values, std::size_t number, FileWriter& file, Header& header) {
    Hasher hasher;
    std::uint64_t& bytes = header.sections[2 * number];
    ArchiveWriter([&](const void* from, std::size_t size) {
        hasher.add(from, size);
        file.write(from, size);
        bytes += size;
    })(values);
    header.sections[2 * number + 1] = hasher.hash();
}

/// before: what is done once it lies on the disk, before it has its name.
void write_file(const fs::path& path, const Checkpoint& about, const Summary& run,
                const WholeState& state, const std::function<void()>& before) {
    FileWriter file(path);
    Header header;
    file.write(&header, sizeof header);
    write_section(about, 0, file, header);
    write_section(run, 1, file, header);
    write_section(state, 2, file, header);
    header.hash = header_hash(header);
    file.replace_start(&header, sizeof header);
    file.finish(before);
}

/// Reads a file from its start to its end.
class FileReader {
  public:
    explicit FileReader(const fs::path& file)
        : name_(file.string()), stream_(file, std::ios::binary) {
        std::error_code error;
        left_ = fs::file_size(file, error);
        if (!stream_ || error) fail("cannot be opened");
    }
    std::uint64_t left() const { return left_; }
    [[noreturn]] void fail(const std::string& what) const { throw InputError(name_ + ": " + what); }
    void read(void* to, std::size_t size) {
        stream_.read(static_cast<char*>(to), static_cast<std::streamsize>(size));
        if (stream_.gcount() != static_cast<std::streamsize>(size)) fail("is cut off");
        left_ -= size;
    }

  private:
    std::string name_;
    std::ifstream stream_;
    std::uint64_t left_ = 0;
};

Header read_header(FileReader& file) {
    Header header;
    if (file.left() < sizeof header) file.fail("is cut off");
    file.read(&header, sizeof header);
    if (header.magic != Header{}.magic) file.fail("is no checkpoint");
    if (header.hash != header_hash(header)) file.fail("the header is damaged");
    if (header.version != kVersion || header.state_version != kStateVersion)
        file.fail(
            fmt::format("is of version {}.{}, of another version of the program: expected {}.{}",
                        header.version, header.state_version, kVersion, kStateVersion));
    std::uint64_t bytes = 0;
    for (std::size_t i = 0; i < header.sections.size(); i += 2) bytes += header.sections[i];
    if (bytes != file.left())
        file.fail(fmt::format("holds {} bytes behind the header, expected {}", file.left(), bytes));
    return header;
}

/// Before anything of it is believed.
void require_whole(const fs::path& path) {
    FileReader file(path);
    const Header header = read_header(file);
    std::vector<char> buffer(std::size_t{1} << 20);
    for (std::size_t i = 0; i < header.sections.size(); i += 2) {
        Hasher hasher;
        for (std::uint64_t left = header.sections[i]; left > 0;) {
            const auto size =
                static_cast<std::size_t>(std::min<std::uint64_t>(left, buffer.size()));
            file.read(buffer.data(), size);
            hasher.add(buffer.data(), size);
            left -= size;
        }
        if (hasher.hash() != header.sections[i + 1])
            file.fail(fmt::format("section {} is damaged", i / 2));
    }
}

template <class T>
void read_section(const fs::path& path, std::uint64_t bytes, FileReader& file, T& values) {
    ArchiveReader reader(path.string(), bytes,
                         [&](void* to, std::size_t size) { file.read(to, size); });
    reader(values);
    reader.require_end();
}

Checkpoint read_file(const fs::path& path, const Ranks& ranks) {
    require_whole(path);
    FileReader file(path);
    const Header header = read_header(file);
    Checkpoint checkpoint;
    checkpoint.file = path.string();
    State::Values state;
    read_section(path, header.sections[0], file, checkpoint);
    read_section(path, header.sections[2], file, checkpoint.run);
    OwnState own{state, ranks};
    read_section(path, header.sections[4], file, own);
    checkpoint.run.search_effort = state.search_effort;
    checkpoint.run.searched_again = state.searched_again;
    checkpoint.run.state = State(std::move(state));
    return checkpoint;
}

}  // namespace

Checkpoint load_checkpoint(const std::string& folder, const Ranks& ranks) {
    check_rank(ranks.rank, ranks.count);
    std::vector<fs::path> files = checkpoints_in(folder);
    std::vector<std::string> damaged;
    for (auto file = files.rbegin(); file != files.rend(); ++file) {
        try {
            Checkpoint checkpoint = read_file(*file, ranks);
            checkpoint.damaged = std::move(damaged);
            return checkpoint;
        } catch (const InputError& error) {
            damaged.push_back(error.what());
        }
    }
    throw InputError(damaged.empty() ? folder + ": holds no checkpoint to go on from"
                                     : damaged.front());
}

std::vector<std::string> warnings_of(const Checkpoint& checkpoint, const std::string& run) {
    std::vector<std::string> warnings;
    for (const std::string& damaged : checkpoint.damaged)
        warnings.push_back(damaged + ": the one before it is taken");
    if (checkpoint.program != version_text())
        warnings.push_back(fmt::format("{} began with {}: with {} the bytes may be others", run,
                                       checkpoint.program, version_text()));
    return warnings;
}

double expected_writing_seconds(const State::Values& state) {
    constexpr double kSlowDisk = 2.5e8;  // bytes per second
    std::uint64_t bytes = 0;
    ArchiveWriter([&](const void*, std::size_t size) { bytes += size; })(state);
    return static_cast<double>(bytes) / kSlowDisk;
}

CheckpointWriter::CheckpointWriter(const Checkpoints& options, std::vector<Input> problem,
                                   const Ranks& ranks, std::optional<std::uint32_t> first)
    : options_(options),
      problem_(std::move(problem)),
      ranks_(ranks),
      replaced_(options.replaced.begin(), options.replaced.end()) {
    require(!options_.folder.empty(), "the folder of the checkpoints has no name: expected one");
    const bool is_noted = agree(ranks_, static_cast<bool>(options_.note));
    do_on_first(ranks_, [&] {
        if (!is_noted) make_folder(options_.folder);
        for (const fs::path& file : checkpoints_in(options_.folder))
            if (!first || file.filename() > file_name(*first)) stale_.push_back(file);
    });
    if (!is_first(ranks_)) return;
    std::error_code ignored;
    for (const auto& entry : fs::directory_iterator(options_.folder, ignored))
        if (is_temporary(entry.path())) fs::remove(entry.path(), ignored);
}

std::vector<fs::path> CheckpointWriter::own_checkpoints() const {
    std::vector<fs::path> own = checkpoints_in(options_.folder);
    std::erase_if(own, [&](const fs::path& file) {
        return std::find(stale_.begin(), stale_.end(), file) != stale_.end();
    });
    return own;
}

/// One that is whole is left.
void CheckpointWriter::make_room() const {
    const std::vector<fs::path> own = own_checkpoints();
    if (!own.empty()) remove(stale_);
    keep(1, own.empty() ? stale_ : own);
}

void CheckpointWriter::remove_stale() {
    remove(std::exchange(stale_, {}));
    remove(std::exchange(replaced_, {}));
}

void CheckpointWriter::write(const Summary& run, const WholeState& state, const fs::path& file) {
    const fs::path folder = options_.folder;
    std::error_code error;
    fs::create_directories(folder, error);
    Checkpoint about;
    about.program = version_text(), about.problem = problem_;
    about.settings = options_.settings, about.files = options_.files;
    const auto write_it = [&] { write_file(file, about, run, state, [&] { remove_stale(); }); };
    try {
        write_it();
    } catch (const OutputError&) {
        if (checkpoints_in(folder).size() < kKept) throw;
        make_room();
        write_it();
    }
    try {
        sync_folder(folder);
    } catch (const OutputError&) {
        keep(kKept + 1, own_checkpoints());  // the newest may be lost
        throw;
    }
    keep(kKept, checkpoints_in(folder));
}

bool CheckpointWriter::is_due(const State::Values& state) const {
    if (since_.total() < options_.seconds) return false;
    const double takes = took_ ? *took_ : ranks_.count * expected_writing_seconds(state);
    return since_.total() >= kRest * takes;
}

bool CheckpointWriter::offer(const Summary& run, const State::Values& state, bool is_last) {
    if (!agree(ranks_, is_last || is_due(state))) return state.iteration == written_;
    const fs::path file = fs::path(options_.folder) / file_name(state.iteration);
    CheckpointNote note{file.string(), state.iteration, is_last, {}};
    const WholeState whole{state, ranks_};
    try {
        if (agree(ranks_, state.iteration != written_)) {
            const Stopwatch watch;
            write_whole(whole, [&] { write(run, whole, file); });
            written_ = state.iteration, took_ = watch.total();
        }
    } catch (const OutputError& error) {
        if (!agree(ranks_, static_cast<bool>(options_.note))) throw;
        note.error = error.what();
    }
    since_ = Stopwatch();
    if (options_.note && is_first(ranks_)) options_.note(note);
    return state.iteration == written_;
}

}  // namespace burnish
