// BSDFs of smooth and rough interfaces: conductors, plastics and dielectrics.
#include <fmt/format.h>

#include "core/parallel.h"
#include "core/positive_float.h"
#include "mitsuba/bsdf_reader.h"
#include "mitsuba/indices.h"
#include "shading/rough_plastic.h"

namespace burnish::mitsuba {

namespace {

FacetShape take_shape(Properties& properties) {
    ignore(properties, {"sample_visible"});
    return take_choice_in_any_case(properties, "distribution", {"beckmann", "ggx"}, 0) == 0
               ? FacetShape::kBeckmann
               : FacetShape::kGgx;
}

/// place: of the first alpha.
FacetRoughness take_roughness(BsdfReader& reader, int place) {
    FacetRoughness roughness;
    Properties& properties = reader.properties;
    roughness.shape = take_shape(properties);
    const Property* both = take(properties, "alpha");
    const Property *u = take(properties, "alpha_u"), *v = take(properties, "alpha_v");
    if (both && (u || v))
        fail((u ? u : v)->site->place,
             "found \"alpha\" beside \"alpha_u\" or \"alpha_v\", expected it or these two");
    if (bool(u) != bool(v))
        fail((u ? u : v)->site->place,
             fmt::format("found \"{}\" alone, expected both \"alpha_u\" and \"alpha_v\"",
                         u ? "alpha_u" : "alpha_v"));
    roughness.anisotropic = u != nullptr;
    if (roughness.anisotropic)
        roughness.alpha = {take_scalar_input(reader, "alpha_u", place, 0.1f).input,
                           take_scalar_input(reader, "alpha_v", place + 1, 0.1f).input};
    else
        roughness.alpha[0] = take_scalar_input(reader, "alpha", place, 0.1f).input;
    return roughness;
}

/// int_ior / ext_ior.
float take_relative_index(Properties& properties, const char* inside) {
    const double index = take_dielectric_index(properties, "int_ior", inside) /
                         take_dielectric_index(properties, "ext_ior", "air");
    if (!is_positive_float(index))
        fail(properties.node->place,
             fmt::format("\"int_ior\" / \"ext_ior\" is {:g}, expected {}", index, kPositiveFloat));
    return static_cast<float>(index);
}

void require_two_indices(const Properties& properties, float eta) {
    if (eta == 1)
        fail(properties.node->place,
             "\"int_ior\" and \"ext_ior\" are the same, expected two indices of refraction");
}

/// What both plastics have.
void read_plastic_inputs(BsdfReader& reader, auto& bsdf) {
    bsdf.colors = {take_color_input(reader, "diffuse_reflectance", 0),
                   take_color_input(reader, "specular_reflectance", 3, kWhite)};
    bsdf.eta = take_relative_index(reader.properties, "polypropylene");
    require_two_indices(reader.properties, bsdf.eta);
    bsdf.nonlinear = take_boolean(reader.properties, "nonlinear", false);
}

}  // namespace

Conductor read_conductor(BsdfReader& reader) {
    return {take_color_input(reader, "specular_reflectance", 0, kWhite),
            take_metal_index(reader.properties)};
}

RoughConductor read_rough_conductor(BsdfReader& reader) {
    RoughConductor bsdf;
    bsdf.reflectance = take_color_input(reader, "specular_reflectance", 0, kWhite);
    bsdf.index = take_metal_index(reader.properties);
    bsdf.roughness = take_roughness(reader, 3);
    return bsdf;
}

Plastic read_plastic(BsdfReader& reader) {
    Plastic bsdf;
    read_plastic_inputs(reader, bsdf);
    return bsdf;
}

namespace {

/// What its tables depend on.
std::tuple<FacetShape, float, float> key_of(const RoughPlastic& plastic) {
    return {plastic.shape, plastic.alpha, plastic.eta};
}

}  // namespace

RoughPlastic read_rough_plastic(BsdfReader& reader) {
    RoughPlastic bsdf;
    read_plastic_inputs(reader, bsdf);
    bsdf.shape = take_shape(reader.properties);
    bsdf.alpha = take_float(reader.properties, "alpha", 0.1f);
    if (!(bsdf.alpha >= 0 && bsdf.alpha <= 10))
        fail(reader.properties.node->place,
             fmt::format("\"alpha\" is {}, expected a number in [0, 10]", bsdf.alpha));
    constexpr std::size_t kMax = 4096;
    auto& plastics = reader.loader.rough_plastics;
    plastics.emplace(key_of(bsdf), bsdf);
    if (plastics.size() > kMax)
        fail(reader.properties.node->place,
             fmt::format("more than {} \"roughplastic\" differ in \"distribution\", \"alpha\" or "
                         "indices, expected at most as many",
                         kMax));
    return bsdf;
}

void make_rough_plastics(Loader& loader) {
    std::vector<RoughPlastic*> plastics;
    for (auto& [key, plastic] : loader.rough_plastics) plastics.push_back(&plastic);
    parallel_for(plastics.size(),
                 [&](std::size_t i) { *plastics[i] = make_rough_plastic(*plastics[i]); });
    for (Bsdf& bsdf : loader.result.scene.bsdfs) {
        RoughPlastic* plastic = std::get_if<RoughPlastic>(&bsdf);
        if (!plastic) continue;
        const RoughPlastic& made = loader.rough_plastics.at(key_of(*plastic));
        plastic->transmittance = made.transmittance;
        plastic->internal_reflectance = made.internal_reflectance;
    }
}

namespace {

/// What all glass has.
void read_glass_inputs(BsdfReader& reader, auto& bsdf) {
    bsdf.colors = {take_color_input(reader, "specular_reflectance", 0, kWhite),
                   take_color_input(reader, "specular_transmittance", 3, kWhite)};
    bsdf.eta = take_relative_index(reader.properties, "bk7");
}

}  // namespace

Dielectric read_dielectric(BsdfReader& reader) {
    Dielectric bsdf;
    read_glass_inputs(reader, bsdf);
    return bsdf;
}

Dielectric read_thin_dielectric(BsdfReader& reader) {
    Dielectric bsdf = read_dielectric(reader);
    bsdf.thin = true;
    return bsdf;
}

RoughDielectric read_rough_dielectric(BsdfReader& reader) {
    RoughDielectric bsdf;
    read_glass_inputs(reader, bsdf);
    require_two_indices(reader.properties, bsdf.eta);
    bsdf.roughness = take_roughness(reader, 6);
    return bsdf;
}

Dielectric read_null() {
    Dielectric bsdf;
    bsdf.thin = true;
    return bsdf;
}

}  // namespace burnish::mitsuba
