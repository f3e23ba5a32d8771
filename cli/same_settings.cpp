#include "cli/same_settings.h"

#include <fmt/format.h>

#include <utility>

#include "burnish/error.h"
#include "core/archive.h"
#include "optimize/ranks.h"

namespace burnish {

namespace {

/// What is compared, by name.
struct NamedTexts {
    std::vector<std::string> names, texts;
};

void add(std::string name, std::string text, NamedTexts& all) {
    all.names.push_back(std::move(name)), all.texts.push_back(std::move(text));
}

/// place: of a job, "jobs[1]: ".
void add_settings(const std::string& place, const Settings& settings, NamedTexts& all) {
    const std::vector<std::string> texts = setting_texts(settings);
    for (std::size_t i = 0; i < texts.size(); ++i)
        add(place + all_settings()[i].info.name, texts[i], all);
}

/// The texts of each process, on all of them.
std::vector<std::vector<std::string>> gather_texts(const Ranks& ranks,
                                                   const std::vector<std::string>& own) {
    std::string bytes;
    ArchiveWriter{sink_into(bytes)}(own);
    std::vector<std::vector<std::string>> all;
    for (const std::string& message : all_gather(ranks, bytes)) {
        ArchiveReader reader = reader_of(message);
        reader(all.emplace_back());
        reader.require_end();
    }
    return all;
}

/// what: in the message, "other settings". Where processes may have different numbers of texts, the
/// first one says how many: it is compared on all processes before the others.
void require_same(const char* what, const NamedTexts& own, const Ranks& ranks) {
    const auto all = gather_texts(ranks, own.texts);
    const std::vector<std::string>& expected = all.front();
    for (std::size_t i = 0; i < own.texts.size(); ++i)
        for (std::size_t r = 1; r < all.size(); ++r)
            if (all[r].at(i) != expected.at(i))
                throw InputError(fmt::format(
                    "process {} has {} than process 0, expected the same: {}: {}, on process 0 {}",
                    r, what, own.names[i], all[r][i], expected[i]));
}

}  // namespace

void require_same_settings(const Settings& settings, const Ranks& ranks) {
    if (ranks.count == 1) return;
    NamedTexts own;
    add_settings("", settings, own);
    require_same("other settings", own, ranks);
}

void require_same_jobs(const std::vector<BatchJob>& jobs, const std::string& slice,
                       const Ranks& ranks) {
    if (ranks.count == 1) return;
    NamedTexts own;
    add("the number of jobs", fmt::format("{}", jobs.size()), own);
    add("--slice", slice, own);
    for (const BatchJob& job : jobs) {
        const std::string place = fmt::format("jobs[{}]", job.number - 1);
        add(place + ".output", job.settings.run.output, own);
        add_settings(place + ": ", job.settings, own);
    }
    require_same("another list", own, ranks);
}

}  // namespace burnish
