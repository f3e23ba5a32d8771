#include "cli/suggestion.h"

#include <algorithm>

namespace burnish {

namespace {

/// The distance of Damerau and Levenshtein, each letter touched once.
std::size_t distance(const std::string& a, const std::string& b) {
    const std::size_t width = b.size() + 1;
    std::vector<std::size_t> d((a.size() + 1) * width);
    for (std::size_t i = 0; i <= a.size(); ++i)
        for (std::size_t k = 0; k <= b.size(); ++k) {
            std::size_t& best = d[i * width + k];
            best = std::max(i, k);
            if (i == 0 || k == 0) continue;
            best = std::min({d[(i - 1) * width + k] + 1, d[i * width + k - 1] + 1,
                             d[(i - 1) * width + k - 1] + (a[i - 1] != b[k - 1])});
            if (i > 1 && k > 1 && a[i - 1] == b[k - 2] && a[i - 2] == b[k - 1])
                best = std::min(best, d[(i - 2) * width + k - 2] + 1);
        }
    return d.back();
}

}  // namespace

std::string nearest_name(const std::string& written, const std::vector<std::string>& names) {
    std::string nearest;
    std::size_t least = written.size() / 3 + 1;
    for (const std::string& name : names)
        if (const std::size_t found = distance(written, name); found < least)
            nearest = name, least = found;
    return nearest;
}

}  // namespace burnish
