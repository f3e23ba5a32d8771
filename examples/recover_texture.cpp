// Recovers a texture from a picture, and writes it.
//
//     recover_texture SCENE.xml PICTURE PARAMETER TEXTURE.exr [ITERATIONS]
//
// PICTURE has the size of the scene's film. `burnish info SCENE.xml` lists the parameters.
#include <burnish/burnish.h>

#include <exception>
#include <iostream>

#include "iterations.h"

int main(int argc, char** argv) try {
    if (argc < 5) throw burnish::InputError("expected SCENE PICTURE PARAMETER TEXTURE");

    const burnish::Renderer renderer = burnish::Renderer::load(argv[1]);
    const burnish::Problem problem{
        renderer, {{.image = burnish::read_image(argv[2])}}, {{.name = argv[3], .start = 0.5f}}};
    burnish::Options options;  // the path cache, Adam on a pyramid of the texture
    options.stop.iterations = argc > 5 ? iterations_of(argv[5]) : 200;

    const burnish::Summary summary = burnish::solve(problem, options);

    burnish::write_image(argv[4], summary.textures[0].values);
    // Both without the noise of their images; that of PICTURE stays in both.
    std::cout << "loss " << burnish::loss_without_noise(summary.start) << " -> "
              << summary.result.loss - summary.result.noise_floor << " in "
              << summary.counts.iterations << " iterations\n";
} catch (const std::exception& error) {
    std::cerr << error.what() << "\n";
    return 1;
}
