#include "scene/emitter.h"

#include "core/variant.h"

namespace burnish {

TextureId texture_of(const Emitter& emitter) {
    return match(
        emitter, [](const AreaEmitter& e) { return e.texture; },
        [](const EnvironmentEmitter&) { return TextureId{}; },
        [](const ConstantEmitter&) { return TextureId{}; },
        [](const PointEmitter&) { return TextureId{}; },
        [](const SpotEmitter& e) { return e.texture; },
        [](const DirectionalEmitter&) { return TextureId{}; },
        [](const ProjectorEmitter& e) { return e.texture; });
}

}  // namespace burnish
