// Every estimator with what changes its way through an iteration: shifts, adaptive and uniform
// sampling, sequences.
#pragma once

#include <string>
#include <vector>

#include "burnish/options.h"

namespace burnish::test {

struct NamedEstimator {
    std::string name;
    Estimator estimator;
};

/// mc, ris, pris, gris and pgris with both shifts, each with uniform and adaptive sampling, and
/// path caches of both sequences; images of kept samples.
inline std::vector<NamedEstimator> all_estimators(std::uint32_t image_samples,
                                                  std::uint32_t samples) {
    std::vector<NamedEstimator> all;
    for (const bool adaptive : {false, true}) {
        const std::string sampling = adaptive ? ", adaptive" : ", uniform";
        all.push_back({"mc" + sampling, MonteCarlo{image_samples, samples, adaptive}});
        for (const bool reuse : {false, true})
            for (const bool positivization : {false, true})
                for (const Shift shift : {Shift::kReplay, Shift::kIdentity}) {
                    if (!reuse && shift == Shift::kIdentity) continue;
                    Reservoirs r;
                    r.image_samples = image_samples, r.samples = samples;
                    r.adaptive_sampling = adaptive;
                    r.positivization = positivization, r.reuse = reuse, r.shift = shift;
                    all.push_back({std::string(positivization ? "p" : "") +
                                       (reuse ? "gris, " : "ris, ") +
                                       (shift == Shift::kReplay ? "replay" : "identity") + sampling,
                                   r});
                }
    }
    Reservoirs kept;
    kept.image_samples = image_samples, kept.samples = samples, kept.image_window = 2;
    kept.shift = Shift::kIdentity;
    all.push_back({"pgris, kept image", kept});
    MonteCarlo baseline{image_samples, samples, true};
    baseline.image_window = 3;
    all.push_back({"mc, kept image", baseline});
    for (const Sequence sequence : {Sequence::kIndependent, Sequence::kSobol}) {
        PathCache cache;
        cache.samples = 4, cache.window = 3, cache.sequence = sequence;
        all.push_back(
            {sequence == Sequence::kSobol ? "path cache, sobol" : "path cache, independent",
             cache});
    }
    return all;
}

}  // namespace burnish::test
