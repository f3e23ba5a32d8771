// Integrators: `direct`, and `path` with the integrators that differentiate it.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>

#include "mitsuba/loader.h"

namespace burnish::mitsuba {

namespace {

constexpr const char* kUnsupportedIntegrators =
    "aov depth direct_projective direct_reparam emission_reparam moment path_guided prb_projective "
    "prb_reparam prbvolpath ptracer stokes volprim_rf_basic";

/// Those that compute what `path` does where there are no media: also of Mitsuba 0.5 and 0.6.
constexpr std::array kLikePath{"volpath", "volpathmis", "volpath_simple", "bdpt", "mlt",
                               "pssmlt",  "erpt"};

void warn_sample_counts(Loader& loader, Properties& properties) {
    for (const char* name : {"shading_samples", "emitter_samples", "bsdf_samples"}) {
        const Property* property = take(properties, name);
        if (property && take_integer(properties, name, 1, 0, 1 << 20) != 1)
            log_warning(
                loader, property->site->place,
                fmt::format("\"{}\" is ignored: one emitter sample and one bsdf sample are drawn "
                            "per camera sample",
                            name));
    }
}

bool is_path_tracer(const std::string& type) {
    return type == "path" || type == "prb" || type == "prb_basic";
}

/// How far paths go: Mitsuba's `path` has no bound unless one is given, its differentiable twins 6.
void load_depth(Loader& loader, const Node& node, Properties& properties) {
    Scene& scene = loader.result.scene;
    const int otherwise = properties.type.starts_with("prb") ? 6 : -1;
    const int depth = take_integer(properties, "max_depth", otherwise, -1, 1 << 20);
    scene.max_depth = depth < 0 ? kUnboundedDepth : depth;
    scene.direct_alpha = false;
    scene.rr_depth = take_integer(properties, "rr_depth", 5, 1, std::numeric_limits<int>::max());
    if (!has_bounces(scene))
        note(loader, node.place,
             fmt::format("integrator \"{}\" with max_depth 2 is direct light", properties.type));
}

}  // namespace

void load_integrator(Loader& loader, const Node& node) {
    Properties properties = open_properties(loader.document, node);
    Scene& scene = loader.result.scene;
    const bool is_like_path = std::ranges::find(kLikePath, properties.type) != kLikePath.end();
    if (is_like_path)
        note(loader, node.place,
             fmt::format("integrator \"{}\" is read as \"path\"", properties.type));
    if (is_like_path || is_path_tracer(properties.type))
        load_depth(loader, node, properties);
    else if (properties.type == "direct")
        warn_sample_counts(loader, properties);
    else
        fail_plugin(node, kUnsupportedIntegrators, "\"direct\" or \"path\"");
    scene.hide_emitters = take_boolean(properties, "hide_emitters", false);
    ignore(properties, {"samples_per_pass", "block_size", "timeout", "strict_normals"});
    warn_unknown(properties, loader.result.warnings);
}

void warn_short_paths(Loader& loader, const Node& integrator) {
    const Scene& scene = loader.result.scene;
    const auto is_pane = [&](BsdfId id) { return pane_of(scene[id]) != nullptr; };
    const auto has_pane = [&](const Shape& shape) {
        return shape.material && std::ranges::any_of(bsdfs_of(scene, shape.material), is_pane);
    };
    if (attribute(integrator, "type").starts_with("volpath") &&
        scene.max_depth != kUnboundedDepth && std::ranges::any_of(scene.shapes, has_pane))
        log_warning(loader, integrator.place,
                    "what goes straight through \"null\", thin glass or a mask counts in "
                    "\"max_depth\", which it does not in Mitsuba's \"volpath\": a larger one gives "
                    "its image");
}

}  // namespace burnish::mitsuba
