// The transfer curve of sRGB, IEC 61966-2-1, both ways.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include "image/image.h"

namespace burnish {

float srgb_to_linear(float encoded) {
    const double v = encoded;
    return static_cast<float>(v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4));
}

float linear_to_srgb(float linear) {
    const double v = linear;
    return static_cast<float>(v <= 0.0031308 ? v * 12.92 : 1.055 * std::pow(v, 1 / 2.4) - 0.055);
}

namespace {

std::uint8_t rounded_code(float encoded) {
    return static_cast<std::uint8_t>(std::lround(encoded * 255.0f));
}

/// The codes of linear_to_srgb, without its power: it rises, so that each code has a least value.
class SrgbCodes {
  public:
    SrgbCodes() {
        const auto code = [](std::uint32_t bits) {
            return rounded_code(linear_to_srgb(std::bit_cast<float>(bits)));
        };
        for (std::size_t k = 0; k < 256; ++k) {
            std::uint32_t min = 0, end = kOne;
            while (min < end) {
                const std::uint32_t middle = min + (end - min) / 2;
                if (code(middle) < k)
                    min = middle + 1;
                else
                    end = middle;
            }
            min_[k] = std::bit_cast<float>(min);
        }
        min_[256] = std::numeric_limits<float>::infinity();
        for (std::uint32_t i = 0; i < first_.size(); ++i) first_[i] = code(i << kShift);
    }
    /// value: from 0 to 1.
    std::uint8_t operator()(float value) const {
        std::uint8_t code = first_[(std::bit_cast<std::uint32_t>(value) & kMagnitude) >> kShift];
        while (value >= min_[code + std::size_t{1}]) ++code;
        return code;
    }

  private:
    static constexpr std::uint32_t kOne = std::bit_cast<std::uint32_t>(1.0f), kShift = 18,
                                   kMagnitude = 0x7fffffff;  // 0 may have a sign

    std::array<float, 257> min_;  ///< of each code; beyond the last what no value reaches
    /// Of floats that agree in all but the last kShift bits, the code of the least.
    std::array<std::uint8_t, (kOne >> kShift) + 1> first_;
};

}  // namespace

std::uint8_t code_of(float value, bool srgb) {
    static const SrgbCodes srgb_codes;
    const float v = value > 0 ? std::min(value, 1.0f) : 0.0f;  // NaN: 0
    return srgb ? srgb_codes(v) : rounded_code(v);
}

}  // namespace burnish
