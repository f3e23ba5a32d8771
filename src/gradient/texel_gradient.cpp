#include "gradient/texel_gradient.h"

namespace burnish {

namespace {

void write_texel(const TexelGradient& g, Image& image) {
    const auto channels = static_cast<std::size_t>(image.channels);
    for (std::size_t c = 0; c < channels; ++c)
        image.values[g.key.texel * channels + c] = g.g[static_cast<int>(c)];
}

}  // namespace

std::vector<Image> dense_gradient(const Theta& theta, const std::vector<TexelGradient>& gradient) {
    std::vector<Image> images;
    for (const ThetaTexture& t : theta.textures)
        images.push_back(make_image(t.values.width, t.values.height, t.values.channels));
    for (const TexelGradient& g : gradient) write_texel(g, images[g.key.slot]);
    return images;
}

void make_dense(const Theta& theta, const std::vector<TexelGradient>& gradient,
                std::vector<SplitGradient>& dense) {
    dense.resize(theta.textures.size());
    for (std::size_t i = 0; i < dense.size(); ++i) {
        const Image& texels = theta.textures[i].values;
        clear(dense[i], texels.width, texels.height, texels.channels, false);
    }
    for (const TexelGradient& g : gradient) {
        SplitGradient& to = dense[g.key.slot];
        write_texel(g, to.first);
        const auto channels = static_cast<std::size_t>(to.first.channels);
        mark_dirty(to.dirty, g.key.texel * channels, (g.key.texel + 1) * channels);
    }
}

}  // namespace burnish
