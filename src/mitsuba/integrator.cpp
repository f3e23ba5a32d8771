// Integrators: `direct`, and what means the same.
#include <fmt/format.h>

#include "mitsuba/loader.h"

namespace burnish::mitsuba {

namespace {

constexpr const char* kUnsupported =
    "aov depth direct_projective direct_reparam emission_reparam moment path path_guided prb "
    "prb_basic prb_projective "
    "prb_reparam prbvolpath ptracer stokes volpath volpathmis volprim_rf_basic";

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

}  // namespace

void load_integrator(Loader& loader, const Node& node) {
    Properties properties = open_properties(loader.document, node);
    const bool traces_paths = is_path_tracer(properties.type);
    if (traces_paths) {
        if (!take(properties, "max_depth") ||
            take_integer(properties, "max_depth", 0, -1, 1 << 20) != 2)
            fail_plugin(node, kUnsupported, "\"direct\" (or max_depth 2, which means the same)");
        ignore(properties, {"rr_depth"});
        note(loader, node.place,
             fmt::format("integrator \"{}\" with max_depth 2 is direct light: \"direct\" is taken",
                         properties.type));
    } else if (properties.type == "direct") {
        warn_sample_counts(loader, properties);
    } else {
        fail_plugin(node, kUnsupported, "\"direct\"");
    }
    loader.result.scene.hide_emitters = take_boolean(properties, "hide_emitters", false);
    ignore(properties, {"samples_per_pass", "block_size", "timeout"});
    warn_unknown(properties, loader.result.warnings);
}

}  // namespace burnish::mitsuba
