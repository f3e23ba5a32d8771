// What decides on the bytes of a run, as hashes: to tell what has changed since it began.
#pragma once

#include <vector>

#include "burnish/checkpoint.h"
#include "burnish/error.h"
#include "core/archive.h"
#include "optimize/setup.h"
#include "optimize/state.h"

namespace burnish {

void fields(auto& archive, Is<Input> auto& v) { archive(v.name, v.bytes, v.hash); }

/// Whether an option decides on no byte of a run but where it ends: one of Stop, or the samples of
/// the evaluation.
bool may_change(const std::string& option);

/// Options that have an effect, the scene, whether the loss is one's own, pictures, masks, cameras,
/// lights, unknowns with their starts. Not what may change.
std::vector<Input> inputs_of(const Setup& setup);

/// A run cannot go on from a checkpoint: it is of another one.
struct ChangedRun : InputError {
    using InputError::InputError;
};

/// Throws ChangedRun that names what differs.
void require_same_inputs(const std::vector<Input>& expected, const std::vector<Input>& found);

/// Throws InputError, on all processes, where one has another problem than the first, or goes on
/// from another state; says which. from: null where the run begins.
void require_one_problem(const Setup& setup, const State::Values* from = nullptr);

}  // namespace burnish
