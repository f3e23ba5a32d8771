#include "cli/batch_jobs.h"

#include <fmt/format.h>

#include <CLI/App.hpp>
#include <algorithm>
#include <filesystem>
#include <map>
#include <string_view>
#include <utility>

#include "burnish/error.h"
#include "captures/json_value.h"
#include "cli/commands.h"
#include "cli/folder_content.h"
#include "cli/options_file.h"
#include "cli/usage_text.h"
#include "core/parsed.h"
#include "image/files.h"

namespace burnish {

namespace {

bool is_output(const Given& g) { return g.names.front() == "run.output"; }

/// As of an options file.
std::vector<Given> options_in(const Value& v) {
    if (!v.value.is_object()) fail(v, "an object with names of options");
    std::vector<Given> given = read_options_text(v.value.dump(), place_of(v));
    if (std::ranges::any_of(given, is_output))
        throw InputError(place_of(v) +
                         ": found run.output, expected the folder as the key \"output\" of a job");
    return given;
}

std::vector<std::string> arguments_in(const Value& v) {
    if (!v.value.is_array()) fail(v, "an array of texts, as on the command line of optimize");
    std::vector<std::string> all;
    for (std::size_t i = 0; i < v.value.size(); ++i) all.push_back(text(element(v, i)));
    return all;
}

/// Puts what the options file holds in its place: it may be a pipe, which can be read once.
void read_options(const Value& v, OptimizeArguments& arguments) {
    const std::string file = std::exchange(arguments.options_file, {});
    std::vector<Given> given = read_options_file(file);
    if (std::ranges::any_of(given, is_output))
        fail(v, fmt::format("{} without run.output: the key \"output\" names the folder", file));
    for (Given& g : given) arguments.options.push_back(std::move(g));
}

/// As the command line of optimize reads them.
void parse_arguments(const Value& v, OptimizeArguments& arguments) {
    std::vector<std::string> words = arguments_in(v);
    std::reverse(words.begin(), words.end());
    CLI::App app("", "burnish optimize");
    app.set_help_flag();
    add_optimize_options(app, arguments);
    try {
        app.parse(words);
    } catch (const CLI::Success&) {
        fail(v, "arguments of a run: no --help-all");
    } catch (const CLI::ParseError& error) {
        throw InputError(place_of(v) + ": " + usage_text(app, error));
    } catch (const UsageError& error) {
        throw InputError(place_of(v) + ": " + error.what());
    }
    if (!arguments.resume.empty())
        fail(v, "no --resume: a job whose run was stopped goes on by itself");
    if (!arguments.options_file.empty()) read_options(v, arguments);
    const bool has_flag = std::ranges::any_of(arguments.flags, is_output);
    const bool is_set =
        std::any_of(arguments.sets.begin(), arguments.sets.end(),
                    [](const std::string& set) { return set.starts_with("run.output="); });
    if (has_flag || is_set)
        fail(v, fmt::format("no {}: the key \"output\" names the folder",
                            has_flag ? "-o" : "--set run.output"));
}

std::string output_of(const Value& job) {
    require_member(job, "output");
    const Value output = member(job, "output");
    if (text(output).empty()) fail(output, "a folder for the results");
    return text(output);
}

/// shared: options of all jobs, which those of the job follow.
BatchJob job_of(const Value& v, std::size_t number, const std::vector<Given>& shared) {
    if (!v.value.is_object()) fail(v, "an object with \"output\" and \"options\" or \"arguments\"");
    check_object(v, {"output", "options", "arguments"});
    BatchJob job;
    job.number = number;
    job.arguments.options = shared;
    if (has(v, "options"))
        for (Given& g : options_in(member(v, "options")))
            job.arguments.options.push_back(std::move(g));
    if (has(v, "arguments")) parse_arguments(member(v, "arguments"), job.arguments);
    job.arguments.flags.push_back({place_of(v) + ".output", {"run.output"}, {output_of(v)}});
    try {
        job.settings = make_settings(job.arguments);
    } catch (const UsageError& error) {
        throw InputError(place_of(v) + ": " + error.what());
    } catch (const InputError& error) {
        const std::string text = error.what();  // an option of all jobs does not name this one
        throw InputError(text.starts_with(place_of(v)) ? text : place_of(v) + ": " + text);
    }
    if (job.settings.run.scene.empty())
        throw InputError(place_of(v) +
                         ": found no scene, expected one among the arguments or as "
                         "the option scene.file");
    return job;
}

std::filesystem::path real_folder(const std::string& output) {
    return without_slash(real_path(output));
}

/// Numbers of jobs, from 1, by their folders.
using JobFolders = std::map<std::filesystem::path, std::size_t>;

/// The job whose folder a folder lies in; 0: none.
std::size_t job_around(std::filesystem::path folder, const JobFolders& jobs) {
    while (folder.has_relative_path()) {
        folder = folder.parent_path();
        if (const auto job = jobs.find(folder); job != jobs.end()) return job->second;
    }
    return 0;
}

void require_own_folders(const std::string& file, const std::vector<BatchJob>& jobs) {
    JobFolders numbers;
    const auto refuse = [&](const BatchJob& job, const char* where, std::size_t other) {
        throw InputError(fmt::format(
            "{}: jobs[{}].output: found {}, {}the folder of jobs[{}], expected one of its own",
            file, job.number - 1, job.settings.run.output, where, other - 1));
    };
    for (const BatchJob& job : jobs) {
        const auto [other, is_new] =
            numbers.emplace(real_folder(job.settings.run.output), job.number);
        if (!is_new) refuse(job, "", other->second);
    }
    for (const BatchJob& job : jobs)
        if (const auto other = job_around(real_folder(job.settings.run.output), numbers))
            refuse(job, "within ", other);
}

}  // namespace

std::vector<BatchJob> read_jobs(const std::string& file) {
    const nlohmann::json document = parse_json(file, "a list of jobs");
    const Value root{document, file, ""};
    if (!document.is_object()) fail(root, "an object with the key \"jobs\"");
    check_object(root, {"options", "jobs"});
    require_member(root, "jobs");
    const Value list = member(root, "jobs");
    if (!list.value.is_array() || list.value.empty()) fail(list, "an array of at least one job");
    std::vector<Given> shared;
    if (has(root, "options")) shared = options_in(member(root, "options"));
    std::vector<BatchJob> jobs;
    for (std::size_t i = 0; i < list.value.size(); ++i)
        jobs.push_back(job_of(element(list, i), i + 1, shared));
    require_own_folders(file, jobs);
    return jobs;
}

Slice parse_slice(const std::string& text) {
    const std::string_view all = text;
    const std::size_t slash = std::min(all.find('/'), all.size());
    const auto index = parsed<std::size_t>(all.substr(0, slash)),
               count = parsed<std::size_t>(all.substr(std::min(slash + 1, all.size())));
    if (!index || !count || *index >= *count)
        throw UsageError(
            fmt::format("--slice: expected I/N with I from 0 to N - 1, as 0/4, found '{}'", text));
    return {*index, *count};
}

std::vector<BatchJob> slice_of(std::vector<BatchJob> jobs, const Slice& slice) {
    std::vector<BatchJob> part;
    for (BatchJob& job : jobs)
        if ((job.number - 1) % slice.count == slice.index) part.push_back(std::move(job));
    return part;
}

}  // namespace burnish
