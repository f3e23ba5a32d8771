#include "experiments/decay_rates.h"

#include <algorithm>
#include <vector>

namespace burnish {

double spread_percent(std::span<const double> losses) {
    const auto [low, high] = std::minmax_element(losses.begin(), losses.end());
    return 100 * (positive_ratio(*high, *low) - 1);
}

DecayComparison compare_decay(std::span<const double> method, std::span<const double> baseline) {
    constexpr double kNarrow = 10;  // per cent
    DecayComparison c;
    std::vector<double> ratios;
    for (std::size_t k = 0; k < method.size(); ++k) {
        ratios.push_back(positive_ratio(method[k], baseline[k]));
        c.wins += method[k] < baseline[k];
    }
    c.ratio = ratio_interval(ratios);
    c.spread_percent = spread_percent(method);
    // The range of single runs holds their noise: a wide one refutes nothing, but does not hold.
    const bool is_narrow = c.spread_percent < kNarrow;  // false of NaN
    const Verdict outperforms = verdict_below_one(c.ratio);
    c.verdict = outperforms == Verdict::kHolds && !is_narrow ? Verdict::kPartly : outperforms;
    return c;
}

}  // namespace burnish
