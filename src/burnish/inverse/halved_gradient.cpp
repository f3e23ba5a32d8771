#include "burnish/inverse/halved_gradient.h"

#include <utility>

namespace burnish {

Image sum_of(const HalvedGradient& gradient) {
    Image sum = gradient.first;
    for (std::size_t i = 0; i < gradient.second.values.size(); ++i)
        sum.values[i] += gradient.second.values[i];
    return sum;
}

std::vector<HalvedGradient> unhalved(std::vector<Image> gradients) {
    std::vector<HalvedGradient> result;
    for (Image& g : gradients) result.push_back({std::move(g), {}});
    return result;
}

}  // namespace burnish
