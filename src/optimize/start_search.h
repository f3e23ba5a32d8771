// Where a run should start. Descent finds the nearest valley; this finds the deepest one: samples
// are shaded at a grid of constant values, each region of a texture takes the values at which the
// pixels that see it lose least, and neighbours of one chart agree where their own pixels leave it
// open. A colour follows from the ratio of picture and render.
#pragma once

#include "burnish/solve.h"
#include "optimize/search_plan.h"
#include "optimize/search_sums.h"
#include "optimize/setup.h"

namespace burnish {

struct FoundStarts {
    std::vector<Image> textures;  ///< parallel to the unknowns, [height, width, channels]
    /// Which of them were searched together, and what was tried.
    std::vector<SearchedGroup> groups;
    /// Parallel to groups; empty of those that a run may not search again.
    std::vector<GroupSums> sums;
};

/// views: at least one, of one scene. effort: a factor of the samples. progress: hears of the share
/// that is done. others: unknowns that are not searched, as they are. The same for any number of
/// threads.
FoundStarts search_starts(std::span<const SearchView> views,
                          std::span<const SearchUnknown> unknowns, std::uint32_t seed,
                          double effort = 1, const Progress& progress = {},
                          const Theta& others = {});

/// What a run's search took and tried.
struct SearchReport {
    double seconds = 0;
    std::vector<SearchedGroup> groups;  ///< of indices into Setup::unknowns
    std::vector<GroupSums> sums;        ///< parallel to groups
    double effort = 1;
};

/// What is searched in a run. Views into its setup, which must outlive it.
struct SearchInput {
    std::vector<std::size_t> indices;     ///< into Setup::unknowns
    std::vector<SearchUnknown> unknowns;  ///< parallel to indices
    std::vector<std::size_t> fitted;      ///< indices into Setup::fitted
    std::vector<SearchView> views;        ///< parallel to fitted, kMaxSearchViews at most
};
SearchInput search_input(const Setup& setup);

/// The unknowns that are not searched, as they start or, where theta is given, as a run has them.
Theta unsearched(const Setup& setup, const Theta* theta = nullptr);

/// Sets the starts of the unknowns that are to be searched. A run that may take more than a minute
/// searches in proportion, up to four times as long.
SearchReport find_starts(Setup& setup, const Progress& progress = {});

}  // namespace burnish
