// Gradients only: the renderer gives an image and dL/d(texture), the optimiser is yours. Here it is
// plain gradient descent on the squared error, with steps of a fixed largest size.
//
//     gradient_only SCENE.xml PICTURE PARAMETER TEXTURE.exr [ITERATIONS]
#include <burnish/burnish.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <iostream>

#include "iterations.h"

namespace {

/// Of the mean of (I - G)^2.
burnish::LossValue squared_error(const burnish::Image& image, const burnish::Image& target) {
    if (target.width != image.width || target.values.size() != image.values.size())
        throw burnish::InputError("expected a picture of the film's size, in RGB");
    burnish::LossValue loss;
    loss.adjoint = image;
    const double count = static_cast<double>(image.values.size());
    for (std::size_t i = 0; i < image.values.size(); ++i) {
        const double difference = image.values[i] - target.values[i];
        loss.value += difference * difference / count;
        loss.adjoint.values[i] = static_cast<float>(2 * difference / count);
    }
    return loss;
}

void descend(const burnish::Image& gradient, float max_step, burnish::Image& texture) {
    float largest = 0;
    for (const float g : gradient.values) largest = std::max(largest, std::abs(g));
    if (largest == 0) return;
    for (std::size_t i = 0; i < texture.values.size(); ++i)
        texture.values[i] =
            std::clamp(texture.values[i] - max_step * gradient.values[i] / largest, 0.0f, 1.0f);
}

}  // namespace

int main(int argc, char** argv) try {
    if (argc < 5) throw burnish::InputError("expected SCENE PICTURE PARAMETER TEXTURE");
    const burnish::Renderer renderer = burnish::Renderer::load(argv[1]);
    const burnish::Image target = burnish::read_image(argv[2]);
    const std::string parameter = argv[3];
    const std::uint32_t iterations = argc > 5 ? iterations_of(argv[5]) : 50;

    burnish::Image texture = renderer.texture(parameter);
    std::fill(texture.values.begin(), texture.values.end(), 0.5f);
    for (std::uint32_t i = 0; i < iterations; ++i) {
        const burnish::TextureValues textures{{parameter, texture}};
        const burnish::LossValue loss = squared_error(renderer.render(16, i, textures), target);
        const burnish::GradientOptions options{.samples = 4, .seed = i, .textures = textures};
        descend(burnish::estimate_gradient(renderer, {parameter}, loss.adjoint, options)[0], 0.1f,
                texture);
        std::cout << "iteration " << i << ", loss " << loss.value << "\n";
    }
    burnish::write_image(argv[4], texture);
} catch (const std::exception& error) {
    std::cerr << error.what() << "\n";
    return 1;
}
