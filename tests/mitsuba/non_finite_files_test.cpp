// Texels that are not finite become 0, and are counted to the last one.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "image/files.h"
#include "mitsuba/temporary_scene.h"

namespace burnish {
namespace {

/// One in so many values is not finite.
Image spoiled_image(std::size_t one_in) {
    constexpr float kInfinity = std::numeric_limits<float>::infinity();
    Image image = make_image(1024, 512, 3, 0.5f);
    for (std::size_t i = 0; i < image.values.size(); i += one_in)
        image.values[i] = i % 3 == 0 ? NAN : i % 3 == 1 ? kInfinity : -kInfinity;
    return image;
}

void expect_counted(const LoadedScene& loaded, std::size_t count, std::span<const float> values) {
    ASSERT_EQ(loaded.warnings.size(), 1u);
    const std::string text = std::to_string(count) + " values that are not finite: read as 0";
    EXPECT_NE(loaded.warnings[0].find(text), std::string::npos) << loaded.warnings[0];
    for (const float v : values) ASSERT_TRUE(v == 0 || v == 0.5f) << v;
    EXPECT_EQ(static_cast<std::size_t>(std::count(values.begin(), values.end(), 0.0f)), count);
}

TEST(NonFiniteFiles, TexelsAreCounted) {
    for (const std::size_t one_in : {1000001u, 10007u, 101u}) {
        const TemporaryFolder folder;
        const Image image = spoiled_image(one_in);
        const std::size_t count = (image.values.size() + one_in - 1) / one_in;
        write_image(folder.path / "image.exr", image);
        const LoadedScene textured = load_text(folder, R"(<emitter type="constant"/>
            <shape type="sphere"><bsdf type="diffuse"><texture type="bitmap" name="reflectance">
            <string name="filename" value="image.exr"/><boolean name="raw" value="true"/>
            </texture></bsdf></shape>)");
        expect_counted(textured, count, std::get<Bitmap>(textured.scene.textures.back()).values);
        const LoadedScene lit = load_text(folder, R"(<emitter type="envmap">
            <string name="filename" value="image.exr"/></emitter>)");
        expect_counted(lit, count,
                       std::get<EnvironmentEmitter>(lit.scene.emitters[0]).image->values);
    }
}

}  // namespace
}  // namespace burnish
