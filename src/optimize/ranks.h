// What processes that solve a problem together say to each other.
//
// Nothing that decides on a byte of the result depends on their number: who owns a view or bands of
// it decides only where its image is made, and sums are folded by the places of views and bands,
// never by rank.
#pragma once

#include <cstring>
#include <exception>
#include <functional>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <vector>

#include "burnish/ranks.h"
#include "core/archive.h"
#include "core/index_range.h"
#include "core/parallel.h"

namespace burnish {

/// Throws InputError: a process that is not one of their number.
void check_rank(int rank, int count);
/// The same, or no exchange between several.
void check(const Ranks& ranks);

inline bool is_first(const Ranks& ranks) { return ranks.rank == 0; }

/// What an exchange throws on all ranks but those that have called tell_stopped in its place.
struct StoppedElsewhere : Stopped {};
/// Ranks whose exchange says, too, whether its sender goes on.
Ranks stoppable(Ranks ranks);
/// The same of ranks that fail, each on its own, at what they do together: the others throw this.
struct FailedElsewhere : std::runtime_error {
    FailedElsewhere() : std::runtime_error("another process has failed") {}
};
Ranks failable(Ranks ranks);
/// In the place of the next exchange of stoppable or failable ranks: this one has stopped. All stop
/// at the same exchange, so none waits for another.
void tell_stopped(const Ranks& ranks);

/// A message for each rank, the same for all.
std::vector<std::string> to_each(const Ranks& ranks, const std::string& message = {});

/// What each rank says, on all of them.
std::vector<std::string> all_gather(const Ranks& ranks, const std::string& message);

/// What the first rank says.
std::string from_first(const Ranks& ranks, const std::string& message);

/// Throws on all ranks what the first one has caught, null for nothing: itself there, the same on
/// the others where it is OutputError or std::bad_alloc, otherwise Error.
void throw_from_first(const Ranks& ranks, const std::exception_ptr& caught);

/// Work of the first rank alone; what it throws, all throw.
void do_on_first(const Ranks& ranks, const std::function<void()>& work);

/// The bytes of a value, or of several in a row.
template <class T>
std::string message_of(const T* values, std::size_t count = 1) {
    static_assert(std::is_trivially_copyable_v<T>);
    return {reinterpret_cast<const char*>(values), count * sizeof(T)};
}
/// Throws Error where a message has more or fewer bytes.
void require_bytes(const std::string& message, std::size_t bytes);
/// The value whose bytes a message is. Throws Error where they are more or fewer.
template <class T>
T value_in(const std::string& message) {
    static_assert(std::is_trivially_copyable_v<T>);
    require_bytes(message, sizeof(T));
    T value;
    std::memcpy(&value, message.data(), sizeof value);
    return value;
}

/// The first rank's value: of what ranks may see differently, as the time.
template <class T>
T agree(const Ranks& ranks, const T& value) {
    if (ranks.count == 1) return value;
    return value_in<T>(from_first(ranks, message_of(&value)));
}

/// Each rank's value, on all of them.
template <class T>
std::vector<T> all_values(const Ranks& ranks, const T& value) {
    if (ranks.count == 1) return {value};
    std::vector<T> values;
    for (const std::string& message : all_gather(ranks, message_of(&value)))
        values.push_back(value_in<T>(message));
    return values;
}

/// The sum of what all ranks have counted, on all of them.
std::size_t sum_over(const Ranks& ranks, std::size_t count);

/// Reads values of a message of another rank. It throws Error where they are not in it.
inline ArchiveReader reader_of(const std::string& message) {
    return {"a message of another process", message.size(), source_of(message),
            BytesFrom::kExchange};
}

/// Who gets what others have made.
enum class Recipient { kAll, kFirst };

/// Items of which each was made by its owner: the other ones become those of their owners.
template <class T>
void share(const Ranks& ranks, const std::vector<int>& owners, Recipient recipient,
           std::vector<T>& items) {
    if (ranks.count == 1) return;
    std::string mine;
    ArchiveWriter writer(sink_into(mine));
    for (std::size_t i = 0; i < items.size(); ++i)
        if (owners[i] == ranks.rank) writer(items[i]);
    std::vector<std::string> messages =
        recipient == Recipient::kAll ? to_each(ranks, mine) : to_each(ranks);
    messages.front() = std::move(mine);
    const std::vector<std::string> came = ranks.exchange(std::move(messages));
    if (recipient == Recipient::kFirst && !is_first(ranks)) return;
    for (int r = 0; r < ranks.count; ++r) {
        if (r == ranks.rank) continue;
        ArchiveReader reader = reader_of(came[static_cast<std::size_t>(r)]);
        for (std::size_t i = 0; i < items.size(); ++i)
            if (owners[i] == r) reader(items[i]);
        reader.require_end();
    }
}

/// The owner of item i of `count`: ranks own them in order, each as many as the others or one more.
int owner_of(const Ranks& ranks, std::size_t i, std::size_t count);
/// Those that a rank owns.
IndexRange run_of(const Ranks& ranks, int rank, std::size_t count);
std::vector<int> shared_out(const Ranks& ranks, std::size_t count);

}  // namespace burnish
