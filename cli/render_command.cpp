// burnish render: a scene to an image.

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <utility>

#include "burnish/error.h"
#include "cli/commands.h"
#include "cli/console.h"
#include "cli/interrupt.h"
#include "cli/option_text.h"
#include "cli/scene_input.h"
#include "core/parallel.h"
#include "core/stopwatch.h"
#include "image/files.h"
#include "image/whole.h"

namespace burnish {

namespace {

struct RenderOptions {
    SceneOptions scene;
    std::string output;
    std::uint32_t samples_per_pixel = 0;  ///< 0: the scene's
    std::vector<std::string> textures;    ///< "NAME=FILE or VALUE"
};

void require_image_name(const std::filesystem::path& file) {
    const std::string extension = lower_extension(file);
    if (extension != ".exr" && extension != ".pfm" && extension != ".png")
        throw UsageError(fmt::format(
            "-o: expected a file name that ends in .exr, .pfm or .png, found '{}'", file.string()));
}

/// About three days on two cores; nobody means it.
void check_samples(const Film& film, std::uint32_t samples) {
    constexpr double kMax = 1e12;
    const double all = samples * pixels_of(film);
    if (all > kMax)
        throw InputError(
            fmt::format("{} x {} pixels of {} samples are {:.2g} samples: expected at most {:.0g}, "
                        "take a smaller "
                        "--spp or --size",
                        film.crop_width, film.crop_height, samples, all, kMax));
}

/// The channels that the film asks for; alpha only where the file has room for it.
Image formatted(Image image, const Renderer& renderer, const RenderOptions& options,
                std::uint32_t samples) {
    const PixelFormat format = renderer.data().traced.film.pixel_format;
    const bool is_gray =
        format == PixelFormat::kLuminance || format == PixelFormat::kLuminanceAlpha;
    if (is_gray) image = with_channels(std::move(image), 1);
    if (format != PixelFormat::kRgba && format != PixelFormat::kLuminanceAlpha) return image;
    if (lower_extension(options.output) == ".pfm") {
        log_info("note: PFM has no alpha, the film's is left out");
        return image;
    }
    const TextureTable textures{renderer.data().scene().textures, {}};
    const TraceInput input{.scene = &renderer.data().traced,
                           .textures = &textures,
                           .key = {options.scene.seed, Stream::kImage}};
    return with_alpha(image, render_alpha(input, samples));
}

void run(const RenderOptions& options) {
    require_image_name(options.output);
    require_writable(options.output);
    const ThreadLimit threads(options.scene.threads);
    LoadedScene loaded = load_scene_with_progress(options.scene);
    replace_textures(loaded.scene, options.textures);
    const auto samples = options.samples_per_pixel
                             ? options.samples_per_pixel
                             : static_cast<std::uint32_t>(std::max(1, loaded.scene.sample_count));
    const Renderer renderer = make_renderer_with_progress(
        std::move(loaded), options.scene.light_selection, options.scene.sensor);
    check_samples(renderer.data().traced.film, samples);
    const Stopwatch watch;
    const Image image = formatted(
        render_with_progress(renderer, {options.scene.seed, Stream::kImage}, samples, "rendering"),
        renderer, options, samples);
    require_finite(image, "the image", "lights of the scene are too bright for single precision");
    {
        const WholeStep whole;  // a signal leaves no unfinished file
        write_image(options.output, image);
    }
    log_info(fmt::format("{}: {} x {} pixels, {} per pixel, {}", options.output, image.width,
                         image.height, count_text(samples, "sample"),
                         duration_text(watch.total())));
}

}  // namespace

void add_render_command(CLI::App& app) {
    auto options = std::make_shared<RenderOptions>();
    CLI::App* command = app.add_subcommand("render", "Renders an image of a scene");
    command
        ->add_option("-o,--output", options->output,
                     "The image: .exr or .pfm (linear), .png (8 bit sRGB)")
        ->type_name("FILE")
        ->required();
    command
        ->add_option("--spp", options->samples_per_pixel,
                     "Samples per pixel; without it the scene's")
        ->type_name("N")
        ->check(in_range({1, kMaxSamplesPerPixel, true}));
    add_texture_option(*command, options->textures);
    add_render_options(*command, options->scene);
    command->callback([options] { run(*options); });
}

}  // namespace burnish
