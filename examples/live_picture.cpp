// Step by step, with a picture that is written anew as the run goes: open it in a viewer that
// follows the file. Left the target, right the image of the present textures.
//
//     live_picture SCENE.xml PICTURE PARAMETER LIVE.png [ITERATIONS]
#include <burnish/burnish.h>

#include <algorithm>
#include <exception>
#include <iostream>

#include "iterations.h"

namespace {

/// Two images of one size, side by side.
burnish::Image beside(const burnish::Image& left, const burnish::Image& right) {
    burnish::Image both = burnish::make_image(left.width + right.width, left.height, 3);
    for (int y = 0; y < left.height; ++y)
        for (int c = 0; c < 3; ++c) {
            for (int x = 0; x < left.width; ++x) both.at(x, y, c) = left.at(x, y, c);
            for (int x = 0; x < right.width; ++x) both.at(left.width + x, y, c) = right.at(x, y, c);
        }
    return both;
}

}  // namespace

int main(int argc, char** argv) try {
    if (argc < 5) throw burnish::InputError("expected SCENE PICTURE PARAMETER LIVE");
    const burnish::Image target = burnish::read_image(argv[2]);
    const std::uint32_t iterations = argc > 5 ? iterations_of(argv[5]) : 200;

    burnish::Solver solver(
        {burnish::Renderer::load(argv[1]), {{.image = target}}, {{.name = argv[3]}}}, {});
    while (solver.iterations() < iterations) {
        const burnish::Iteration iteration = solver.step();
        if (iteration.number % 10 == 0 || solver.iterations() == iterations) {
            burnish::write_image(argv[4], beside(target, solver.image()));
            // iteration.loss holds the noise of its image, which falls as the path cache fills.
            const burnish::Evaluation fresh = solver.evaluate(64);
            std::cout << "iteration " << iteration.number << ", loss "
                      << fresh.loss - fresh.noise_floor << std::endl;
        }
    }
} catch (const std::exception& error) {
    std::cerr << error.what() << "\n";
    return 1;
}
