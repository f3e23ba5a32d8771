#include "mitsuba/indices.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "core/joined.h"
#include "core/lower_case.h"
#include "mitsuba/colors.h"

namespace burnish::mitsuba {

namespace {

struct NamedMetal {
    std::string_view name;
    MetalIndex index;
};

/// Measured spectra as the RGB numbers that Mitsuba's rgb variants make of them.
constexpr std::array<NamedMetal, 41> kMetals{{
    {"a-C", {{2.944046f, 2.227136f, 1.968162f}, {0.8874649f, 0.7992985f, 0.81529f}}},
    {"Ag", {{0.1552762f, 0.116728f, 0.1383876f}, {4.828354f, 3.122222f, 2.146901f}}},
    {"Al", {{1.657501f, 0.8804047f, 0.5212445f}, {9.223811f, 6.269502f, 4.837004f}}},
    {"AlAs", {{3.605296f, 3.232938f, 2.216319f}, {0.0006794373f, 0.0f, 0.007512709f}}},
    {"AlSb", {{0.0f, 4.139375f, 4.669254f}, {0.0f, 0.09400908f, 1.30057f}}},
    {"Au", {{0.143036f, 0.3753071f, 1.442045f}, {3.982997f, 2.385556f, 1.603359f}}},
    {"Be", {{4.185012f, 3.185029f, 2.784061f}, {3.835466f, 3.010122f, 2.868994f}}},
    {"Cr", {{4.369668f, 2.916505f, 1.654905f}, {5.206547f, 4.231306f, 3.754699f}}},
    {"CsI", {{2.1449f, 1.702319f, 1.662427f}, {0.0f, 0.0f, 0.0f}}},
    {"Cu", {{0.2010055f, 0.9237495f, 1.102215f}, {3.913262f, 2.453045f, 2.14209f}}},
    {"Cu_palik", {{0.2132285f, 0.9197154f, 1.102411f}, {3.921873f, 2.457332f, 2.136584f}}},
    {"Cu2O", {{3.551773f, 2.94987f, 2.751875f}, {0.114207f, 0.1938969f, 0.6061339f}}},
    {"CuO", {{3.247541f, 2.447805f, 2.21022f}, {0.5210896f, 0.5700307f, 0.7221789f}}},
    {"d-C", {{2.70872f, 2.318826f, 2.228898f}, {0.0f, 0.0f, 0.0f}}},
    {"Hg", {{2.398939f, 1.440028f, 0.9095704f}, {6.327587f, 4.371925f, 3.421764f}}},
    {"HgTe", {{4.77904f, 3.231196f, 2.659901f}, {1.631613f, 1.58081f, 1.729287f}}},
    {"Ir", {{3.0863f, 2.082191f, 1.617915f}, {5.592153f, 4.067088f, 3.267312f}}},
    {"K", {{0.06404319f, 0.04640977f, 0.03818491f}, {2.1042f, 1.34894f, 0.9131259f}}},
    {"Li", {{0.2657909f, 0.1956183f, 0.2209486f}, {3.540155f, 2.311123f, 1.668607f}}},
    {"MgO", {{2.089584f, 1.650723f, 1.594879f}, {4.332695e-12f, 0.0f, 2.498646e-11f}}},
    {"Mo", {{4.483974f, 3.525131f, 2.77631f}, {4.111437f, 3.420827f, 3.150607f}}},
    {"Na_palik", {{0.06026936f, 0.05614095f, 0.06198843f}, {3.179273f, 2.11249f, 1.579041f}}},
    {"Nb", {{3.420074f, 2.790093f, 2.395629f}, {3.441395f, 2.737666f, 2.579746f}}},
    {"Ni_palik", {{2.367305f, 1.663373f, 1.467078f}, {4.498812f, 3.050153f, 2.345439f}}},
    {"Rh", {{2.585793f, 1.860216f, 1.554263f}, {6.78226f, 4.702987f, 3.976073f}}},
    {"Se", {{4.058311f, 2.842935f, 2.820853f}, {0.7540495f, 0.6384435f, 0.5218076f}}},
    {"Se-e", {{5.722849f, 4.165736f, 4.081338f}, {0.8711363f, 1.105157f, 1.56532f}}},
    {"SiC", {{3.172342f, 2.525972f, 2.479371f}, {7.537664e-07f, 0.0f, 1.019253e-05f}}},
    {"SnTe", {{4.52425f, 1.981645f, 1.281591f}, {0.0f, 0.0f, 0.0f}}},
    {"Ta", {{2.062721f, 2.392939f, 2.627929f}, {2.40836f, 1.741486f, 1.947028f}}},
    {"Te", {{7.390234f, 4.482105f, 2.637106f}, {3.256022f, 3.527059f, 3.292054f}}},
    {"Te-e", {{7.508907f, 4.296429f, 2.369988f}, {5.583929f, 4.947205f, 3.997592f}}},
    {"ThF4", {{1.830714f, 1.442229f, 1.387648f}, {0.0f, 0.0f, 0.0f}}},
    {"TiC", {{3.700528f, 2.837422f, 2.582287f}, {3.265635f, 2.351589f, 2.172791f}}},
    {"TiN", {{1.64845f, 1.150516f, 1.379823f}, {3.368328f, 1.943498f, 1.102068f}}},
    {"TiO2", {{3.45661f, 2.801736f, 2.905175f}, {0.0001052648f, 0.0f, 0.0006528865f}}},
    {"TiO2-e", {{3.106565f, 2.513168f, 2.582444f}, {2.975161e-05f, 0.0f, 0.0001826981f}}},
    {"VC", {{3.657566f, 2.752736f, 2.532672f}, {3.068301f, 2.198687f, 1.963193f}}},
    {"V_palik", {{4.277582f, 3.512949f, 2.761071f}, {3.491301f, 2.889455f, 3.111522f}}},
    {"VN", {{2.865602f, 2.119189f, 1.940091f}, {3.032243f, 2.056116f, 1.616306f}}},
    {"W", {{4.370817f, 3.300246f, 2.998407f}, {3.500641f, 2.604874f, 2.273233f}}},
}};

struct NamedDielectric {
    std::string_view name;
    double index;
};

/// In visible light, at room temperature.
constexpr std::array<NamedDielectric, 23> kDielectrics{{
    {"vacuum", 1.0},      {"helium", 1.000036},        {"hydrogen", 1.000132},
    {"air", 1.000277},    {"carbon dioxide", 1.00045}, {"water", 1.333},
    {"acetone", 1.36},    {"ethanol", 1.361},          {"carbon tetrachloride", 1.461},
    {"glycerol", 1.4729}, {"benzene", 1.501},          {"silicone oil", 1.52045},
    {"bromine", 1.661},   {"water ice", 1.31},         {"fused quartz", 1.458},
    {"pyrex", 1.47},      {"acrylic glass", 1.49},     {"polypropylene", 1.49},
    {"bk7", 1.5046},      {"sodium chloride", 1.544},  {"amber", 1.55},
    {"pet", 1.575},       {"diamond", 2.419},
}};

std::string names_of(const auto& table) {
    return joined(table, [](const auto& row) { return row.name; });
}

const auto* find_name(const auto& table, std::string_view name) {
    const auto found =
        std::find_if(table.begin(), table.end(), [&](const auto& row) { return row.name == name; });
    return found == table.end() ? nullptr : &*found;
}

/// Of a metal, not negative.
Rgbf take_index(Properties& properties, const char* name, const Rgbf& fallback) {
    const Property* given = take(properties, name);
    const Rgbf index = take_color(properties, name, fallback, SpectrumUse::kIndex);
    const auto channels = {index.x, index.y, index.z};
    if (given && !(std::min(channels) >= 0))
        fail(given->site->place, fmt::format("\"{}\" is ({}, {}, {}), expected no negative value",
                                             name, index.x, index.y, index.z));
    return index;
}

}  // namespace

double take_dielectric_index(Properties& properties, const std::string& name,
                             const std::string& fallback) {
    const Property* property = take(properties, name);
    std::string text = fallback;
    if (property && property->node->tag != "string") {
        const double index = take_number(properties, name, 1);
        if (!(index > 0))
            fail(property->site->place,
                 fmt::format("\"{}\" is {}, expected a number above 0", name, index));
        return index;
    }
    if (property) text = take_string(properties, name, fallback);
    text = lower_case(text);
    const NamedDielectric* found = find_name(kDielectrics, text);
    if (!found)
        fail(property->site->place, fmt::format("\"{}\" is \"{:.40}\", expected a number or {}",
                                                name, text, names_of(kDielectrics)));
    return found->index;
}

MetalIndex take_metal_index(Properties& properties) {
    const Property* given = take(properties, "eta");
    const Property* named = take(properties, "material");
    const std::string material = take_string(properties, "material", "none");
    if (given && material != "none")
        fail(given->site->place,
             "found both \"material\" and \"eta\", expected a material, or \"eta\" and \"k\"");
    if (material == "none") {
        MetalIndex index;
        index.eta = take_index(properties, "eta", index.eta);
        index.k = take_index(properties, "k", index.k);
        return index;
    }
    std::string_view name = material;
    const NamedMetal* found = find_name(kMetals, name);
    if (!found && name.ends_with("_palik")) {
        name.remove_suffix(6);
        found = find_name(kMetals, name);
    }
    if (!found)
        fail(named->site->place, fmt::format("\"material\" is \"{:.40}\", expected none, {}",
                                             material, names_of(kMetals)));
    return found->index;
}

}  // namespace burnish::mitsuba
