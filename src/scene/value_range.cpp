#include "scene/value_range.h"

#include <algorithm>

namespace burnish {

float largest_value(const Scene& scene, TextureId texture) {
    bool is_diff_trans = false;
    for (const Bsdf& bsdf : scene.bsdfs) {
        const std::vector<TextureId> read = textures_of(bsdf);
        auto others = std::count(read.begin(), read.end(), texture);
        const auto* thin = std::get_if<PrincipledThin>(&bsdf);
        constexpr auto kDiffTrans = static_cast<std::size_t>(ThinScalar::kDiffTrans);
        if (thin && thin->scalars[kDiffTrans].texture == texture) is_diff_trans = true, --others;
        if (others > 0) return 1;
    }
    const bool has_other_use = weighs_parts(scene, texture) || turns_normals(scene, texture);
    return is_diff_trans && !has_other_use ? kMaxDiffTrans : 1;
}

}  // namespace burnish
