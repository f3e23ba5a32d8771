// Recovering textures: problems, the solver, and the loop over it.
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "burnish/options.h"
#include "burnish/ranks.h"
#include "burnish/renderer.h"
#include "burnish/view.h"

namespace burnish {

/// What a rendered image is multiplied with, by channel.
using ExposureFactors = std::array<float, 3>;

/// The factor at which the image of the present textures is nearest to the picture, found whenever
/// the image is there: weighted as the loss weighs, where textures are stepped as their gradient
/// weighs (Loss::kReweighted). Where colours are unknown, one view at least should keep a number:
/// no picture tells a bright colour from a long exposure.
struct FitExposure {
    bool by_channel = false;  ///< a factor for each channel: the white balance, too

    friend bool operator==(const FitExposure&, const FitExposure&) = default;
};
/// Factors above 0, or fitted.
using Exposure = std::variant<ExposureFactors, FitExposure>;

/// A picture to match.
struct View {
    Image image = {};  ///< [height, width, 3] of the camera's size, linear RGB radiance
    Image mask = {};  ///< [height, width, 1 or 3], weights of pixels, at least 0; width 0: all ones
    std::string name = {};   ///< in messages; empty: "view N", counted from 0
    ViewCamera camera = {};  ///< the renderer's; of one that was loaded the scene's first sensor
    Lighting lighting = {};  ///< the renderer's; of one that was loaded all of the scene's
    /// Of the rendered image, before it meets `image`. With a loss of your own: no FitExposure.
    Exposure exposure = ExposureFactors{1, 1, 1};
    bool held_out = false;  ///< never fitted: evaluated at the end only
};

/// The start is found from the pictures, before the first iteration: each region of the texture
/// takes the value, of a grid, at which the pixels that see it lose least. With a loss of your own,
/// which says nothing of pixels, 0.5 everywhere.
struct SearchStart {
    friend bool operator==(const SearchStart&, const SearchStart&) = default;
};
/// Where a texture starts: searched, a value for all texels, or an image of the texture's size; in
/// [0, 1]. An image is kept where no sample comes.
using Start = std::variant<SearchStart, float, Image>;

/// A texture to recover.
struct Unknown {
    /// Of the parameter: Mitsuba's, or any short form that means one texture.
    std::string name = {};
    Start start = SearchStart{};
    /// Above 1e-36, up to 1e6; 0: Options::learning_rate, shared out among the unknowns of a
    /// material.
    double learning_rate = 0;
};

struct Problem {
    Renderer renderer;
    std::vector<View> views = {};        ///< at least one that is fitted
    std::vector<Unknown> unknowns = {};  ///< at least one, each another texture
    LossFunction loss = {};  ///< of your own; empty: Options::loss between the image and the view
    Ranks ranks = {};        ///< that solve it together, each with its part of views and texels
};

/// What an iteration did.
struct Iteration {
    std::uint32_t number = 0;  ///< from 0
    /// Of the iteration's noisy images, before its step, the mean over the views that it visited:
    /// above that of converged ones.
    double loss = 0;
    std::optional<double> held_out_loss = {};  ///< after the step, where it was checked; see Stop
    /// At its end: of the run since its first iteration began, the callback's included; of a Solver
    /// within its steps.
    double seconds = 0;
    double image_seconds = 0, derivative_seconds = 0, step_seconds = 0;
    std::size_t paths = 0;        ///< behind the derivative
    std::size_t derivatives = 0;  ///< by single texels; 0 with PathCache, which never counts them
    std::size_t texels = 0;       ///< with a gradient; 0 with PathCache
    std::size_t reservoirs = 0;   ///< that the next iteration reads
    std::size_t rejected_image = 0, rejected_derivatives = 0;  ///< not finite, left out
};

enum Control {
    Continue,
    Cancel,   ///< no further iteration; the result is evaluated
    Suspend,  ///< nor that: for runs with checkpoints, which go on later
};
class Solver;
/// Called after each iteration, from the thread that solves; of several processes by the first. A
/// function of the iteration, or of the iteration and the solver, which may be looked at; an empty
/// std::function is none. What it throws ends the run and is thrown.
struct Callback : std::function<Control(const Iteration&, const Solver&)> {
    using function::function;
    Callback() = default;
    Callback(function body) { swap(body); }
    template <class Body>
    requires(std::is_invocable_r_v<Control, Body&, const Iteration&> &&
             !std::is_invocable_r_v<Control, Body&, const Iteration&, const Solver&>)
        Callback(Body body) {
        std::function<Control(const Iteration&)> own = std::move(body);
        if (!own) return;
        *this = [own = std::move(own)](const Iteration& i, const Solver&) { return own(i); };
    }
};
/// Hears, from time to time, of what a run does beside its iterations: what it is, in a few words,
/// and the share of it that is done, in [0, 1]. One call at a time, from any thread; what it throws
/// ends the run and is thrown.
using StageProgress = std::function<void(const char* stage, double share)>;

/// All that survives an iteration: values only. A copy goes on to the same bytes.
class State {
  public:
    State();
    State(const State&);
    State(State&&) noexcept;
    State& operator=(State);
    ~State();
    friend bool operator==(const State&, const State&);

