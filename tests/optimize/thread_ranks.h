// Processes that solve together, as threads of one: what they say to each other passes through
// memory.
#pragma once

#include <barrier>
#include <functional>
#include <thread>
#include <vector>

#include "burnish/solve.h"

namespace burnish::test {

/// A problem as one of the processes has it.
inline Problem of_rank(Problem problem, const Ranks& ranks) {
    problem.ranks = ranks;
    return problem;
}

/// Calls body(ranks) on so many threads, each with its own rank.
inline void on_ranks(int count, const std::function<void(const Ranks&)>& body) {
    const auto n = static_cast<std::size_t>(count);
    std::vector<std::vector<std::string>> sent(n);
    std::barrier step(count);
    std::vector<std::jthread> threads;
    for (int rank = 0; rank < count; ++rank)
        threads.emplace_back([&, rank] {
            const auto exchange = [&, rank](std::vector<std::string> messages) {
                sent[static_cast<std::size_t>(rank)] = std::move(messages);
                step.arrive_and_wait();
                std::vector<std::string> came;
                for (std::size_t r = 0; r < n; ++r)
                    came.push_back(sent[r].at(static_cast<std::size_t>(rank)));
                step.arrive_and_wait();
                return came;
            };
            body({rank, count, exchange});
        });
}

}  // namespace burnish::test
