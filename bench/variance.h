// The variance of numbers over independent runs.
#pragma once

#include <cstddef>
#include <vector>

namespace burnish {

/// Sums of the numbers of independent runs.
struct Moments {
    double runs = 0;
    std::vector<double> sum, squares;

    void add(const std::vector<float>& x) {
        sum.resize(x.size()), squares.resize(x.size());
        for (std::size_t i = 0; i < x.size(); ++i) {
            sum[i] += double{x[i]};
            squares[i] += double{x[i]} * double{x[i]};
        }
        ++runs;
    }
    double variance(std::size_t i) const {
        return (squares[i] - sum[i] * sum[i] / runs) / (runs - 1);
    }
};

/// Added up over the numbers.
inline double total_variance(const Moments& m) {
    double total = 0;
    for (std::size_t i = 0; i < m.sum.size(); ++i) total += m.variance(i);
    return total;
}

}  // namespace burnish
