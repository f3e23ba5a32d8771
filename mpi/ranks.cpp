#include "burnish/mpi.h"

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <thread>

namespace burnish {

namespace {

/// Waits without keeping a core busy for long: it may be needed by a process on the same machine.
void wait_for(std::vector<MPI_Request>& requests) {
    constexpr int kBusyTries = 2000;
    constexpr std::chrono::microseconds kRest{50};
    int done = 0;
    for (int tries = 0;; ++tries) {
        MPI_Testall(static_cast<int>(requests.size()), requests.data(), &done, MPI_STATUSES_IGNORE);
        if (done) return;
        if (tries < kBusyTries)
            std::this_thread::yield();
        else
            std::this_thread::sleep_for(kRest);
    }
}

/// Counts are int: long messages go in parts.
constexpr std::size_t kMaxPart = std::size_t{1} << 30;

/// Calls body(offset, size) for the parts of a message.
template <class Body>
void for_parts(std::size_t size, const Body& body) {
    for (std::size_t at = 0; at < size; at += kMaxPart)
        body(at, static_cast<int>(std::min(kMaxPart, size - at)));
}

/// The sizes of the messages that come.
std::vector<std::uint64_t> exchange_sizes(MPI_Comm communicator,
                                          const std::vector<std::string>& messages) {
    std::vector<std::uint64_t> sizes, come(messages.size());
    for (const std::string& message : messages) sizes.push_back(message.size());
    std::vector<MPI_Request> request(1);
    MPI_Ialltoall(sizes.data(), 1, MPI_UINT64_T, come.data(), 1, MPI_UINT64_T, communicator,
                  request.data());
    wait_for(request);
    return come;
}

std::vector<std::string> exchange(MPI_Comm communicator, int rank,
                                  std::vector<std::string> messages) {
    constexpr int kTag = 0;
    const std::vector<std::uint64_t> sizes = exchange_sizes(communicator, messages);
    std::vector<std::string> came(messages.size());
    std::vector<MPI_Request> requests;
    for (std::size_t r = 0; r < messages.size(); ++r) {
        if (static_cast<int>(r) == rank) continue;
        const int other = static_cast<int>(r);
        came[r].resize(sizes[r]);
        for_parts(came[r].size(), [&](std::size_t at, int size) {
            MPI_Irecv(came[r].data() + at, size, MPI_BYTE, other, kTag, communicator,
                      &requests.emplace_back());
        });
        for_parts(messages[r].size(), [&](std::size_t at, int size) {
            MPI_Isend(messages[r].data() + at, size, MPI_BYTE, other, kTag, communicator,
                      &requests.emplace_back());
        });
    }
    came[static_cast<std::size_t>(rank)] = std::move(messages[static_cast<std::size_t>(rank)]);
    wait_for(requests);
    return came;
}

}  // namespace

Ranks ranks_of(MPI_Comm communicator) {
    Ranks ranks;
    MPI_Comm_rank(communicator, &ranks.rank);
    MPI_Comm_size(communicator, &ranks.count);
    ranks.exchange = [communicator, rank = ranks.rank](std::vector<std::string> messages) {
        return exchange(communicator, rank, std::move(messages));
    };
    return ranks;
}

}  // namespace burnish
