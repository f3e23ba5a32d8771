// burnish batch: a list of optimisations, one after another.

#include <fmt/format.h>

#include <CLI/App.hpp>
#include <cerrno>
#include <cstdio>
#include <system_error>

#include "cli/batch_jobs.h"
#include "cli/commands.h"
#include "cli/console.h"
#include "cli/earlier_run.h"
#include "cli/failures.h"
#include "cli/interrupt.h"
#include "cli/optimize_run.h"
#include "cli/option_text.h"
#include "cli/run_checkpoints.h"
#include "cli/same_settings.h"
#include "core/stopwatch.h"
#include "optimize/ranks.h"

namespace burnish {

namespace {

struct BatchOptions {
    std::string file, slice = "0/1";
};

constexpr const char* kGoesOn = "the batch was stopped: the same command goes on with it";

/// The line of a job, on standard output. Returns the errno of one that did not arrive, or 0.
int print_job(const BatchJob& job, std::size_t count, const std::string& what) {
    const std::string line = printable(
        fmt::format("job {} of {}: {}: {}\n", job.number, count, job.settings.run.output, what));
    return std::fputs(line.c_str(), stdout) != EOF && std::fflush(stdout) == 0 ? 0 : errno;
}

/// Why a job is made anew whose folder holds the results of another one.
void log_change(const BatchJob& job) {
    if (const std::string change = changed_since_results(job.settings); !change.empty())
        log_info(fmt::format("{} holds the results of other settings ({}): the job is made anew",
                             job.settings.run.output, change));
}

/// Runs a job. Returns how it failed, or what is to be said of it.
Failure finish_job(const BatchJob& job, std::size_t count, const Ranks& ranks) {
    const Stopwatch watch;
    const std::string& folder = job.settings.run.output;
    const EarlierRun earlier = agree(ranks, earlier_run(job.settings));
    if (earlier == EarlierRun::kDone) return {kDone, "was done before, " + result_text(folder)};
    log_info(fmt::format("job {} of {}: {}", job.number, count, folder));
    if (earlier == EarlierRun::kNone) log_change(job);
    try {
        finish_run(job.settings, ranks);
    } catch (const Suspended& suspended) {
        return {kInterrupted, suspended.what()};
    }
    if (agree(ranks, interrupted())) return {kInterrupted, "ended by a signal"};
    return {kDone, fmt::format("{}done in {}, {}",
                               earlier == EarlierRun::kStopped ? "went on and is " : "",
                               duration_text(watch.total()), result_text(folder))};
}

/// The same of one of several processes, whether it fails or another; nothing is said where only
/// others have failed.
Failure finish_own(const BatchJob& job, std::size_t count, const Ranks& ranks) {
    const Ranks together = failable(ranks);
    try {
        Failure end = finish_job(job, count, together);
        all_values(together, end.code);  // throws where another one fails
        return end;
    } catch (const FailedElsewhere&) {
        return {kDone, ""};
    } catch (const std::exception&) {
        Failure failure = current_failure();
        failure.text =
            fmt::format("failed with status {}: {}", static_cast<int>(failure.code), failure.text);
        if (ranks.rank > 0) failure.text += fmt::format(" (process {})", ranks.rank);
        tell_stopped(together);
        return failure;
    }
}

/// What the first process that failed says, on all of them.
Failure run_job(const BatchJob& job, std::size_t count, const Ranks& ranks) {
    const Failure own = finish_own(job, count, ranks);
    const std::vector<ExitCode> codes = all_values(ranks, own.code);
    const std::vector<std::string> texts = all_gather(ranks, own.text);
    for (std::size_t r = 0; r < codes.size(); ++r)
        if (codes[r] != kDone) return {codes[r], texts[r]};
    return own;
}

/// Throws BatchFailed where a job has failed, with the status of the first that has; otherwise
/// UnprintedLine where a line did not arrive.
void run_batch(const BatchOptions& options, const Ranks& ranks) {
    const Slice slice = parse_slice(options.slice);
    std::vector<BatchJob> all = read_jobs(options.file);
    require_same_jobs(all, options.slice, ranks);
    const std::size_t count = all.size();
    const std::vector<BatchJob> part = slice_of(std::move(all), slice);
    if (part.empty())
        log_info(fmt::format("{}, none in the part {}", count_text(count, "job"), options.slice));
    ExitCode first = kDone;
    std::size_t failed = 0;
    int output_error = 0;  // of the first line that did not arrive: the jobs go on
    for (const BatchJob& job : part) {
        set_on_disk(OnDisk::kPart, kGoesOn);  // until the job has a checkpoint of its own
        // One that came since the last job's results were whole.
        if (agree(ranks, interrupted())) throw Suspended(kGoesOn);
        const Failure end = run_job(job, count, ranks);
        if (is_first(ranks)) {
            const int error = print_job(job, count, end.text);
            if (output_error == 0) output_error = error;
        }
        if (end.code == kInterrupted) throw Suspended(kGoesOn);
        if (end.code == kDone) continue;
        if (failed++ == 0) first = end.code;
        if (agree(ranks, interrupted())) throw Suspended(kGoesOn);
    }
    if (failed > 0)
        throw BatchFailed(first,
                          fmt::format("{} of {} failed", failed, count_text(part.size(), "job")));
    if (output_error != 0) throw UnprintedLine(output_error, std::generic_category());
}

}  // namespace

void add_batch_command(CLI::App& app, const Ranks& ranks) {
    auto options = std::make_shared<BatchOptions>();
    CLI::App* command = app.add_subcommand(
        "batch", "Runs a list of optimisations: skips what is done, goes on with what was stopped");
    add_text(*command, "jobs", options->file, "JOBS.json", "A list of jobs as JSON")->required();
    command->add_option("--slice", options->slice, "One of N parts of the list, I from 0 to N - 1")
        ->type_name("I/N")
        ->capture_default_str();
    command->callback([options, &ranks] { run_batch(*options, ranks); });
}

}  // namespace burnish
