#include "gradient/theta.h"

#include <algorithm>

#include "burnish/error.h"
#include "core/contract.h"
#include "paths/trace_input.h"

namespace burnish {

namespace {

/// A look-up reads theta's values with the size of the bitmap that they stand for.
void check_sizes(const Scene& scene, const ThetaTexture& t) {
    BURNISH_REQUIRE(t.texture.value, >=, 0);
    BURNISH_REQUIRE(static_cast<std::size_t>(t.texture.value), <, scene.textures.size());
    const Bitmap* bitmap = bitmap_of(scene[t.texture]);
    BURNISH_REQUIRE(bitmap, !=, nullptr);
    BURNISH_REQUIRE(t.values.width, ==, bitmap->width);
    BURNISH_REQUIRE(t.values.height, ==, bitmap->height);
    BURNISH_REQUIRE(t.values.channels, ==, bitmap->channels);
}

}  // namespace

TextureTable texture_table(const Scene& scene, const Theta& theta) {
    TextureTable table;
    table.textures = scene.textures;
    table.values.assign(scene.textures.size(), nullptr);
    for (const auto* textures : {&theta.textures, &theta.replaced})
        for (const ThetaTexture& t : *textures) {
            check_sizes(scene, t);
            table.values[static_cast<std::size_t>(t.texture.value)] = t.values.values.data();
        }
    return table;
}

std::vector<int> theta_slots(const Scene& scene, const Theta& theta) {
    std::vector<int> slots(scene.textures.size(), -1);
    for (std::size_t i = 0; i < theta.textures.size(); ++i)
        slots[static_cast<std::size_t>(theta.textures[i].texture.value)] = static_cast<int>(i);
    return slots;
}

bool read_as_color(const Scene& scene, TextureId texture) {
    return std::any_of(scene.bsdfs.begin(), scene.bsdfs.end(), [&](const Bsdf& bsdf) {
        const auto colors = colors_of(bsdf);
        return std::any_of(colors.begin(), colors.end(),
                           [&](const ColorInput& c) { return c.texture == texture; });
    });
}

bool read_as_roughness(const Scene& scene, TextureId texture) {
    return std::any_of(scene.bsdfs.begin(), scene.bsdfs.end(), [&](const Bsdf& bsdf) {
        const auto all = roughness_textures(bsdf);
        return std::find(all.begin(), all.end(), texture) != all.end();
    });
}

bool read_as_metallic(const Scene& scene, TextureId texture) {
    return std::any_of(scene.bsdfs.begin(), scene.bsdfs.end(), [&](const Bsdf& bsdf) {
        const auto* principled = std::get_if<Principled>(&bsdf);
        return principled && (*principled)[PrincipledScalar::kMetallic].texture == texture;
    });
}

std::size_t read_together(const Scene& scene, std::span<const TextureId> recovered,
                          TextureId texture) {
    std::size_t max = 0;
    for (std::size_t i = 0; i < scene.bsdfs.size(); ++i) {
        const BsdfId bsdf{static_cast<std::int32_t>(i)};
        if (reads(scene, bsdf, texture))
            max = std::max(max, static_cast<std::size_t>(std::count_if(
                                    recovered.begin(), recovered.end(),
                                    [&](TextureId id) { return reads(scene, bsdf, id); })));
    }
    return max;
}

std::vector<char> unknown_bsdfs(const Scene& scene, std::span<const int> slots) {
    const auto is_unknown = [&](TextureId id) {
        return slots[static_cast<std::size_t>(id.value)] >= 0;
    };
    std::vector<char> unknowns;
    for (std::size_t i = 0; i < scene.bsdfs.size(); ++i) {
        const auto shares = shares_of(scene, {static_cast<std::int32_t>(i)});
        const bool share = std::any_of(shares.begin(), shares.end(),
                                       [&](const BlendShare& s) { return is_unknown(s.weight); });
        const bool input = std::ranges::any_of(textures_of(scene.bsdfs[i]), is_unknown);
        unknowns.push_back(input ? kUnknownInput : share ? kUnknownShareAlone : kNoUnknown);
    }
    return unknowns;
}

std::vector<char> unknown_bsdfs(const Scene& scene, const Theta& theta) {
    return unknown_bsdfs(scene, theta_slots(scene, theta));
}

namespace {

/// Why a texture cannot be recovered, as what is said of it; empty: it can.
std::string objection(const Scene& scene, TextureId texture) {
    const bool turns = turns_normals(scene, texture);
    if (turns || is_of_emitter(scene, texture))
        return std::string("is a texture that ") + (turns ? "turns normals" : "an emitter reads") +
               ", too: expected one of its own";
    for (std::size_t i = 0; i < scene.bsdfs.size(); ++i) {
        const auto shares = shares_of(scene, {static_cast<std::int32_t>(i)});
        if (shares.size() > kMaxShares &&
            std::ranges::count(shares, texture, &BlendShare::weight) > 0)
            return "weighs a material inside of " + std::to_string(shares.size()) +
                   " blends: expected at most " + std::to_string(kMaxShares);
        if (!reads(scene.bsdfs[i], texture)) continue;
        if (delta_lobes(scene, {static_cast<std::int32_t>(i)}) != DeltaLobes::kNone)
            return "belongs to a smooth conductor, plastic or dielectric: expected a rough one";
    }
    return {};
}

}  // namespace

void check_unknown(const Scene& scene, const std::string& name, TextureId texture) {
    const std::string why = objection(scene, texture);
    if (!why.empty()) throw InputError("the unknown " + name + " " + why);
}

bool can_be_recovered(const Scene& scene, TextureId texture) {
    return objection(scene, texture).empty();
}

void add_unknown(const Scene& scene, const std::string& name, TextureId texture, Theta& theta) {
    check_unknown(scene, name, texture);
    theta.textures.push_back({texture, linear_image(std::get<Bitmap>(scene[texture]))});
}

}  // namespace burnish
