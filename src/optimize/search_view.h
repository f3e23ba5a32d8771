// A picture as the search for the start sees it: in squares of pixels, with the BSDFs that carry
// unknowns sorted into groups.
//
// A square is `scale` pixels wide. A pass moves all of its samples by one distance, drawn from the
// density of the film's filter about one of the square's pixels: the mean over passes then has the
// expectation of the mean of these pixels, and no square needs samples of its neighbours. (The
// fraction of the distance is uniform: what a filter that is no partition of unity asks for
// differs from that by a percent.)
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "burnish/solve.h"
#include "gradient/theta.h"
#include "paths/trace.h"
#include "render/shade.h"
#include "texture/guide.h"
#include "texture/regions.h"

namespace burnish {

/// As burnish::View.
struct SearchView {
    const TracedScene& scene;
    const Image& target;
    const Image& mask;
    Exposure exposure = ExposureFactors{1, 1, 1};
    /// The largest weight of all views, by which weights are divided: a search does not depend on
    /// their scale. Pixels that weigh a hundredth of it or less decide little.
    float max_mask = 1;
};

/// The view where its exposure is known.
inline SearchView at_exposure(const ExposureFactors& exposure, SearchView view) {
    view.exposure = exposure;
    return view;
}

/// Unknowns that are searched together: those of one material, or of several that share one.
struct SearchGroup {
    /// Indices of unknowns. The first is the finest: the one that was asked for first where several
    /// are, a colour also where another has not much more texels. Those of one texel come last.
    std::vector<std::size_t> members;
    std::vector<char> uniform;  ///< parallel to members: non-zero where a texel is all
    TextureRegions regions;     ///< of the first member's texture
    /// The member whose colour is searched, the first that was asked for; others stay at 0.5:
    /// one picture tells the colour of one. None where no member is read as a colour.
    std::optional<std::size_t> color;
    bool gray = false;  ///< that member has one number for its channels
    /// Values of the members, the same in all regions. Those of colours are not read.
    std::vector<std::vector<float>> candidates;
    std::vector<float> prior_costs;  ///< of the candidates, in every region
    std::vector<TextureId> guides;   ///< known textures that the same materials read
    Rows guide_means;                ///< over each region; empty: none
};

/// What is searched, and with how many samples.
struct SearchPlan {
    std::vector<TextureId> unknowns;
    std::vector<char> colors;  ///< parallel to unknowns: non-zero where read as a colour
    /// The unknowns that are not searched, as they are; must outlive it. Null: there are none.
    const Theta* others = nullptr;
    std::vector<SearchGroup> groups;
    int scale = 1;
    std::uint32_t passes = 1;  ///< of each half
    std::uint32_t seed = 0;
};

/// The unknown that each texture of the scene is, -1: none.
std::vector<int> unknown_slots(const Scene& scene, const SearchPlan& plan);

/// Pixels from the sample's own square: x, y.
using SearchShift = std::array<int, 2>;

/// The random numbers of the passes of a half.
struct SearchPasses {
    RandomKey key;
    std::vector<SearchShift> shifts;
};

/// Views into plan and view, which must outlive it.
struct SearchFrame {
    const SearchPlan& plan;
    const SearchView& view;
    int width = 0, height = 0;    ///< squares
    std::vector<char> seen = {};  ///< [height, width]: non-zero where samples may meet an unknown
    /// [height, width, 3]: means of the target without its exposure, and weights of squared
    /// residuals; a square with a masked pixel has the weight of that one.
    std::vector<float> target = {}, weight = {};
    std::array<SearchPasses, 2> halves = {};
    // Of the scene.
    std::vector<int> slots = {};   ///< see unknown_slots
    std::vector<int> groups = {};  ///< of each BSDF, -1: none
    /// Of each BSDF with a group, zero: its picture is that of a colour that stays at 0.5, and
    /// tells nothing of what it shares with others.
    std::vector<char> tells = {};
    std::vector<char> unknown_bsdfs = {};  ///< as of TraceInput; non-zero: has a group
    /// Of the shaders; the unknowns' texels are never read.
    std::unique_ptr<TextureTable> textures = {};
    std::vector<RecordShader> shaders = {};      ///< values alone
    std::vector<ConstantTextures> mixture = {};  ///< what BSDF samples follow
};

/// The pixels whose samples may meet one of the BSDFs, within the reach of the film's filter:
/// non-zero, row by row.
std::vector<char> seen_pixels(const TracedScene& view, std::span<const char> bsdfs);

/// number: tells the random numbers of views apart. A view whose exposure is to be fitted has 1.
SearchFrame make_search_frame(const SearchPlan& plan, const SearchView& view, std::uint32_t number);
/// Of views 0, 1, ...
std::vector<SearchFrame> make_search_frames(const SearchPlan& plan,
                                            std::span<const SearchView> views);

/// Draws the passes of both halves anew, in place of those of the plan. frames: of views 0, 1, ...
void draw_passes(std::span<SearchFrame> frames, std::uint32_t seed, std::uint32_t passes);

/// How far samples are moved along one axis, in whole pixels. offset: of the pass, within the
/// pixel. u: uniform in [0, 1).
int draw_shift(const ReconstructionFilter& filter, int scale, float offset, float u);

}  // namespace burnish
