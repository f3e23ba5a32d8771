#include "scene/material.h"

#include <algorithm>

#include "core/variant.h"

namespace burnish {

const ColorInput* color_at(const Bsdf& bsdf, int place) {
    const auto i = static_cast<std::size_t>(place);
    return i < first_scalar(bsdf) ? &colors_of(bsdf)[i / 3] : nullptr;
}

const ScalarInput* scalar_at(const Bsdf& bsdf, int place) {
    const auto i = static_cast<std::size_t>(place), first = first_scalar(bsdf);
    return i < first ? nullptr : &scalars_of(bsdf)[i - first];
}

TextureId texture_at(const Bsdf& bsdf, int place) {
    const ColorInput* color = color_at(bsdf, place);
    return color ? color->texture : scalar_at(bsdf, place)->texture;
}

void set_texture(Bsdf& bsdf, int place, TextureId texture) {
    const auto i = static_cast<std::size_t>(place), first = first_scalar(bsdf);
    std::visit(
        [&](auto& b) {
            if (i < first)
                colors_of(b)[i / 3].texture = texture;
            else
                scalars_of(b)[i - first].texture = texture;
        },
        bsdf);
    if (auto* principled = std::get_if<Principled>(&bsdf); principled && i >= first)
        if (bool Principled::*const lobe = kScalarLobes[i - first]) principled->*lobe = true;
}

std::vector<TextureId> roughness_textures(const Bsdf& bsdf) {
    using Inputs = std::span<const ScalarInput>;
    const Inputs inputs = match(
        bsdf, [](const Diffuse&) { return Inputs(); },
        [](const Principled& b) {
            return Inputs(b.scalars).subspan(static_cast<std::size_t>(PrincipledScalar::kRoughness),
                                             1);
        },
        [](const Conductor&) { return Inputs(); },
        [](const RoughConductor& b) { return Inputs(scalars_of(b)); },
        [](const Plastic&) { return Inputs(); }, [](const RoughPlastic&) { return Inputs(); },
        [](const Dielectric&) { return Inputs(); },
        [](const RoughDielectric& b) { return Inputs(scalars_of(b)); },
        [](const PrincipledThin& b) { return Inputs(b.scalars).first(1); });
    std::vector<TextureId> textures;
    for (const ScalarInput& input : inputs)
        if (input.texture) textures.push_back(input.texture);
    return textures;
}

bool transmits(const Bsdf& bsdf) {
    return match(
        bsdf, [](const Diffuse&) { return false; },
        [](const Principled& b) { return b.has_spec_trans; },
        [](const Conductor&) { return false; }, [](const RoughConductor&) { return false; },
        [](const Plastic&) { return false; }, [](const RoughPlastic&) { return false; },
        [](const Dielectric&) { return true; }, [](const RoughDielectric&) { return true; },
        [](const PrincipledThin&) { return true; });
}

bool is_sheet(const Bsdf& bsdf) {
    return pane_of(bsdf) || std::holds_alternative<PrincipledThin>(bsdf);
}

bool mixes_channels(const Bsdf& bsdf) {
    return match(
        bsdf, [](const Diffuse&) { return false; },
        [](const Principled& b) { return b.has_spec_tint || b.has_sheen; },
        [](const Conductor&) { return false; }, [](const RoughConductor&) { return false; },
        [](const Plastic&) { return false; }, [](const RoughPlastic&) { return false; },
        [](const Dielectric&) { return false; }, [](const RoughDielectric&) { return false; },
        [](const PrincipledThin&) { return true; });
}

bool is_sampled_by(const Bsdf& bsdf, int place) {
    const bool by_colors = match(
        bsdf, [](const Diffuse&) { return false; }, [](const Principled&) { return false; },
        [](const Conductor&) { return false; }, [](const RoughConductor&) { return false; },
        [](const Plastic&) { return true; }, [](const RoughPlastic&) { return true; },
        [](const Dielectric&) { return false; }, [](const RoughDielectric&) { return false; },
        [](const PrincipledThin&) { return false; });
    return by_colors || scalar_at(bsdf, place);
}

std::vector<TextureId> textures_of(const Bsdf& bsdf) {
    std::vector<TextureId> textures;
    const auto add = [&](TextureId id) {
        if (id) textures.push_back(id);
    };
    for (const ColorInput& input : colors_of(bsdf)) add(input.texture);
    for (const ScalarInput& input : scalars_of(bsdf)) add(input.texture);
    return textures;
}

bool reads(const Bsdf& bsdf, TextureId texture) {
    return std::ranges::count(textures_of(bsdf), texture) > 0;
}

}  // namespace burnish
