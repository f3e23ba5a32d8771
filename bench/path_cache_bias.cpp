// The bias of a pool in a closed loop: how far the gradient of a descent's last iteration lies, on
// average, from the gradient at its textures, along that gradient and relative to it. One line of
// JSON.
//
//   burnish_pool_bias SCENE.xml PARAMETER [--size 48] [--runs 32] [--iterations 30] [--spp 4]
//                     [--window 32] [--learning-rate 0.01] [--parameterization texels]
//
// Image and texture are small, so that a texel sees many samples: otherwise noise hides the bias.
// The textures of a descent depend on the records that its last gradient is made of. Two pools of
// fresh passes at the same textures, a and b, do not: bias = E<g - a, b> / E<a, b>.
#include <CLI/CLI.hpp>
#include <cmath>
#include <iostream>
#include <nlohmann/json.hpp>

#include "cli/option_text.h"
#include "burnish/error.h"
#include "experiments/subject.h"

using namespace burnish;

namespace {

double dot(const Image& a, const Image& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.values.size(); ++i)
        sum += double{a.values[i]} * double{b.values[i]};
    return sum;
}

/// The gradient at `texture` from fresh passes alone.
Image fresh_gradient(const Subject& subject, SolveOptions options, const Image& texture,
                     std::uint32_t seed) {
    options.seed = seed;
    options.pool.samples_per_pixel = options.pool.window = 32;
    SolveState state = start(options, {{subject.texture, texture, 0.01f}});
    iterate(subject.problem, options, state);
    return sum_of(state.pool.gradient[0]);
}

/// Of one run: <g - a, b> and <a, b>.
struct Products {
    double error = 0, norm = 0;
};

Products run_descent(const Subject& subject, SolveOptions options, int iterations,
                     std::uint32_t seed) {
    options.seed = 3 * seed;
    SolveState state = start_gray(subject, options);
    Image texture;
    for (int v = 0; v < iterations; ++v) {
        texture = state.theta.textures[0].values;
        iterate(subject.problem, options, state);
    }
    const Image a = fresh_gradient(subject, options, texture, 3 * seed + 1),
                b = fresh_gradient(subject, options, texture, 3 * seed + 2);
    const double norm = dot(a, b);
    return {dot(sum_of(state.pool.gradient[0]), b) - norm, norm};
}

}  // namespace

int main(int argc, char** argv) try {
    CLI::App app{"The bias of a pool in a closed loop"};
    std::string file, parameter;
    int size = 48;
    SolveOptions options;
    options.gradient.estimator = Estimator::kPool;
    std::uint32_t runs = 32;
    int iterations = 30;
    app.add_option("scene", file)->required();
    app.add_option("parameter", parameter, "full name")->required();
    app.add_option("--size", size, "of the image and the texture")->check(CLI::Range(1, 4096));
    app.add_option("--runs", runs)->check(CLI::Range(2, 100000));
    app.add_option("--iterations", iterations)->check(CLI::Range(1, 100000));
    app.add_option("--spp", options.pool.samples_per_pixel);
    app.add_option("--window", options.pool.window);
    app.add_option("--learning-rate", options.optimizer.learning_rate);
    add_choice(app, "--parameterization", options.parameterization.kind, kParameterizationNames,
               "");
    CLI11_PARSE(app, argc, argv)

    ReproduceOptions reduced;
    reduced.width = reduced.height = reduced.texture_side = size;
    const auto subject = prepare_subject({file, file, parameter}, reduced);
    std::vector<Products> products;
    double error = 0, norm = 0;
    for (std::uint32_t k = 0; k < runs; ++k) {
        products.push_back(run_descent(*subject, options, iterations, k + 1));
        error += products.back().error, norm += products.back().norm;
    }
    const double bias = error / norm;
    double squares = 0;  // of a ratio of means, to first order
    for (const Products& p : products) squares += std::pow(p.error - bias * p.norm, 2);
    const nlohmann::json out{{"scene", file},
                             {"size", size},
                             {"spp", options.pool.samples_per_pixel},
                             {"window", options.pool.window},
                             {"learning_rate", options.optimizer.learning_rate},
                             {"iterations", iterations},
                             {"runs", runs},
                             {"bias", bias},
                             {"standard_error", std::sqrt(squares) / std::abs(norm)}};
    std::cout << out.dump() << "\n";
} catch (const InputError& e) {
    std::cerr << "burnish_pool_bias: " << e.what() << "\n";
    return 1;
}
