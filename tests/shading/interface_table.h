// Rows of the reference tables of BSDFs of interfaces: the BSDF, what it reads and two directions.
#pragma once

#include <map>
#include <tuple>

#include "core/dual.h"
#include "csv.h"
#include "shading/bsdf.h"
#include "shading/rough_plastic.h"

namespace burnish::test {

/// Numbers that a row gives, in double: the inputs, then wi and wo.
constexpr std::size_t kRowNumbers = kBsdfInputs + 6;
using RowNumbers = std::array<double, kRowNumbers>;

struct InterfaceRow {
    std::size_t line = 0;
    Bsdf bsdf;
    RowNumbers numbers{};
    std::array<double, 3> f{};
    double pdf = 0;
};

template <class T>
struct InterfaceValue {
    std::array<T, 3> f{};
    T pdf{};
};

template <class T>
Vec3<T> direction_of(const RowNumbers& n, std::size_t first) {
    return {static_cast<T>(n[first]), static_cast<T>(n[first + 1]), static_cast<T>(n[first + 2])};
}

template <class T>
InterfaceValue<T> evaluate(const Bsdf& bsdf, const RowNumbers& n) {
    BsdfInputs<T> inputs;
    for (std::size_t i = 0; i < kBsdfInputs; ++i) inputs[i] = static_cast<T>(n[i]);
    const auto wi = direction_of<T>(n, kBsdfInputs), wo = direction_of<T>(n, kBsdfInputs + 3);
    return std::visit(
        [&](const auto& b) -> InterfaceValue<T> {
            const auto p = bsdf_parameters(b, inputs);
            const Rgb<T> f = eval_bsdf(p, wi, wo);
            return {{f.x, f.y, f.z}, pdf_bsdf(p, wi, wo)};
        },
        bsdf);
}

inline float number(const CsvRow& row, const char* column) {
    return static_cast<float>(row[column]);
}
inline Rgbf color(const CsvRow& row, const char* name) {
    const std::string n = name;
    return {number(row, (n + "_r").c_str()), number(row, (n + "_g").c_str()),
            number(row, (n + "_b").c_str())};
}
inline FacetShape shape_of(const CsvRow& row) {
    return row["ggx"] == 1 ? FacetShape::kGgx : FacetShape::kBeckmann;
}
/// int_ior in a vacuum.
inline float eta_of(const CsvRow& row) { return number(row, "int_ior"); }

inline Bsdf rough_conductor_of(const CsvRow& row, RowNumbers& n) {
    RoughConductor b;
    b.index = {color(row, "eta"), color(row, "k")};
    b.roughness = {shape_of(row), true, {}};
    n[0] = row["spec_r"], n[1] = row["spec_g"], n[2] = row["spec_b"];
    n[3] = row["alpha_u"], n[4] = row["alpha_v"];
    return b;
}

inline void put_plastic(const CsvRow& row, RowNumbers& n) {
    n[0] = row["diff_r"], n[1] = row["diff_g"], n[2] = row["diff_b"];
    n[3] = n[4] = n[5] = 1;
}

inline Bsdf plastic_of(const CsvRow& row, RowNumbers& n) {
    put_plastic(row, n);
    Plastic b;
    b.eta = eta_of(row), b.nonlinear = row["nonlinear"] == 1;
    return b;
}

inline Bsdf rough_plastic_of(const CsvRow& row, RowNumbers& n) {
    put_plastic(row, n);
    n[3] = row["spec_r"], n[4] = row["spec_g"], n[5] = row["spec_b"];
    RoughPlastic b;
    b.eta = eta_of(row), b.nonlinear = row["nonlinear"] == 1;
    b.shape = shape_of(row), b.alpha = number(row, "alpha");
    static std::map<std::tuple<float, float, FacetShape>, RoughPlastic> known;
    const auto [at, is_new] = known.try_emplace({b.eta, b.alpha, b.shape}, b);
    if (is_new) at->second = make_rough_plastic(b);
    b.transmittance = at->second.transmittance;
    b.internal_reflectance = at->second.internal_reflectance;
    return b;
}

inline Bsdf rough_dielectric_of(const CsvRow& row, RowNumbers& n) {
    RoughDielectric b;
    b.eta = eta_of(row);
    b.roughness.shape = shape_of(row);
    n[0] = row["refl_r"], n[1] = row["refl_g"], n[2] = row["refl_b"];
    n[3] = row["trans_r"], n[4] = row["trans_g"], n[5] = row["trans_b"];
    n[6] = row["alpha"];
    return b;
}

inline Bsdf principled_thin_of(const CsvRow& row, RowNumbers& n) {
    PrincipledThin b;
    b.eta = number(row, "eta");
    n[0] = row["base_r"], n[1] = row["base_g"], n[2] = row["base_b"];
    const char* const scalars[] = {"roughness", "anisotropic", "spec_trans", "spec_tint",
                                   "sheen",     "sheen_tint",  "flatness",   "diff_trans"};
    for (std::size_t k = 0; k < kThinScalars; ++k) n[kBsdfColor + k] = row[scalars[k]];
    return b;
}

using RowBsdf = Bsdf (*)(const CsvRow&, RowNumbers&);

inline std::vector<InterfaceRow> interface_rows(const std::string& table, RowBsdf bsdf_of) {
    std::vector<InterfaceRow> rows;
    // Another set of reference values has the tables of the first kinds alone.
    const bool own = table == "principledthin.csv";
    const std::filesystem::path folder = own ? BURNISH_TEST_DATA : reference_folder();
    for (const CsvRow& row : read_csv(folder / "tables" / table)) {
        InterfaceRow r;
        r.line = row.line;
        r.bsdf = bsdf_of(row, r.numbers);
        const char* const columns[] = {"wi_x", "wi_y", "wi_z", "wo_x", "wo_y", "wo_z"};
        for (std::size_t i = 0; i < 6; ++i) r.numbers[kBsdfInputs + i] = row[columns[i]];
        r.f = {row["f_r"], row["f_g"], row["f_b"]};
        r.pdf = row["pdf"];
        rows.push_back(r);
    }
    return rows;
}

}  // namespace burnish::test
