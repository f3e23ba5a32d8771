// The sum of the gradients of the views that an iteration visits, in one order for any number of
// processes.
//
// The bands of the views of a batch, in the order of their numbers, are the leaves of a binary
// tree: a node of size s (a power of two) begins at a multiple of s and is the sum of its two
// halves. A view is one node, whoever summed up its bands. A process sums up the nodes that its own
// views and bands fill, sends each process the blocks that this one asks for,
// and completes the tree on those that it asks for itself. Only dirty blocks are sent.
#pragma once

#include <vector>

#include "burnish/ranks.h"
#include "core/kept_blocks.h"
#include "gradient/split_gradient.h"

namespace burnish {

/// Of the gradient by an unknown.
struct GradientParts {
    bool split = false;             ///< in halves
    std::vector<KeptBlocks> parts;  ///< what each process gets of the sum
};

/// The sum over the leaves [begin, begin + size), or those of them that there are.
struct ViewSumNode {
    std::size_t begin = 0, size = 1;
    std::vector<SplitGradient> gradient;  ///< parallel to the unknowns
};

/// Work memory.
struct ViewSum {
    std::vector<ViewSumNode> nodes;  ///< of what was added, in order
    /// Of nodes that became part of others.
    std::vector<std::vector<SplitGradient>> spare;
    std::vector<ViewSumNode> parts;  ///< this process's part of the nodes of all
    std::vector<SplitGradient> sum;  ///< of all processes
};

/// Adds the gradient of a node, which is left as it is. Nodes come in ascending order.
void add_node(std::size_t begin, std::size_t size, const std::vector<SplitGradient>& gradient,
              ViewSum& views);

/// This process's part of the sum over the batch, once all processes have added their nodes; until
/// the next call: one float behind the other, whatever the texture's size; of one process as it was
/// added. Each leaf of the batch was added by one process. parts: of the unknowns.
const std::vector<SplitGradient>& sum_of_views(const Ranks& ranks,
                                               const std::vector<GradientParts>& parts,
                                               ViewSum& views);

}  // namespace burnish
