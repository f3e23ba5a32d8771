// The film `hdrfilm`, its filter, and samplers.
#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "image/image.h"
#include "mitsuba/loader.h"
#include "shading/filter.h"

namespace burnish::mitsuba {

namespace {

float take_filter_number(Properties& properties, const char* name, double fallback, double minimum,
                         double maximum = kMaxFilterRadius) {
    return static_cast<float>(take_within(properties, name, fallback, minimum, maximum));
}

ReconstructionFilter read_filter(Loader& loader, const Node& node) {
    Properties properties = open_properties(loader.document, node);
    ReconstructionFilter filter;
    if (properties.type == "box") {
        filter = {FilterKind::kBox, take_filter_number(properties, "radius", 0.5, 0.5)};
    } else if (properties.type == "tent") {
        filter = {FilterKind::kTent, take_filter_number(properties, "radius", 1, 0.5)};
    } else if (properties.type == "gaussian") {
        filter.stddev = take_filter_number(properties, "stddev", 0.5, 0.05, kMaxFilterRadius / 4);
        filter.radius = 4 * filter.stddev;
    } else if (properties.type == "mitchell") {
        filter.kind = FilterKind::kMitchell;
        filter.b = take_filter_number(properties, "B", 1.0 / 3, -10, 10);
        filter.c = take_filter_number(properties, "C", 1.0 / 3, -10, 10);
    } else if (properties.type == "catmullrom") {
        filter.kind = FilterKind::kCatmullRom;
    } else if (properties.type == "lanczos") {
        filter.kind = FilterKind::kLanczos;
        filter.radius = static_cast<float>(take_integer(properties, "lobes", 3, 1, kMaxLobes));
    } else {
        fail_plugin(node, "",
                    "\"box\", \"tent\", \"gaussian\", \"mitchell\", \"catmullrom\" or \"lanczos\"");
    }
    warn_unknown(properties, loader.result.warnings);
    return filter;
}

void take_size(Loader& loader, Properties& properties, Film& film) {
    film.width = take_integer(properties, "width", 768, 1, kMaxImageSide);
    film.height = take_integer(properties, "height", 576, 1, kMaxImageSide);
    film.crop_x = take_integer(properties, "crop_offset_x", 0, 0, kMaxImageSide);
    film.crop_y = take_integer(properties, "crop_offset_y", 0, 0, kMaxImageSide);
    film.crop_width = take_integer(properties, "crop_width", film.width, 1, kMaxImageSide);
    film.crop_height = take_integer(properties, "crop_height", film.height, 1, kMaxImageSide);
    const Place& place = properties.node->place;
    if (film.crop_x + film.crop_width > film.width || film.crop_y + film.crop_height > film.height)
        fail(place,
             fmt::format(
                 "the crop window of {} x {} pixels at ({}, {}) leaves the film of {} x {} pixels",
                 film.crop_width, film.crop_height, film.crop_x, film.crop_y, film.width,
                 film.height));
    const LoadOptions& options = loader.options;
    if (options.width <= 0 || options.height <= 0) return;
    if (film.crop_width != film.width || film.crop_height != film.height)
        note(loader, place,
             fmt::format("the film is replaced by {} x {} pixels, its crop window is dropped",
                         options.width, options.height));
    film = default_film(options);
}

/// What the file holds; which one it is, and with how many bits, is said on the command line.
void take_file_format(Loader& loader, Properties& properties, Film& film) {
    const auto choose = [&](const char* name, const std::vector<std::string>& known) {
        return known[static_cast<std::size_t>(take_choice_in_any_case(properties, name, known, 0))];
    };
    choose("file_format",
           {"openexr", "exr", "rgbe", "pfm", "png", "jpeg", "jpg", "mfilm", "numpy"});
    choose("component_format", {"float16", "float32", "uint32"});
    const std::string pixels =
        choose("pixel_format",
               {"rgb", "rgba", "luminance", "luminance_alpha", "luminancealpha", "xyz", "xyza"});
    const bool alpha = pixels.back() == 'a';
    if (pixels.starts_with("xyz"))
        note(loader, properties.node->place,
             fmt::format("pixel_format \"{}\" is read as \"{}\"", pixels, alpha ? "rgba" : "rgb"));
    if (pixels.starts_with("luminance"))
        film.pixel_format = alpha ? PixelFormat::kLuminanceAlpha : PixelFormat::kLuminance;
    else
        film.pixel_format = alpha ? PixelFormat::kRgba : PixelFormat::kRgb;
}

}  // namespace

Film read_film(Loader& loader, const Node& node) {
    Properties properties = open_properties(loader.document, node);
    if (properties.type != "hdrfilm" && properties.type != "ldrfilm")
        fail_plugin(node, "specfilm", "\"hdrfilm\"");
    Film film;
    take_size(loader, properties, film);
    if (const Property* filter = take_only(properties, "rfilter"))
        film.filter = read_filter(loader, *filter->node);
    if (take_boolean(properties, "sample_border", false))
        log_warning(
            loader, node.place,
            "sample_border is read as false: pixels within the filter's radius of the border are "
            "averaged over the film alone");
    take_file_format(loader, properties, film);
    ignore(properties, {"banner", "compensate", "high_quality_edges", "gamma", "attach_log"});
    warn_unknown(properties, loader.result.warnings);
    return film;
}

int read_sampler(Loader& loader, const Node& node, int fallback) {
    Properties properties = open_properties(loader.document, node);
    static const std::vector<std::string> kSamplers{"independent", "stratified", "multijitter",
                                                    "orthogonal",  "ldsampler",  "sobol",
                                                    "halton",      "hammersley"};
    if (std::find(kSamplers.begin(), kSamplers.end(), properties.type) == kSamplers.end())
        fail_plugin(node, "", "\"independent\"");
    if (properties.type != "independent")
        note(loader, node.place,
             fmt::format("sampler \"{}\" is read as \"independent\"", properties.type));
    const int count =
        take_integer(properties, "sample_count", fallback, 1, std::numeric_limits<int>::max());
    ignore(properties, {"seed", "jitter", "strength", "scramble", "dimension"});
    warn_unknown(properties, loader.result.warnings);
    return count;
}

Film default_film(const LoadOptions& options) {
    Film film;
    if (options.width <= 0 || options.height <= 0) return film;
    film.width = film.crop_width = options.width;
    film.height = film.crop_height = options.height;
    return film;
}

}  // namespace burnish::mitsuba
