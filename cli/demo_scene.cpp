#include "cli/demo_scene.h"

#include "cli/interrupt.h"
#include "scenes/procedural.h"

namespace burnish {

std::filesystem::path write_demo_scene(OutputFolder& output) {
    constexpr ProceduralOptions kScene{.texture_size = 256};
    if (output.unfinished.empty()) make_temporary(output);
    const WholeStep whole;
    const std::filesystem::path folder = output.unfinished / kBuiltIn;
    write_procedural_scene("goblet", folder, kScene);
    return folder / "scene.xml";
}

}  // namespace burnish
