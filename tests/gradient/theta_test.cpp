#include "gradient/theta.h"

#include <gtest/gtest.h>

#include "small_scene.h"

namespace burnish::test {
namespace {

TEST(Theta, CountsTheTexturesThatChangeTheSameLight) {
    Scene scene = make_small_scene();  // textures 0 and 1 are of one principled BSDF
    scene.textures.push_back(scene.textures[0]);
    Diffuse diffuse;
    diffuse.reflectance.texture = {2};
    scene.bsdfs.push_back(diffuse);
    const TextureId base{0}, roughness{1}, other{2}, unread{3};
    const std::vector<TextureId> two{base, roughness}, all{base, roughness, other},
        apart{roughness, other};
    EXPECT_EQ(read_together(scene, two, base), 2u);
    EXPECT_EQ(read_together(scene, all, roughness), 2u);
    EXPECT_EQ(read_together(scene, all, other), 1u) << "of a BSDF of its own";
    EXPECT_EQ(read_together(scene, apart, roughness), 1u) << "the base colour is not recovered";
    EXPECT_EQ(read_together(scene, all, unread), 0u);

    // Read by both BSDFs: that with more of them counts.
    std::get<Diffuse>(scene.bsdfs.back()).reflectance.texture = base;
    EXPECT_EQ(read_together(scene, all, base), 2u);
}

}  // namespace
}  // namespace burnish::test
