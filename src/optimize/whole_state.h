// The state of a run of several processes, each of which has the views, or bands of them, that it
// owns and the part of the optimiser that it steps: written by the first one to the bytes that one
// process alone would write, and read by each for its own views.
#pragma once

#include <functional>

#include "optimize/ranks.h"
#include "optimize/setup.h"
#include "optimize/state_fields.h"

namespace burnish {

/// Makes the states of other processes' views those before their first visit, and of those that are
/// shared keeps what is its own.
void drop_views_of_others(const Setup& setup, State::Values& state);

/// The first process's state, and where the others' views and parts of pyramids come from.
struct WholeState {
    const State::Values& own;
    const Ranks& ranks;
    /// Bytes of the others that the first process has at once: a view may be as large as the
    /// memory that is left.
    std::size_t slice = std::size_t{1} << 24;
};

/// While the first process writes, the others give what it asks for: all call it at the same time,
/// and it returns once the first one has. write: called by the first one alone. What it throws is
/// thrown on all: see throw_from_first. FailedElsewhere comes to each from its own exchange.
void write_whole(const WholeState& state, const std::function<void()>& write);

/// Within write_whole.
void fields(ArchiveWriter& archive, const WholeState& v);

/// The part of a state that a process reads: of its own views and bands, and all pyramids. At most
/// one pass of another process's records is in memory at once.
struct OwnState {
    State::Values& values;
    const Ranks& ranks;
};
void fields(ArchiveReader& archive, OwnState& v);

}  // namespace burnish
