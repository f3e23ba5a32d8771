// What a process says to the others of a run.
#pragma once

#include "burnish/ranks.h"
#include "core/stopwatch.h"

namespace burnish {

struct Traffic {
    std::size_t exchanges = 0;
    double bytes = 0;    ///< sent to others
    double seconds = 0;  ///< in exchanges, waiting for slower processes included
};

/// The same processes; `traffic`, which must outlive them, grows with each exchange.
inline Ranks metered(const Ranks& ranks, Traffic& traffic) {
    if (ranks.count == 1) return ranks;
    Ranks result = ranks;
    result.exchange = [ranks, &traffic](std::vector<std::string> messages) {
        for (std::size_t r = 0; r < messages.size(); ++r)
            if (static_cast<int>(r) != ranks.rank)
                traffic.bytes += static_cast<double>(messages[r].size());
        const Stopwatch watch;
        std::vector<std::string> came = ranks.exchange(std::move(messages));
        traffic.seconds += watch.total();
        ++traffic.exchanges;
        return came;
    };
    return result;
}

}  // namespace burnish
