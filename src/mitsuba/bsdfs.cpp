// BSDFs: which reader for which type; principled.
#include <fmt/format.h>

#include <array>
#include <cmath>

#include "mitsuba/bsdf_reader.h"

namespace burnish::mitsuba {

namespace {

constexpr const char* kUnsupportedBsdfs =
    "circular hair measured measured_polarized polarizer pplastic retarder";
constexpr const char* kSupported =
    "\"diffuse\", \"principled\", \"principledthin\", \"conductor\", \"roughconductor\", "
    "\"plastic\", "
    "\"roughplastic\", \"dielectric\", \"thindielectric\", \"roughdielectric\", \"null\", "
    "\"twosided\", \"mask\", \"blendbsdf\", \"normalmap\" or \"bumpmap\"";

/// A BSDF of Mitsuba 0.5 and 0.6, or one that has a near relative, and what to write in its place.
struct Replaced {
    const char *type, *expected;
};

constexpr std::array<Replaced, 10> kReplaced{{
    {"phong", "\"roughplastic\" with \"alpha\" = sqrt(2 / (exponent + 2))"},
    {"ward", "\"roughconductor\" with the same \"alpha_u\" and \"alpha_v\""},
    {"roughdiffuse", "\"diffuse\", or \"principled\" with \"specular\" 0"},
    {"coating", "\"principled\" with \"clearcoat\""},
    {"roughcoating", "\"principled\" with \"clearcoat\" and \"clearcoat_gloss\""},
    {"mixturebsdf", "\"blendbsdf\" with \"weight\""},
    {"difftrans", "\"principledthin\" with \"diff_trans\""},
    {"hk", "\"diffuse\" or \"principled\""},
    {"irawan", "\"principled\" with \"sheen\""},
    {"bump", "\"bumpmap\""},
}};

float take_rate(Properties& properties, const char* name) {
    const float rate = take_float(properties, name, 1.0f);
    if (!(rate >= 0))
        fail(properties.node->place,
             fmt::format("the parameter \"{}\" is {}, expected at least 0", name, rate));
    return rate;
}

/// As in Mitsuba: what transmits is told from the air.
float index_of(double eta, bool transmits) {
    const auto rounded = static_cast<float>(eta);
    return rounded == 1 && transmits ? 1.001f : rounded;
}

/// From `eta` or `specular`, of which at most one may be given.
float take_eta(Properties& properties, bool transmits) {
    const Property* given_eta = take(properties, "eta");
    const Property* given_specular = take(properties, "specular");
    if (given_eta && given_specular)
        fail(given_specular->site->place,
             "found both \"eta\" and \"specular\", expected at most one of them");
    if (given_eta) {
        const double eta = take_number(properties, "eta", 1.5);
        if (!(eta >= 1))
            fail(given_eta->site->place, fmt::format("\"eta\" is {}, expected at least 1", eta));
        return index_of(eta, transmits);
    }
    double specular = take_number(properties, "specular", 0.5);
    if (!(specular >= 0 && specular <= 1))
        fail(given_specular->site->place,
             fmt::format("\"specular\" is {}, expected a value in [0, 1]", specular));
    if (transmits && static_cast<float>(specular) == 0) specular = 1e-3;  // as in Mitsuba
    const double eta = 2 / (1 - std::sqrt(0.08 * specular)) - 1;
    return index_of(eta, transmits);
}

struct ScalarName {
    const char* name;
    float fallback;
};

constexpr std::array<ScalarName, kPrincipledScalars> kScalarNames{{
    {"roughness", 0.5f},
    {"anisotropic", 0},
    {"metallic", 0},
    {"spec_trans", 0},
    {"spec_tint", 0},
    {"sheen", 0},
    {"sheen_tint", 0},
    {"flatness", 0},
    {"clearcoat", 0},
    {"clearcoat_gloss", 0},
}};

/// Behind the three channels of the base colour.
constexpr std::size_t kFirstScalar = 3;

/// No texture can take its place, which is said where it is asked for.
void fix_index(BsdfReader& reader, const char* name) {
    reader.loader.result.scene.index_inputs.push_back(fmt::format("{}.{}", reader.id, name));
}

Principled read_principled(BsdfReader& reader) {
    Principled bsdf;
    bsdf.base_color = take_color_input(reader, "base_color");
    for (std::size_t i = 0; i < kScalarNames.size(); ++i) {
        const ScalarReading reading =
            take_scalar_input(reader, kScalarNames[i].name, static_cast<int>(kFirstScalar + i),
                              kScalarNames[i].fallback);
        bsdf.scalars[i] = reading.input;
        if (bool Principled::*const lobe = kScalarLobes[i]) bsdf.*lobe = reading.present;
    }
    if (!bsdf.has_spec_trans) {  // light would pass through: another kind of surface
        std::erase_if(reader.constants, [](const ConstantParameter& c) {
            return c.input ==
                   static_cast<int>(kFirstScalar) + static_cast<int>(PrincipledScalar::kSpecTrans);
        });
        reader.loader.result.scene.absent_lobes.push_back(reader.id + ".spec_trans");
    }
    for (const char* name : {"eta", "specular"}) fix_index(reader, name);
    bsdf.eta = take_eta(reader.properties, bsdf.has_spec_trans);
    bsdf.specular_rate = take_rate(reader.properties, "main_specular_sampling_rate");
    bsdf.clearcoat_rate = take_rate(reader.properties, "clearcoat_sampling_rate");
    bsdf.diffuse_rate = take_rate(reader.properties, "diffuse_reflectance_sampling_rate");
    return bsdf;
}

constexpr std::array<ScalarName, kThinScalars> kThinNames{{
    {"roughness", 0.5f},
    {"anisotropic", 0},
    {"spec_trans", 0},
    {"spec_tint", 0},
    {"sheen", 0},
    {"sheen_tint", 0},
    {"flatness", 0},
    {"diff_trans", 0},
}};

PrincipledThin read_principled_thin(BsdfReader& reader) {
    PrincipledThin bsdf;
    bsdf.base_color = take_color_input(reader, "base_color");
    for (std::size_t i = 0; i < kThinNames.size(); ++i) {
        const bool is_diff_trans = i == static_cast<std::size_t>(ThinScalar::kDiffTrans);
        bsdf.scalars[i] =
            take_scalar_input(reader, kThinNames[i].name, static_cast<int>(kFirstScalar + i),
                              kThinNames[i].fallback,
                              is_diff_trans ? TextureUse::kDiffTrans : TextureUse::kMaterial)
                .input;
    }
    fix_index(reader, "eta");
    bsdf.eta = take_float(reader.properties, "eta", 1.5f);
    if (!(bsdf.eta > 0.6f))  // below, the scaled roughness of transmission has no meaning
        fail(reader.properties.node->place,
             fmt::format("\"eta\" is {}, expected a number above 0.6", bsdf.eta));
    bsdf.rates = {take_rate(reader.properties, "specular_reflectance_sampling_rate"),
                  take_rate(reader.properties, "specular_transmittance_sampling_rate"),
                  take_rate(reader.properties, "diffuse_reflectance_sampling_rate"),
                  take_rate(reader.properties, "diffuse_transmittance_sampling_rate")};
    return bsdf;
}

Bsdf read_bsdf(BsdfReader& reader) {
    const std::string& type = reader.properties.type;
    if (type == "diffuse") return Diffuse{take_color_input(reader, "reflectance")};
    if (type == "principled") return read_principled(reader);
    if (type == "conductor") return read_conductor(reader);
    if (type == "roughconductor") return read_rough_conductor(reader);
    if (type == "plastic") return read_plastic(reader);
    if (type == "roughplastic") return read_rough_plastic(reader);
    if (type == "dielectric") return read_dielectric(reader);
    if (type == "thindielectric") return read_thin_dielectric(reader);
    if (type == "roughdielectric") return read_rough_dielectric(reader);
    if (type == "null") return read_null();
    if (type == "principledthin") return read_principled_thin(reader);
    for (const Replaced& old : kReplaced)
        if (type == old.type) fail_plugin(*reader.properties.node, old.type, old.expected);
    fail_plugin(*reader.properties.node, kUnsupportedBsdfs, kSupported);
}

}  // namespace

BsdfId load_bsdf(Loader& loader, const Node& node, const std::string& id) {
    if (const auto known = loader.bsdfs.find(&node); known != loader.bsdfs.end())
        return known->second;
    BsdfReader reader{loader, open_properties(loader.document, node), id};
    const Bsdf bsdf = read_bsdf(reader);
    warn_unknown(reader.properties, loader.result.warnings);
    auto& bsdfs = loader.result.scene.bsdfs;
    const BsdfId bsdf_id{static_cast<std::int32_t>(bsdfs.size())};
    bsdfs.push_back(bsdf);
    loader.result.source.bsdfs.resize(bsdfs.size(), -1);
    loader.result.source.bsdfs.back() = node.order;
    for (ConstantParameter& c : reader.constants) {
        c.bsdf = bsdf_id;
        c.element = node.order;
        loader.result.scene.constants.push_back(std::move(c));
    }
    loader.bsdfs.emplace(&node, bsdf_id);
    return bsdf_id;
}

}  // namespace burnish::mitsuba