    struct Values;
    explicit State(Values values);
    const Values& values() const { return *values_; }
    Values& values() { return *values_; }

  private:
    std::unique_ptr<Values> values_;
};

/// The bytes of a state, in a versioned format that says so: docs/reference/state.md.
std::string save_state(const State& state);
/// Throws InputError: no state, of another version, or damaged; says the byte offset.
State load_state(const std::string& bytes);

/// A view of textures, rendered with fresh samples.
struct ViewEvaluation {
    Image image = {};                   ///< [height, width, 3], before the view's exposure
    ExposureFactors exposure{1, 1, 1};  ///< the view's, or that of the least loss of `image`
    /// Of the image, its noise included. loss - noise_floor is without it on average.
    double loss = 0;
    /// What the image's noise adds to the loss on average, an estimate. NaN with Loss::kL1 and with
    /// a loss of your own: compare evaluations of equally many samples there.
    double noise_floor = 0;
    /// Peak signal-to-noise ratio in dB beside the view's picture, less what the image's noise adds
    /// to first order; too low where few samples make a grainy image. sRGB-coded, over the pixels
    /// that see an unknown and count in the mask, whose 99th percentile in the picture is white.
    /// Infinite where nothing but noise differs, NaN where no pixel counts.
    double psnr = 0;
};

/// Textures rendered with fresh samples.
struct Evaluation {
    double loss = 0;         ///< the mean over the fitted views; compare it without the noise floor
    double noise_floor = 0;  ///< the mean over the fitted views
    std::vector<ViewEvaluation> views = {};  ///< parallel to Problem::views
    std::uint32_t samples_per_pixel = 0;
    std::size_t rejected = 0;  ///< contributions to all images that were not finite, left out
};
/// The loss without the noise floor, where that is known: what evaluations of different numbers of
/// samples are compared by. May be a little below zero.
double loss_without_noise(const Evaluation& evaluation);
double loss_without_noise(const ViewEvaluation& evaluation);

/// A recovered texture.
struct RecoveredTexture {
    std::string name = {};  ///< Mitsuba's, of the parameter
    Image values = {};      ///< [height, width, channels], linear, in [0, 1]
    /// Of the same size: the start of the unknown, given or searched; also of a run that goes on
    /// from a state, which begins at the state's textures.
    Image start = {};
    /// The share of the iterations for which samples had visited each texel, [height, width, 1].
    Image coverage = {};
    /// How surely each texel is known, 0 to 1, [height, width, 1]: the signal-to-noise gate of its
    /// gradient; 0 where no sample of any view came; width 0 where there is none.
    Image confidence = {};
    /// Texels that a surface reads and that no sample of any view reached: coverage is 0 there.
    std::size_t unvisited = 0;
    /// Whether they hold the mean of their surroundings, otherwise the start: see
    /// Options::unvisited.
    bool filled = false;
};

/// What ended a run.
enum class Ending { kIterations, kTime, kPatience, kCancelled, kSuspended };
const char* name_of(Ending ending);

/// Advances a problem by iterations.
class Solver {
  public:
    /// Searches where unknowns start, where they ask for it; what `progress` throws ends that. The
    /// message of what it throws says what to change. InputError: an option out of range; no view
    /// that is fitted, or no pixel of one that counts; a picture, mask, exposure, camera or
    /// lighting that does not fit; no unknown, or one that is no texture, the same as another one,
    /// cannot be recovered, or has a start or a learning rate out of range; ranks that are none,
    /// more than there are views for, or with different problems. ResourceError:
    /// PathCache::max_bytes holds no pass of each half.
    Solver(Problem problem, Options options, const StageProgress& progress = {});
    /// Goes on from a state of the same problem and options. Exposures that are known are those of
    /// the problem, and records that PathCache::max_bytes leaves no room for are left out. Throws
    /// InputError, too, where the state is that of another problem or of other options.
    Solver(Problem problem, Options options, const State& state);
    Solver(Solver&&) noexcept;
    Solver& operator=(Solver&&) noexcept;
    ~Solver();

    /// One iteration: image, loss, gradient, step of the optimiser; and the checks of
    /// Stop::patience, where they are due. Throws InputError where the adjoint of a loss of your
    /// own is not as large as the image. Where that loss throws, or memory ends, the state is what
    /// it was before; in a check, the iteration is done. ResourceError: memory has ended in the
    /// midst of the optimiser's step, and the solver cannot go on.
    Iteration step();
    /// The rule of Options::stop that the last step has met, counted since this solver was made, or
    /// in a callback of solve() since the run began; steps can go on. Of several processes all find
    /// the same after a step that has returned.
    std::optional<Ending> ending() const;

