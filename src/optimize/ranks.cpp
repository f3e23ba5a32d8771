#include "optimize/ranks.h"

#include <fmt/format.h>

#include <new>

#include "burnish/error.h"

namespace burnish {

namespace {

constexpr char kGoesOn = 0, kHasStopped = 1;

/// Ranks whose exchange throws Signal where another has called tell_stopped in its place.
template <class Signal>
Ranks with_signal(Ranks ranks) {
    if (ranks.count == 1) return ranks;
    ranks.exchange = [count = static_cast<std::size_t>(ranks.count),
                      exchange = std::move(ranks.exchange)](std::vector<std::string> messages) {
        const bool has_stopped = messages.empty();  // see tell_stopped
        messages.resize(count);
        for (std::string& m : messages) m += has_stopped ? kHasStopped : kGoesOn;
        std::vector<std::string> came = exchange(std::move(messages));
        if (has_stopped) return came;
        if (came.size() != count)
            throw Error(
                fmt::format("an exchange gave {} messages, expected {}", came.size(), count));
        for (std::string& m : came) {
            if (m.empty())
                throw Error("an exchange gave an empty message, expected those that were sent");
            if (m.back() == kHasStopped) throw Signal();
            m.pop_back();
        }
        return came;
    };
    return ranks;
}

}  // namespace

void check_rank(int rank, int count) {
    if (count < 1 || rank < 0 || rank >= count)
        throw InputError(fmt::format(
            "the ranks are process {} of {}, expected one from 0 to their number less one", rank,
            count));
}

void check(const Ranks& ranks) {
    check_rank(ranks.rank, ranks.count);
    if (ranks.count > 1 && !ranks.exchange)
        throw InputError("the ranks have no exchange: expected a function");
}

Ranks stoppable(Ranks ranks) { return with_signal<StoppedElsewhere>(std::move(ranks)); }

Ranks failable(Ranks ranks) { return with_signal<FailedElsewhere>(std::move(ranks)); }

void tell_stopped(const Ranks& ranks) {
    if (ranks.count > 1) ranks.exchange({});
}

std::vector<std::string> to_each(const Ranks& ranks, const std::string& message) {
    return std::vector<std::string>(static_cast<std::size_t>(ranks.count), message);
}

std::vector<std::string> all_gather(const Ranks& ranks, const std::string& message) {
    if (ranks.count == 1) return {message};
    return ranks.exchange(to_each(ranks, message));
}

std::string from_first(const Ranks& ranks, const std::string& message) {
    if (ranks.count == 1) return message;
    return ranks.exchange(is_first(ranks) ? to_each(ranks, message) : to_each(ranks)).front();
}

namespace {

enum class Caught : char { kNothing, kOutputError, kBadAlloc, kOther };

/// A message of what was caught: which of those it is, and its text.
std::string message_of_caught(const std::exception_ptr& caught) {
    const auto message = [](Caught which, const std::string& text = {}) {
        return message_of(&which) + text;
    };
    if (!caught) return message(Caught::kNothing);
    try {
        std::rethrow_exception(caught);
    } catch (const OutputError& error) {
        return message(Caught::kOutputError, error.what());
    } catch (const std::bad_alloc&) {
        return message(Caught::kBadAlloc);
    } catch (const std::exception& error) {
        return message(Caught::kOther, error.what());
    } catch (...) {
        return message(Caught::kOther, "no exception of the standard library");
    }
}

}  // namespace

void throw_from_first(const Ranks& ranks, const std::exception_ptr& caught) {
    const std::string came = from_first(ranks, message_of_caught(caught));
    if (caught) std::rethrow_exception(caught);
    const auto which = value_in<Caught>(came.substr(0, 1));
    const std::string text = came.substr(1);
    if (which == Caught::kNothing) return;
    if (which == Caught::kOutputError) throw OutputError(text);
    if (which == Caught::kBadAlloc) throw std::bad_alloc();
    throw Error("process 0 has failed: " + text);
}

void do_on_first(const Ranks& ranks, const std::function<void()>& work) {
    std::exception_ptr caught;
    try {
        if (is_first(ranks)) work();
    } catch (...) {
        caught = std::current_exception();
    }
    throw_from_first(ranks, caught);
}

void require_bytes(const std::string& message, std::size_t bytes) {
    if (message.size() != bytes)
        throw Error(fmt::format("an exchange gave a message of {} bytes, expected {}",
                                message.size(), bytes));
}

std::size_t sum_over(const Ranks& ranks, std::size_t count) {
    std::size_t sum = 0;
    for (const std::size_t own : all_values(ranks, count)) sum += own;
    return sum;
}

int owner_of(const Ranks& ranks, std::size_t i, std::size_t count) {
    return static_cast<int>(i * static_cast<std::size_t>(ranks.count) / count);
}

IndexRange run_of(const Ranks& ranks, int rank, std::size_t count) {
    const auto all = static_cast<std::size_t>(ranks.count);
    const auto begin = [&](std::size_t r) { return (r * count + all - 1) / all; };
    return {begin(static_cast<std::size_t>(rank)), begin(static_cast<std::size_t>(rank) + 1)};
}

std::vector<int> shared_out(const Ranks& ranks, std::size_t count) {
    std::vector<int> owners(count);
    for (std::size_t i = 0; i < count; ++i) owners[i] = owner_of(ranks, i, count);
    return owners;
}

}  // namespace burnish
