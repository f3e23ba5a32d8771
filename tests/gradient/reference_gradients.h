// Gradients of sum(A * image) by texels: independent batches of ours, beside a stored mean and
// standard error.
#pragma once

#include <filesystem>
#include <string>

#include "gradient/estimators.h"
#include "image/image.h"
#include "mitsuba/load.h"
#include "student.h"

namespace burnish::test {

/// A stored gradient by one texture: [height, width, channels].
struct ReferenceGradient {
    std::string parameter;  ///< e.g. "roughness"
    Image mean, standard_error;
};

/// A scene with its adjoint image, all its textures as theta, and the stored gradients in the same
/// order.
struct GradientCase {
    Scene scene;
    Image adjoint;
    Theta theta;
    std::vector<ReferenceGradient> references;
};

/// "mat.brdf_0.roughness.data" -> "roughness"
inline std::string short_name(const std::string& parameter) {
    const std::size_t end = parameter.rfind('.');
    const std::size_t begin = parameter.rfind('.', end - 1);
    return parameter.substr(begin + 1, end - begin - 1);
}

inline GradientCase load_gradient_case(const std::filesystem::path& file) {
    GradientCase c;
    c.scene = load_scene(file).scene;
    const std::filesystem::path folder = file.parent_path();
    const std::string name = file.stem().string();
    c.adjoint = read_image(folder / (name + "_adjoint.exr"));
    for (const Parameter& p : c.scene.parameters) {
        const std::string stored = name + "_d_" + short_name(p.name);
        const auto& bitmap = std::get<Bitmap>(c.scene[p.texture]);
        c.theta.textures.push_back({p.texture, linear_image(bitmap)});
        c.references.push_back({short_name(p.name), read_image(folder / (stored + ".exr")),
                                read_image(folder / (stored + "_stderr.exr"))});
    }
    return c;
}

/// Means over batches: [texture][texel and channel].
using GradientMeans = std::vector<std::vector<RunningMean>>;

inline void add_batch(GradientMeans& means, const std::vector<Image>& batch) {
    means.resize(batch.size());
    for (std::size_t t = 0; t < batch.size(); ++t) {
        means[t].resize(batch[t].values.size());
        for (std::size_t i = 0; i < means[t].size(); ++i)
            means[t][i].add(double{batch[t].values[i]});
    }
}

/// Of every texel: a seeded defect.
inline GradientMeans larger_by(double factor, GradientMeans means) {
    for (auto& texture : means)
        for (RunningMean& m : texture) m = larger_by(factor, m);
    return means;
}

struct GradientBatches {
    std::uint32_t seed = 0, count = 32;
    std::uint32_t iterations = 1;  ///< chained at the frozen textures; the last one counts
};

/// One estimate from each of `count` seeds.
inline GradientMeans gradient_means(const GradientCase& c, const Estimator& estimator,
                                    const GradientBatches& batches) {
    const TracedScene traced = prepare(c.scene);
    const Binding binding(traced, c.theta);
    GradientMeans means;
    for (std::uint32_t b = 0; b < batches.count; ++b) {
        EstimatorState state = make_state(estimator);
        GradientResult result;
        for (std::uint32_t v = 0; v < batches.iterations; ++v)
            result = estimate(estimator, binding, c.adjoint, {batches.seed + b, v}, state);
        add_batch(means, dense_gradient(c.theta, result.gradient));
    }
    return means;
}

}  // namespace burnish::test
