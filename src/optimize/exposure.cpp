#include "optimize/exposure.h"

#include <algorithm>
#include <cmath>

#include "core/parallel.h"
#include "optimize/loss.h"

namespace burnish {

namespace {

using Sums = std::array<double, 3>;  ///< by channel

/// Numerators and denominators.
struct NormalEquation {
    Sums gi{}, ii{};
};

/// weight(g, j, c): of channel c of a pixel, with j of the half that brings the derivative.
NormalEquation sum_row(const auto& weight, const ImageHalves& halves,
                       const WeightedPicture& picture, int y) {
    NormalEquation sum;
    for (int x = 0; x < picture.image.width; ++x)
        for (int c = 0; c < 3; ++c) {
            const double g = double{picture.image.at(x, y, c)};
            const double a = double{halves.a.at(x, y, c)}, b = double{halves.b.at(x, y, c)};
            const double mask = mask_at(picture.mask, x, y, c);
            if (mask == 0) continue;  // whatever the picture holds there
            const auto i = static_cast<std::size_t>(c);
            const double of_a = 0.5 * mask * weight(g, a, i), of_b = 0.5 * mask * weight(g, b, i);
            sum.gi[i] += g * (of_a * a + of_b * b);
            sum.ii[i] += (of_a + of_b) * a * b;
        }
    return sum;
}

/// Least squares.
NormalEquation sum_squares(const auto& weight, const ImageHalves& halves,
                           const WeightedPicture& picture) {
    std::vector<NormalEquation> rows(static_cast<std::size_t>(picture.image.height));
    parallel_for(rows.size(), [&](std::size_t y) {
        rows[y] = sum_row(weight, halves, picture, static_cast<int>(y));
    });
    NormalEquation sum;
    for (const NormalEquation& row : rows)
        for (std::size_t c = 0; c < 3; ++c) sum.gi[c] += row.gi[c], sum.ii[c] += row.ii[c];
    return sum;
}

/// A value of the sum of weight |e - ratio|.
struct Kink {
    double ratio = 0, weight = 0;

    friend auto operator<=>(const Kink&, const Kink&) = default;
};

/// Least absolute differences: the weighted median of G / I. -1: there is none.
double median_ratio(std::vector<Kink> kinks) {
    std::sort(kinks.begin(), kinks.end());
    double half = 0;
    for (const Kink& k : kinks) half += 0.5 * k.weight;
    double below = 0;
    for (const Kink& k : kinks)
        if ((below += k.weight) >= half && half > 0) return k.ratio;
    return -1;
}

/// Of channels `first` to `end`.
std::vector<Kink> kinks_of(const ImageHalves& halves, const WeightedPicture& picture, int first,
                           int end) {
    const Image& image = picture.image;
    std::vector<Kink> kinks;
    kinks.reserve(image.values.size() / 3 * static_cast<std::size_t>(end - first));
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x)
            for (int c = first; c < end; ++c) {
                const double i =
                    0.5 * (double{halves.a.at(x, y, c)} + double{halves.b.at(x, y, c)});
                const double weight = mask_at(picture.mask, x, y, c) * std::abs(i);
                if (weight > 0) kinks.push_back({double{image.at(x, y, c)} / i, weight});
            }
    return kinks;
}

/// Of a sum of squares.
Sums least_squares(bool by_channel, const auto& weight, const ImageHalves& halves,
                   const WeightedPicture& picture) {
    const NormalEquation n = sum_squares(weight, halves, picture);
    if (by_channel) return {n.gi[0] / n.ii[0], n.gi[1] / n.ii[1], n.gi[2] / n.ii[2]};
    return {(n.gi[0] + n.gi[1] + n.gi[2]) / (n.ii[0] + n.ii[1] + n.ii[2]), 0, 0};
}

/// Of a sum of absolute values.
Sums median_ratios(bool by_channel, const ImageHalves& halves, const WeightedPicture& picture) {
    const auto of = [&](int first, int end) {
        return median_ratio(kinks_of(halves, picture, first, end));
    };
    if (by_channel) return {of(0, 1), of(1, 2), of(2, 3)};
    return {of(0, 3), 0, 0};
}

/// The best factor of each channel, or of all together in the first.
Sums best_factors(bool by_channel, Loss loss, const ImageHalves& halves,
                  const WeightedPicture& picture) {
    switch (loss) {
        case Loss::kRelMse:
        case Loss::kReweighted:
        case Loss::kL2:
            return least_squares(
                by_channel, [&](double g, double, std::size_t) { return square_weight(loss, g); },
                halves, picture);
        case Loss::kL1:
            return median_ratios(by_channel, halves, picture);
    }
    return {};
}

/// The best factors, `last` where they are not above 0.
ExposureFactors or_last(bool by_channel, const Sums& best, const ExposureFactors& last) {
    ExposureFactors exposure = last;
    for (std::size_t c = 0; c < 3; ++c) {
        const auto e = static_cast<float>(best[by_channel ? c : 0]);
        if (e > 0 && std::isfinite(e)) exposure[c] = e;
    }
    return exposure;
}

/// Whether another round of reweighted least squares would change nothing that counts.
bool is_settled(const ExposureFactors& exposure, const ExposureFactors& before) {
    constexpr float kChange = 1e-4f;
    for (std::size_t c = 0; c < 3; ++c)
        if (std::abs(exposure[c] - before[c]) > kChange * before[c]) return false;
    return true;
}

}  // namespace

ExposureFactors fit_exposure(const FitExposure& how, Loss loss, const ImageHalves& halves,
                             const WeightedPicture& picture, const ExposureFactors& last) {
    return or_last(how.by_channel, best_factors(how.by_channel, loss, halves, picture), last);
}

ExposureFactors fit_reweighted_exposure(const FitExposure& how, const ImageHalves& halves,
                                        const WeightedPicture& picture,
                                        const ExposureFactors& last) {
    constexpr int kMaxRounds = 20;  // from one visit to the next one or two are enough
    ExposureFactors exposure = last, before;
    const auto weight = [&](double g, double j, std::size_t c) {
        return reweighted_weight(double{before[c]} * j, g);
    };
    for (int round = 0; round < kMaxRounds; ++round) {
        before = exposure;
        exposure =
            or_last(how.by_channel, least_squares(how.by_channel, weight, halves, picture), before);
        if (is_settled(exposure, before)) break;
    }
    return exposure;
}

}  // namespace burnish