    /// As it was given, but without starts that are images, and with masks that are 0 where a lens
    /// shows nothing; of several processes without the pictures of the others' views.
    const Problem& problem() const;
    /// Steps done, those behind the state included.
    std::uint32_t iterations() const;
    /// The present texels of an unknown, [height, width, channels], in [0, 1]. They stay where they
    /// are in memory while the solver lives. Throws std::out_of_range: no such unknown.
    const Image& texture(std::size_t unknown) const;
    /// The image of a view [height, width, 3] when a step last visited it, before its exposure;
    /// width 0: none did, it is the view of another process, or there is no such view.
    const Image& image(std::size_t view = 0) const;
    /// That of a view; where it is fitted the one of the last step that visited it, by the weights
    /// of its gradient (Loss::kReweighted), 1 before. Throws std::out_of_range: no such view.
    ExposureFactors exposure(std::size_t view = 0) const;
    State state() const;  ///< of several processes all call it, and what follows: each has a part
    /// What solve() returns of the unknowns after as many iterations: texels that no sample visited
    /// are filled or kept.
    std::vector<RecoveredTexture> recovered() const;
    /// The present textures with fresh samples. samples_per_pixel: 2 to 2^20; an odd number loses
    /// one. salt tells evaluations apart. Throws InputError: fewer or more samples, or as step()
    /// where a loss is your own; and what the progress function throws.
    Evaluation evaluate(std::uint32_t samples_per_pixel, std::uint32_t salt = 0,
                        const Progress& progress = {}) const;

    struct Impl;
    explicit Solver(std::unique_ptr<Impl> impl);
    Impl& impl() { return *impl_; }
    const Impl& impl() const { return *impl_; }

  private:
    std::unique_ptr<Impl> impl_;
};

/// Values that a search for the start has tried.
struct SearchedValues {
    std::vector<float> values = {};  ///< of the group's unknowns; those of colours mean nothing
    /// relMSE of the pixels that see the group, with these values everywhere and the best colour of
    /// each region, without noise on average. In a picture whose white, the 99th percentile of such
    /// pixels, is below 1 the 0.01 of relMSE is times white squared. Weights are in units of the
    /// largest.
    double loss = 0;
    std::size_t regions = 0;  ///< that start from them
};
/// Unknowns of one material, or of several that share one, which were searched together.
struct SearchedGroup {
    std::vector<std::size_t> unknowns = {};  ///< indices into Problem::unknowns
    std::vector<SearchedValues> tried = {};
    /// Known textures that the same materials read: where these are alike, the unknowns start
    /// alike.
    std::vector<std::string> guides = {};
};

/// A search during the run: regions take other values where the samples of all searches together
/// say so.
struct SearchedAgain {
    std::uint32_t iteration = 0;  ///< the one that follows
    std::size_t texels = 0;       ///< that took other values, of all unknowns

    friend bool operator==(const SearchedAgain&, const SearchedAgain&) = default;
};

/// Sums over the iterations of a run.
struct RunCounts {
    std::uint32_t iterations = 0;
    std::size_t paths = 0, derivatives = 0;  ///< as of Iteration
    /// Not finite, left out; of images those of Summary::start and result, too.
    std::size_t rejected_image = 0, rejected_derivatives = 0;
};

struct Summary {
    std::vector<RecoveredTexture> textures = {};  ///< parallel to Problem::unknowns
    /// Of this call, every one; of more than 16,384 the last of every two, of twice as many that of
    /// every four, and so on: never more than 16,384.
    std::vector<Iteration> iterations = {};
    RunCounts counts = {};  ///< of all of them
    Ending ending = Ending::kIterations;
    double seconds = 0;         ///< of the iterations, the callback's between them included
    double search_seconds = 0;  ///< of the search for the start
    std::vector<SearchedGroup> searched = {};        ///< empty where nothing was
    double search_effort = 1;                        ///< see Options::search_effort
    std::vector<SearchedAgain> searched_again = {};  ///< see Options::search_again
    /// Of the textures where the run began, the starts of the unknowns or the textures of the state
    /// that was given, with few samples; with as many as `result` where the noise floor is not
    /// known, so that both losses hold noise alike. Without views where the run was suspended.
    Evaluation start = {};
    Evaluation result = {};  ///< of `textures`; without views where the run was suspended
    State state = {};  ///< from which the run can go on; of several processes: each from its own
};

/// Iterates until Options::stop or the callback ends it, evaluates the result. A problem that is
/// moved in is not copied: many pictures are large. Throws what Solver and its steps throw, and
/// InputError where more than one in 1000 samples of an iteration are not finite.
Summary solve(Problem problem, const Options& options, const Callback& callback = {},
              const StageProgress& progress = {});
/// Goes on from a state; Stop counts from there.
Summary solve(Problem problem, const Options& options, const State& state,
              const Callback& callback = {}, const StageProgress& progress = {});

}  // namespace burnish
