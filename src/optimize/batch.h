// Which views an iteration visits.
#pragma once

#include <cstdint>
#include <vector>

#include "optimize/setup.h"

namespace burnish {

inline double pixels_of(const Renderer& view) { return double{1} * view.width() * view.height(); }

/// Views that an iteration visits.
std::size_t batch_size(const Setup& setup);
/// Pixels of them, on average where views differ in size.
double pixels_of_iteration(const Setup& setup);

/// Those that an iteration visits, as indices of Setup::fitted, ascending: the next ones of an
/// order that is shuffled anew in each epoch.
std::vector<std::size_t> batch_of(const Setup& setup, std::uint32_t iteration);

}  // namespace burnish
