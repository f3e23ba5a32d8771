// The pool: the path records of many iterations, shaded again in each under its textures.
//
//   trace   camera samples -> a batch of packed records, of one pass, in one of two banks
//   shade   records of a bank + theta -> its image                     I_A, I_B
//   loss    both images -> their adjoints                              dL/dI_A, dL/dI_B
//   derive  records of a bank + theta + the adjoint of the *other* bank -> gradient
//
// The gradient is the mean of adjoint(A) x derivative(B) and adjoint(B) x derivative(A). The banks
// draw from independent streams, so each product is one of independent factors: unbiased along any
// script of textures, for a loss whose adjoint is affine in I. One record serves an image and a
// gradient, in every iteration of its life; no ray is traced twice.
//
// A bank is a window on its last passes. In a descent the textures depend on the records that moved
// them: unbiased is the gradient along a script of textures, not that of a closed loop.
#pragma once

#include <deque>

#include "gradient/outliers.h"
#include "gradient/split_gradient.h"
#include "gradient/texel_sums.h"
#include "gradient/theta.h"
#include "render/pass_convolution.h"
#include "render/records.h"

namespace burnish {

/// The records of one pass.
struct RecordBatch {
    std::uint32_t film_pass = 0;     ///< within its bank: names the film offset
    std::vector<TileRecords> tiles;  ///< parallel to Pool::tiles
};

struct Bank {
    std::deque<RecordBatch> batches;  ///< oldest first
    std::uint32_t born = 0;           ///< passes traced so far
};

/// The pixels of a tile of the film that can see an optimised texture, in the order of tracing, and
/// the box about them.
struct PoolTile {
    Tile tile;
    std::vector<std::uint32_t> pixels;
};

/// The surroundings of what is optimised, one entry per pixel of the film.
struct NearUnknown {
    std::vector<char> pixels;   ///< those whose filter reaches a sample on an optimised texture
    std::vector<char> samples;  ///< those whose samples reach one of these pixels
};

struct Pool {
    std::vector<PoolTile> tiles;  ///< those that see anything
    NearUnknown near_unknown;
    FilmNormalization normalization;
    std::vector<TexelSums> sums;  ///< work memory, zero between calls; parallel to theta.textures
    std::vector<SplitGradient> gradient;       ///< the last one, one half from each bank
    std::vector<Outlier> outliers;  ///< of it: the largest g of single records
    std::array<Bank, 2> banks;
    std::uint32_t most = 1;  ///< passes that a bank may ever keep
};

/// What the stages below read, besides the pool. Everything must outlive the calls.
struct PoolInput {
    const TracedScene* scene = nullptr;
    const Theta* theta = nullptr;
    std::uint32_t seed = 0;
    Sequence sequence = Sequence::kIndependent;  ///< of the passes of a bank, all of them
};

/// An empty pool: which pixels see the textures of theta.
Pool make_pool(const Scene& scene, const Theta& theta);

/// Traces one pass into a bank, its BSDFs sampled under theta. Returns the number of draws that
/// were not finite.
std::size_t trace_pass(const PoolInput& input, Pool& pool, std::size_t bank);

/// Traces so many passes into the banks in turn; at least one into each, as long as they are empty.
/// Returns the number of draws that were not finite.
std::size_t trace_fresh(const PoolInput& input, std::uint32_t passes, Pool& pool);

/// Drops the oldest passes of both banks until each has at most `window`.
void keep_window(Pool& pool, std::size_t window);

/// The part of the image that depends on theta, from each bank.
struct PoolImages {
    std::array<Image, 2> images;  ///< [crop_height, crop_width, 3]
    std::size_t rejected = 0;     ///< records left out: the value or a derivative was not finite
};

/// The derivatives of the records' values are found on the way and kept in the pool.
PoolImages pool_images(const PoolInput& input, Pool& pool);

/// dL / d(texture), parallel to theta.textures, at the theta of the last pool_images; a half from
/// the derivatives of each bank. adjoints: dL/dI of the image of each bank. The result lies in the
/// pool, until the next call, with what stands out in it.
const std::vector<SplitGradient>& pool_gradient(const PoolInput& input, Pool& pool,
                                                 const std::array<Image, 2>& adjoints);

/// Records in both banks, and the bytes that they take.
struct PoolSize {
    std::size_t records = 0, bytes = 0;
};
PoolSize pool_size(const Pool& pool);

}  // namespace burnish
