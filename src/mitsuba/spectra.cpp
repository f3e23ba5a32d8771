#include "mitsuba/spectra.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <sstream>
#include <vector>

#include "image/files.h"
#include "image/xyz.h"
#include "mitsuba/numbers.h"

namespace burnish::mitsuba {

namespace {

/// The standard observer's x, y, z (CIE 1931, 2 degrees) and daylight (D65, 100 at 560 nm), every
/// 5 nm.
struct Wavelength {
    float x, y, z, daylight;
};

constexpr double kFirst = 360, kLast = 830;
constexpr std::array<Wavelength, 95> kWavelengths{{
    // clang-format off
    {0.0001299f, 3.917e-06f, 0.0006061f, 46.6383f}, {0.0002321f, 6.965e-06f, 0.001086f, 49.3637f},
    {0.0004149f, 1.239e-05f, 0.001946f, 52.0891f}, {0.0007416f, 2.202e-05f, 0.003486f, 51.0323f},
    {0.001368f, 3.9e-05f, 0.006450001f, 49.9755f}, {0.002236f, 6.4e-05f, 0.01054999f, 52.3118f},
    {0.004243f, 0.00012f, 0.02005001f, 54.6482f}, {0.00765f, 0.000217f, 0.03621f, 68.7015f},
    {0.01431f, 0.000396f, 0.06785001f, 82.7549f}, {0.02319f, 0.00064f, 0.1102f, 87.1204f},
    {0.04351f, 0.00121f, 0.2074f, 91.486f}, {0.07763f, 0.00218f, 0.3713f, 92.4589f},
    {0.13438f, 0.004f, 0.6456f, 93.4318f}, {0.21477f, 0.0073f, 1.03905f, 90.057f},
    {0.2839f, 0.0116f, 1.3856f, 86.6823f}, {0.3285f, 0.01684f, 1.62296f, 95.7736f},
    {0.34828f, 0.023f, 1.74706f, 104.865f}, {0.34806f, 0.0298f, 1.7826f, 110.936f},
    {0.3362f, 0.038f, 1.77211f, 117.008f}, {0.3187f, 0.048f, 1.7441f, 117.41f},
    {0.2908f, 0.06f, 1.6692f, 117.812f}, {0.2511f, 0.0739f, 1.5281f, 116.336f},
    {0.19536f, 0.09098f, 1.28764f, 114.861f}, {0.1421f, 0.1126f, 1.0419f, 115.392f},
    {0.09564f, 0.13902f, 0.8129501f, 115.923f}, {0.05795001f, 0.1693f, 0.6162f, 112.367f},
    {0.03201f, 0.20802f, 0.46518f, 108.811f}, {0.0147f, 0.2586f, 0.3533f, 109.082f},
    {0.0049f, 0.323f, 0.272f, 109.354f}, {0.0024f, 0.4073f, 0.2123f, 108.578f},
    {0.0093f, 0.503f, 0.1582f, 107.802f}, {0.0291f, 0.6082f, 0.1117f, 106.296f},
    {0.06327f, 0.71f, 0.07824999f, 104.79f}, {0.1096f, 0.7932f, 0.05725001f, 106.239f},
    {0.1655f, 0.862f, 0.04216f, 107.689f}, {0.2257499f, 0.9148501f, 0.02984f, 106.047f},
    {0.2904f, 0.954f, 0.0203f, 104.405f}, {0.3597f, 0.9803f, 0.0134f, 104.225f},
    {0.4334499f, 0.9949501f, 0.008749999f, 104.046f}, {0.5120501f, 1.0f, 0.005749999f, 102.023f},
    {0.5945f, 0.995f, 0.0039f, 99.99999f}, {0.6784f, 0.9786f, 0.002749999f, 98.1671f},
    {0.7621f, 0.952f, 0.0021f, 96.3342f}, {0.8425f, 0.9154f, 0.0018f, 96.0611f},
    {0.9163f, 0.87f, 0.001650001f, 95.788f}, {0.9786f, 0.8163f, 0.0014f, 92.2368f},
    {1.0263f, 0.757f, 0.0011f, 88.6856f}, {1.0567f, 0.6949f, 0.001f, 89.3459f},
    {1.0622f, 0.631f, 0.0008f, 90.00621f}, {1.0456f, 0.5668f, 0.0006f, 89.8026f},
    {1.0026f, 0.503f, 0.00034f, 89.5991f}, {0.9384f, 0.4412f, 0.00024f, 88.6489f},
    {0.8544499f, 0.381f, 0.00019f, 87.6987f}, {0.7514f, 0.321f, 0.0001f, 85.4936f},
    {0.6424f, 0.265f, 4.999999e-05f, 83.2886f}, {0.5419f, 0.217f, 3e-05f, 83.4939f},
    {0.4479f, 0.175f, 2e-05f, 83.69921f}, {0.3608f, 0.1382f, 1e-05f, 81.863f},
    {0.2835f, 0.107f, 0.0f, 80.0268f}, {0.2187f, 0.0816f, 0.0f, 80.1207f},
    {0.1649f, 0.061f, 0.0f, 80.2146f}, {0.1212f, 0.04458f, 0.0f, 81.2462f},
    {0.0874f, 0.032f, 0.0f, 82.2778f}, {0.0636f, 0.0232f, 0.0f, 80.281f},
    {0.04677f, 0.017f, 0.0f, 78.2842f}, {0.0329f, 0.01192f, 0.0f, 74.0027f},
    {0.0227f, 0.00821f, 0.0f, 69.7213f}, {0.01584f, 0.005723f, 0.0f, 70.6652f},
    {0.01135916f, 0.004102f, 0.0f, 71.6091f}, {0.008110916f, 0.002929f, 0.0f, 72.979f},
    {0.005790346f, 0.002091f, 0.0f, 74.349f}, {0.004109457f, 0.001484f, 0.0f, 67.9765f},
    {0.002899327f, 0.001047f, 0.0f, 61.604f}, {0.00204919f, 0.00074f, 0.0f, 65.7448f},
    {0.001439971f, 0.00052f, 0.0f, 69.8856f}, {0.0009999493f, 0.0003611f, 0.0f, 72.4863f},
    {0.0006900786f, 0.0002492f, 0.0f, 75.087f}, {0.0004760213f, 0.0001719f, 0.0f, 69.3398f},
    {0.0003323011f, 0.00012f, 0.0f, 63.5927f}, {0.0002348261f, 8.48e-05f, 0.0f, 55.0054f},
    {0.0001661505f, 6e-05f, 0.0f, 46.4182f}, {0.000117413f, 4.24e-05f, 0.0f, 56.6118f},
    {8.307527e-05f, 3e-05f, 0.0f, 66.8054f}, {5.870652e-05f, 2.12e-05f, 0.0f, 65.0941f},
    {4.150994e-05f, 1.499e-05f, 0.0f, 63.3828f}, {2.935326e-05f, 1.06e-05f, 0.0f, 63.8434f},
    {2.067383e-05f, 7.4657e-06f, 0.0f, 64.304f}, {1.455977e-05f, 5.2578e-06f, 0.0f, 61.8779f},
    {1.025398e-05f, 3.7029e-06f, 0.0f, 59.4519f}, {7.221456e-06f, 2.6078e-06f, 0.0f, 55.7054f},
    {5.085868e-06f, 1.8366e-06f, 0.0f, 51.959f}, {3.581652e-06f, 1.2934e-06f, 0.0f, 54.6998f},
    {2.522525e-06f, 9.1093e-07f, 0.0f, 57.4406f}, {1.776509e-06f, 6.4153e-07f, 0.0f, 58.8765f},
    {1.251141e-06f, 4.5181e-07f, 0.0f, 60.3125f},
    // clang-format on
}};

Vec3<double> rec709_of(const Vec3<double>& xyz) {
    const auto row = [&](const double* of) {
        return of[0] * xyz.x + of[1] * xyz.y + of[2] * xyz.z;
    };
    return {row(kRec709OfXyz[0]), row(kRec709OfXyz[1]), row(kRec709OfXyz[2])};
}

struct Sample {
    double wavelength, value;
};

std::vector<Sample> parse_pairs(const std::string& text, const Place& place) {
    std::string blank = text;
    std::replace(blank.begin(), blank.end(), ':', ' ');
    const std::vector<double> numbers = parse_numbers(blank, place);
    std::vector<Sample> samples;
    for (std::size_t i = 0; i + 1 < numbers.size(); i += 2)
        samples.push_back({numbers[i], numbers[i + 1]});
    const auto increases = [](const Sample& a, const Sample& b) {
        return a.wavelength >= b.wavelength;
    };
    if (samples.size() < 2 || numbers.size() % 2 != 0 ||
        std::adjacent_find(samples.begin(), samples.end(), increases) != samples.end())
        fail(place, fmt::format("the spectrum is \"{:.40}\", expected two or more pairs such as "
                                "\"400:0.1, 500:0.7\", whose wavelengths increase",
                                text));
    return samples;
}

double value_at(const std::vector<Sample>& samples, double wavelength) {
    const auto after =
        std::lower_bound(samples.begin(), samples.end(), wavelength,
                         [](const Sample& s, double value) { return s.wavelength < value; });
    if (after == samples.end()) return 0;
    if (after == samples.begin()) return after->wavelength == wavelength ? after->value : 0;
    const Sample &a = after[-1], &b = *after;
    return std::lerp(a.value, b.value, (wavelength - a.wavelength) / (b.wavelength - a.wavelength));
}

/// Observer and daylight in between.
Wavelength at(double wavelength) {
    const double place = (wavelength - kFirst) / 5;
    const auto i = std::min(static_cast<std::size_t>(place), kWavelengths.size() - 2);
    const auto t = static_cast<float>(place - static_cast<double>(i));
    const Wavelength &a = kWavelengths[i], &b = kWavelengths[i + 1];
    return {std::lerp(a.x, b.x, t), std::lerp(a.y, b.y, t), std::lerp(a.z, b.z, t),
            std::lerp(a.daylight, b.daylight, t)};
}

}  // namespace

Rgbf rgb_of_spectrum(const std::string& text, SpectrumUse use, const Place& place) {
    const std::vector<Sample> samples = parse_pairs(text, place);
    constexpr int kSteps = 1000;
    constexpr double kObserverArea = 106.75026, kDaylightMean = 98.997418;
    Vec3<double> xyz{};
    for (int i = 0; i < kSteps; ++i) {
        const double wavelength = kFirst + (kLast - kFirst) * i / (kSteps - 1);
        const Wavelength w = at(wavelength);
        const double value =
            value_at(samples, wavelength) *
            (use == SpectrumUse::kEmission ? 1 : double{w.daylight} / kDaylightMean);
        xyz = xyz + Vec3<double>{double{w.x}, double{w.y}, double{w.z}} * value;
    }
    const Vec3<double> rgb = rec709_of(xyz * ((kLast - kFirst) / kSteps / kObserverArea));
    const auto clamped = [&](double v) {
        v = std::max(v, 0.0);
        return static_cast<float>(use == SpectrumUse::kReflectance ? std::min(v, 1.0) : v);
    };
    return {clamped(rgb.x), clamped(rgb.y), clamped(rgb.z)};
}

std::string read_spectrum_file(const std::filesystem::path& file) {
    require_short_text(file, "wavelengths and values");
    std::istringstream lines(read_text_bytes(file));
    Place place{file.string(), 0, 1};
    std::string pairs;
    for (std::string line; std::getline(lines, line);) {
        ++place.line;
        const std::string text = line.substr(0, line.find('#'));
        if (text.find_first_not_of(" \t\r") == std::string::npos) continue;
        const std::vector<double> pair = parse_numbers(text, place);
        if (pair.size() != 2)
            fail(place,
                 fmt::format("found {} numbers, expected a wavelength and a value", pair.size()));
        pairs += fmt::format("{}{}:{}", pairs.empty() ? "" : ", ", pair[0], pair[1]);
    }
    return pairs;
}

}  // namespace burnish::mitsuba
