// A loss of your own: the squared difference of the logarithms of image and target, which weighs
// dark and bright parts alike.
//
//     own_loss SCENE.xml PICTURE PARAMETER TEXTURE.exr [ITERATIONS]
//
// Its derivative is not affine in the image, so that the image's noise biases the gradient: the
// more samples an iteration's image has, the less.
#include <burnish/burnish.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <iostream>

#include "iterations.h"

namespace {

/// mean of (log(I + e) - log(G + e))^2, and its derivative by I.
burnish::LossValue log_loss(const burnish::Image& image, const burnish::Image& target) {
    constexpr double kOffset = 0.01;  // of the radiance that counts as dark
    burnish::LossValue loss;
    loss.adjoint = burnish::make_image(image.width, image.height, 3);
    const double count = static_cast<double>(image.values.size());
    for (std::size_t i = 0; i < image.values.size(); ++i) {
        const double shifted = std::max(image.values[i], 0.0f) + kOffset;
        const double difference = std::log(shifted) - std::log(target.values[i] + kOffset);
        loss.value += difference * difference / count;
        loss.adjoint.values[i] = static_cast<float>(2 * difference / (shifted * count));
    }
    return loss;
}

}  // namespace

int main(int argc, char** argv) try {
    if (argc < 5) throw burnish::InputError("expected SCENE PICTURE PARAMETER TEXTURE");
    const burnish::Image target = burnish::read_image(argv[2]);
    const burnish::Problem problem{
        .renderer = burnish::Renderer::load(argv[1]),
        .views = {{.image = target}},
        .unknowns = {{.name = argv[3]}},
        .loss = [&](const burnish::Image& image, std::size_t) { return log_loss(image, target); }};
    burnish::Options options;
    options.stop.iterations = argc > 5 ? iterations_of(argv[5]) : 200;
    options.evaluation_samples = 64;
    // How much noise adds to this loss is not known: as many samples before and after.
    const double before = burnish::Solver(problem, options).evaluate(64).loss;
    const burnish::Summary summary = burnish::solve(problem, options);
    burnish::write_image(argv[4], summary.textures[0].values);
    std::cout << "loss " << before << " -> " << summary.result.loss << "\n";
} catch (const std::exception& error) {
    std::cerr << error.what() << "\n";
    return 1;
}
