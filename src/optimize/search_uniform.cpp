#include "optimize/search_uniform.h"

#include <algorithm>
#include <map>
#include <span>

namespace burnish {

namespace {

/// Candidates with the same values of the members that are one texel have the same number.
std::vector<std::size_t> classes_of(const SearchGroup& group) {
    std::map<std::vector<float>, std::size_t> numbers;
    std::vector<std::size_t> classes;
    for (const std::vector<float>& candidate : group.candidates) {
        std::vector<float> values;
        for (std::size_t m = 0; m < group.members.size(); ++m)
            if (group.uniform[m]) values.push_back(candidate[m]);
        classes.push_back(numbers.emplace(std::move(values), numbers.size()).first->second);
    }
    return classes;
}

}  // namespace

void fix_uniform(const GroupSearch& s, std::vector<float>& costs) {
    constexpr float kNever = 1000;
    const std::vector<std::size_t> classes = classes_of(s.group);
    std::vector<double> sums(1 + std::ranges::max(classes));
    if (sums.size() == 1) return;
    const std::size_t candidates = classes.size();
    for (std::size_t r = 0; r < s.regions(); ++r) {
        if (!s.is_known(r)) continue;
        std::vector<float> min(sums.size(), kInfinity);
        std::vector<double> losses(sums.size());
        for (std::size_t k = 0; k < candidates; ++k) {
            const std::size_t c = classes[k], at = r * candidates + k;
            if (costs[at] < min[c]) min[c] = costs[at], losses[c] = s.sums.losses[at];
        }
        for (std::size_t c = 0; c < sums.size(); ++c) sums[c] += losses[c];
    }
    const auto best = static_cast<std::size_t>(std::ranges::min_element(sums) - sums.begin());
    for (std::size_t r = 0; r < s.regions(); ++r) {
        const std::span<float> own(&costs[r * candidates], candidates);
        float min = kInfinity;
        for (std::size_t k = 0; k < candidates; ++k)
            if (classes[k] == best) min = std::min(min, own[k]);
        for (std::size_t k = 0; k < candidates; ++k)
            own[k] = classes[k] == best ? own[k] - min : kNever;
    }
}

float uniform_value(const GroupSearch& s, const std::vector<std::uint32_t>& labels,
                    std::size_t member, std::size_t channel) {
    ColorSums colors;
    std::map<float, double> squares;  // of a value
    for (std::size_t r = 0; r < s.regions(); ++r) {
        if (!s.is_known(r)) continue;
        squares[s.group.candidates[labels[r]][member]] += s.sums.squares[r];
        if (s.group.color) colors += s.color_at(r, labels[r]);
    }
    if (s.plan.colors[s.group.members[member]])
        return member == s.group.color ? color_of(colors, s.group.gray)[channel] : 0.5f;
    const auto max =
        std::ranges::max_element(squares, {}, [](const auto& of_value) { return of_value.second; });
    return max == squares.end() ? 0.5f : max->first;
}

}  // namespace burnish
