// What low-discrepancy numbers bring to a pool: the variance, over independent runs, of a bank's
// image and of the pool's gradient with `--pool-sequence sobol`, over that with independent
// numbers, for windows of contiguous passes. One line of JSON for each window.
//
//   burnish_pool_variance SCENE.xml PARAMETER [--size W H] [--runs 8] [--starts 0 5 11]
//                         [--windows 8 16 32] [--seed 1] [-D name=value]...
//
// The variances of all pixels or texels are added up as they are (`image`, `gradient`), where a few
// large ones decide, and each relative to its mean square (`image_relative`, `gradient_relative`).
#include <CLI/CLI.hpp>
#include <algorithm>
#include <iostream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "burnish/error.h"
#include "optimize/loss.h"
#include "gradient/path_cache/path_cache.h"
#include "bench_scene.h"

using namespace burnish;

namespace {

constexpr std::uint32_t kTargetPasses = 32;

/// Sums of the numbers of independent runs.
struct Moments {
    double runs = 0;
    std::vector<double> sum, squares;

    void add(const std::vector<float>& x) {
        sum.resize(x.size()), squares.resize(x.size());
        for (std::size_t i = 0; i < x.size(); ++i) {
            sum[i] += double{x[i]};
            squares[i] += double{x[i]} * double{x[i]};
        }
        ++runs;
    }
    double mean(std::size_t i) const { return sum[i] / runs; }
    double variance(std::size_t i) const {
        return (squares[i] - sum[i] * sum[i] / runs) / (runs - 1);
    }
};

double total_variance(const Moments& m, const Moments&) {
    double total = 0;
    for (std::size_t i = 0; i < m.sum.size(); ++i) total += m.variance(i);
    return total;
}

/// Each number's variance over its mean square, which is that of both kinds of runs: the same for
/// either.
double relative_variance(const Moments& m, const Moments& other) {
    double total = 0;
    for (std::size_t i = 0; i < m.sum.size(); ++i) {
        const double mean_square = (m.squares[i] + other.squares[i]) / (m.runs + other.runs);
        if (mean_square > 0) total += m.variance(i) / mean_square;
    }
    return total;
}

double ratio(double (*variance)(const Moments&, const Moments&),
             const std::array<Moments, 2>& of_sequence) {
    return variance(of_sequence[1], of_sequence[0]) / variance(of_sequence[0], of_sequence[1]);
}

struct Window {
    std::size_t start = 0, passes = 0;
    std::array<Moments, 2> images, gradients;  ///< of each sequence
};

/// Shades a part of the banks, which stay as they are.
void measure(const PoolInput& input, Pool& pool, const Image& target, Window& window) {
    std::array<std::deque<RecordBatch>, 2> all;
    const auto move = [](auto from, auto end, auto to) {
        std::copy(std::make_move_iterator(from), std::make_move_iterator(end), to);
    };
    const auto from = static_cast<std::ptrdiff_t>(window.start);
    const auto count = static_cast<std::ptrdiff_t>(window.passes);
    for (std::size_t b = 0; b < 2; ++b) {
        auto& batches = pool.banks[b].batches;
        all[b].swap(batches);
        move(all[b].begin() + from, all[b].begin() + from + count, std::back_inserter(batches));
    }
    const auto images = pool_images(input, pool).images;
    std::array<Image, 2> adjoints;
    for (std::size_t b = 0; b < 2; ++b)
        adjoints[b] = evaluate_loss(Loss::kRelMse, images[b], target, {}).adjoint;
    const auto sequence = static_cast<std::size_t>(input.sequence);
    window.images[sequence].add(images[0].values);
    window.gradients[sequence].add(sum_of(pool_gradient(input, pool, adjoints)[0]).values);
    for (std::size_t b = 0; b < 2; ++b) {
        auto& batches = pool.banks[b].batches;
        move(batches.begin(), batches.end(), all[b].begin() + from);
        all[b].swap(batches);
    }
}

/// A pool of passes 0 .. passes - 1 in each bank.
Pool fill(const PoolInput& input, std::size_t passes) {
    Pool pool = make_pool(*input.scene->scene, *input.theta);
    for (std::size_t k = 0; k < passes; ++k)
        for (const std::size_t bank : {std::size_t{0}, std::size_t{1}})
            trace_pass(input, pool, bank);
    return pool;
}

}  // namespace

int main(int argc, char** argv) try {
    CLI::App app{"Variance of a pool: low-discrepancy over independent numbers"};
    BenchScene bench;
    std::vector<std::size_t> starts{0, 5, 11}, sizes{8, 16, 32};
    std::uint32_t runs = 8, seed = 1;
    add_scene_options(app, bench);
    app.add_option("--runs", runs)->check(CLI::Range(2u, 100000u));
    app.add_option("--starts", starts, "first passes of the windows");
    app.add_option("--windows", sizes, "their numbers of passes");
    app.add_option("--seed", seed);
    CLI11_PARSE(app, argc, argv)

    const auto subject = load_subject(bench);
    Theta theta{{{subject->texture, subject->truth}}};
    const PoolInput of_target{subject->traced.get(), &theta, seed + 1000000};
    Pool pool_of_target = fill(of_target, kTargetPasses);
    const Image target = pool_images(of_target, pool_of_target).images[0];
    pool_of_target = {};
    std::fill(theta.textures[0].values.values.begin(), theta.textures[0].values.values.end(), 0.5f);

    std::vector<Window> windows;
    for (const std::size_t start : starts)
        for (const std::size_t passes : sizes) windows.push_back({start, passes, {}, {}});
    const std::size_t longest = *std::max_element(starts.begin(), starts.end()) +
                                *std::max_element(sizes.begin(), sizes.end());
    for (std::uint32_t run = 0; run < runs; ++run)
        for (const Sequence sequence : {Sequence::kIndependent, Sequence::kSobol}) {
            const PoolInput input{subject->traced.get(), &theta, seed + run, sequence};
            Pool pool = fill(input, longest);
            for (Window& window : windows) measure(input, pool, target, window);
        }
    for (const auto& [start, passes, images, gradients] : windows)
        std::cout << nlohmann::json{{"scene", bench.file},
                                    {"first_pass", start},
                                    {"window", passes},
                                    {"runs", runs},
                                    {"image", ratio(total_variance, images)},
                                    {"image_relative", ratio(relative_variance, images)},
                                    {"gradient", ratio(total_variance, gradients)},
                                    {"gradient_relative", ratio(relative_variance, gradients)}}
                         .dump()
                  << "\n";
} catch (const InputError& e) {
    std::cerr << "burnish_pool_variance: " << e.what() << "\n";
    return 1;
}
