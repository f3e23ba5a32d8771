#include "gradient/binding.h"

#include "render/visible_pixels.h"

namespace burnish {

namespace {

TraceInput trace_input(const Binding& binding, RandomKey key, std::uint32_t passes_per_iteration,
                       SurfaceChoice choice) {
    TraceInput input;
    input.scene = &binding.traced;
    input.textures = &binding.textures;
    input.key = key;
    input.passes_per_iteration = passes_per_iteration;
    input.choice = choice;
    input.unknown_bsdfs = binding.unknown_bsdfs;
    input.slots = binding.slots;
    return input;
}

}  // namespace

Binding::Binding(const TracedScene& scene, const Theta& unknowns)
    : traced(scene),
      theta(unknowns),
      textures(texture_table(*scene.scene, unknowns)),
      slots(theta_slots(*scene.scene, unknowns)),
      unknown_bsdfs(burnish::unknown_bsdfs(*scene.scene, slots)),
      shaders(make_record_shaders(*scene.scene, textures, slots)) {}

TraceInput unknown_part(const Binding& binding, RandomKey key, std::uint32_t passes_per_iteration) {
    return trace_input(binding, key, passes_per_iteration, SurfaceChoice::kUnknown);
}

TraceInput unknown_derivatives(const Binding& binding, RandomKey key,
                               std::uint32_t passes_per_iteration) {
    TraceInput input = unknown_part(binding, key, passes_per_iteration);
    input.keep_black = true;
    return input;
}

TraceInput constant_part(const Binding& binding, RandomKey key) {
    TraceInput input = trace_input(binding, key, 1, SurfaceChoice::kConstant);
    input.sequence = Sequence::kSobol;
    return input;
}

std::vector<char> reaching_pixels(const Binding& binding) {
    return reaching_pixels(binding.traced, binding.unknown_bsdfs);
}

}  // namespace burnish
