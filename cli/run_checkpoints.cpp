#include "cli/run_checkpoints.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <nlohmann/json.hpp>

#include "burnish/error.h"
#include "captures/json_value.h"
#include "cli/console.h"
#include "cli/earlier_run.h"
#include "cli/folder_content.h"
#include "cli/folder_lock.h"
#include "cli/history.h"
#include "cli/interrupt.h"
#include "cli/options_file.h"
#include "image/files.h"
#include "optimize/checkpoint.h"
#include "optimize/ranks.h"

namespace burnish {

namespace fs = std::filesystem;

std::string resume_hint(const OutputFolder& output) {
    return fmt::format("the run is kept: `burnish optimize --resume {}` goes on with it",
                       shell_word(output.folder.string()));
}

namespace {

/// What is not as the run has read it.
std::vector<std::string> changed_files(const std::vector<Input>& files) {
    std::vector<std::string> changed;
    for (const Input& file : files) {
        try {
            if (!(input_of(file.name) == file)) changed.push_back(file.name + " is another file");
        } catch (const InputError& error) {
            changed.push_back(error.what());
        }
    }
    return changed;
}

/// What RunCheckpoints has written beside the state of the run.
nlohmann::json about_run(const Checkpoint& checkpoint) {
    nlohmann::json about = parse_json(checkpoint.settings, checkpoint.file, 0,
                                      "the settings of a run of `burnish optimize`");
    const Value document{about, checkpoint.file, ""};
    for (const char* name : {"settings", "asked", "folder"}) require_member(document, name);
    return about;
}

void require_files(const Checkpoint& checkpoint) {
    const std::vector<std::string> changed = changed_files(checkpoint.files);
    if (changed.empty()) return;
    const nlohmann::json about = about_run(checkpoint);
    const std::string began_in = text(member({about, checkpoint.file, ""}, "folder"));
    throw InputError(fmt::format("{}: the run{} cannot go on: {}", checkpoint.file,
                                 began_in.empty() ? "" : ", which began in " + began_in + ",",
                                 fmt::join(changed, "; ")));
}

}  // namespace

void require_checkpoint(const std::string& folder) {
    if (!checkpoints_in(fs::path(folder) / kCheckpoints).empty()) return;
    if (is_locked(folder)) throw OutputError(fmt::format("{}: {}", folder, kInUse));
    throw InputError(
        fmt::format("{}: {}, expected the folder of a run that was stopped", folder,
                    holds_ended_run(folder) ? "its run is done" : "found no checkpoint"));
}

Checkpoint load_run(const OutputFolder& output, const Ranks& ranks) {
    Checkpoint checkpoint = load_checkpoint(output.checkpoints.string(), ranks);
    for (const std::string& text : warnings_of(checkpoint, "the run")) log_warning(text);
    require_files(checkpoint);
    log_info(fmt::format("going on after {}, {}",
                         count_text(checkpoint.run.counts.iterations, "iteration"),
                         duration_text(checkpoint.run.seconds)));
    return checkpoint;
}

std::optional<Checkpoint> load_second_run(const std::string& folder, const Ranks& ranks) {
    bool is_begun = false;
    do_on_first(ranks, [&] { is_begun = !checkpoints_in(folder).empty(); });
    if (!agree(ranks, is_begun)) return {};
    std::optional<Checkpoint> checkpoint;
    std::string damaged;
    try {
        checkpoint = load_checkpoint(folder, ranks);
    } catch (const InputError& error) {
        damaged = error.what();
    }
    if (!agree(ranks, checkpoint.has_value())) {
        log_warning(damaged + ": the second run begins anew");
        return {};
    }
    if (!checkpoint) throw InputError(damaged);
    for (const std::string& text : warnings_of(*checkpoint, "the second run")) log_warning(text);
    return checkpoint;
}

std::string settings_of(const Checkpoint& checkpoint) {
    return about_run(checkpoint).at("settings").dump();
}

std::string asked_of(const Checkpoint& checkpoint) {
    return about_run(checkpoint).at("asked").dump();
}

RunCheckpoints::RunCheckpoints(const RunResult& run, OutputFolder& output, const std::string& part)
    : output_(output), ranks_(run.ranks), hint_(resume_hint(output)) {
    options_.folder = (output.checkpoints / part).string();
    options_.seconds = run.settings.run.checkpoint_seconds;
    std::error_code gone;  // a folder that somebody has removed has no name
    const nlohmann::ordered_json about{{"settings", settings_json(run.settings)},
                                       {"asked", settings_json(run.asked)},
                                       {"folder", fs::current_path(gone).string()}};
    options_.settings = about.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
    options_.files = run.files;
    options_.stop = interrupted_by_system;
    options_.note = [this](const CheckpointNote& note) { tell(note); };
    do_on_first(ranks_, [&] {  // a second run cannot go on beside another first one
        if (part.empty() && !output.owns_checkpoints)
            for (const fs::path& file : checkpoints_in(output.checkpoints / kCompared))
                options_.replaced.push_back(file.string());
    });
}

void RunCheckpoints::begin(const std::vector<Iteration>& earlier) {
    if (!is_first(ranks_)) return;
    std::error_code ignored;
    fs::create_directories(options_.folder, ignored);
    const fs::path file = fs::path(options_.folder) / kHistory;
    fs::remove(file, ignored);  // it may be a link
    history_.open(file, std::ios::trunc);
    write(history_csv(earlier));
}

void RunCheckpoints::write(const std::string& rows) {
    if (!history_) {  // there was no room: without the part of a row that there was room for
        const fs::path file = fs::path(options_.folder) / kHistory;
        std::error_code ignored;
        history_.close();
        fs::resize_file(file, history_bytes_, ignored);
        history_.clear(), history_.open(file, std::ios::app);
    }
    history_ << rows << std::flush;
    if (history_) history_bytes_ += rows.size();
}

void RunCheckpoints::add(const Iteration& iteration) {
    if (!is_first(ranks_)) return;
    write(history_bytes_ == 0 ? history_csv({iteration}) : history_row(iteration));
}

void RunCheckpoints::tell(const CheckpointNote& note) {
    if (!note.error.empty() && (error_.empty() || note.is_last))
        log_warning(fmt::format("{}; the run {} without this checkpoint", note.error,
                                note.is_last ? "ends" : "goes on"));
    error_ = note.error;
    if (!note.error.empty()) return;
    take_checkpoints(output_, note.file);
    set_on_disk(note.is_last ? OnDisk::kAll : OnDisk::kPart, hint_);
}

void RunCheckpoints::suspend() const {
    do_on_first(ranks_, [&] {  // it alone has heard of an error
        if (!error_.empty()) throw OutputError(error_);
    });
    throw Suspended(hint_);
}

}  // namespace burnish
