#include "paths/light_columns.h"

#include <optional>
#include <span>

#include "core/constants.h"

namespace burnish {

namespace {

/// The lanes by the kind of light that they chose.
struct Chosen {
    ActiveList mesh, environment, constant;
    std::array<const TriangleRecord*, kMaxLanes> triangle;  ///< of mesh lanes
    Column area;                                            ///< of mesh lanes
    Column rest;                 ///< of environment lanes: what the choice left of u[0]
    Column inverse_probability;  ///< LightChoice::inverse_probability
};

void put(const LightSample& s, std::size_t i, LightColumns& out) {
    set(out.direction_world, i, s.direction_world);
    set(out.radiance, i, s.radiance);
    out.distance[i] = s.distance, out.pdf[i] = s.pdf, out.delta[i] = s.delta ? 1.0f : 0.0f;
}

/// Puts a lane to those of its kind, or samples at once.
void put(const Lights& lights, const LightChoice& choice, const ColumnVec3& position, std::size_t i,
         Chosen& chosen, LightColumns& out) {
    const Lights::Light& light = lights.lights[choice.emitter];
    chosen.inverse_probability[i] = choice.inverse_probability;
    switch (light.kind) {
        case Lights::Kind::kMesh:
            chosen.mesh.add(i);
            chosen.triangle[i] = &light.triangles[choice.triangle];
            chosen.area[i] = light.area;
            set(out.radiance, i, light.radiance);
            break;
        case Lights::Kind::kEnvironment:
            chosen.environment.add(i);
            chosen.rest[i] = choice.u[0];
            break;
        case Lights::Kind::kConstant:
            chosen.constant.add(i);
            set(out.radiance, i, light.radiance);
            break;
        case Lights::Kind::kSingle:
            put(sample_light(lights, choice, get(position, i)), i, out);
            break;
    }
}

std::array<float, 4> uniforms(const std::array<Column, 4>& u, std::size_t i) {
    return {u[0][i], u[1][i], u[2][i], u[3][i]};
}

/// Lanes that have selected their emitters.
void choose(const Lights& lights, const std::array<Column, 4>& u, const ColumnVec3& position,
            const ColumnIndices& lanes, const std::array<SelectedEmitter, kLanes>& selected,
            Chosen& chosen, LightColumns& out) {
    const auto live = static_cast<std::size_t>(lanes.live);
    for (std::size_t k = 0; k < live; ++k) prefetch(lights, selected[k], uniforms(u, lanes.at[k]));
    for (std::size_t k = 0; k < live; ++k) {
        const std::size_t i = lanes.at[k];
        put(lights, choose_light(lights, selected[k], uniforms(u, i)), position, i, chosen, out);
    }
}

/// Where all lanes take emitter `only`, each with the whole of u[0].
void choose_only(const Lights& lights, std::uint32_t only, const std::array<Column, 4>& u,
                 const ColumnVec3& position, const ActiveList& wanted, Chosen& chosen,
                 LightColumns& out) {
    const Lights::Light& light = lights.lights[only];
    const std::span<const std::uint16_t> lanes(wanted.lane.data(), wanted.count);
    if (light.kind == Lights::Kind::kSingle) {
        for (const std::size_t i : lanes) {
            const SelectedEmitter selected{only, 1, u[0][i]};
            const LightChoice choice = choose_light(lights, selected, uniforms(u, i));
            put(sample_light(lights, choice, get(position, i)), i, out);
        }
        return;
    }
    for (const std::size_t i : lanes) chosen.inverse_probability[i] = 1;
    if (light.kind == Lights::Kind::kEnvironment) {
        chosen.environment = wanted;
        for (const std::size_t i : lanes) chosen.rest[i] = u[0][i];
        return;
    }
    for (const std::size_t i : lanes) set(out.radiance, i, light.radiance);
    if (light.kind == Lights::Kind::kConstant) {
        chosen.constant = wanted;
        return;
    }
    chosen.mesh = wanted;
    const auto of_triangle = [&](std::size_t i) { return triangle_uniform(u[1][i], u[0][i]); };
    for (const std::size_t i : lanes)
        __builtin_prefetch(&light.by_area.columns[alias_column(light.by_area, of_triangle(i))]);
    for (const std::size_t i : lanes) {
        const std::uint32_t triangle = sample_alias_table(light.by_area, of_triangle(i)).index;
        chosen.triangle[i] = &light.triangles[triangle];
        prefetch(light.triangles[triangle]);
        chosen.area[i] = light.area;
    }
}

/// The emitter that all lanes take, with the whole of u[0]: a lone one, or the one of a candidate.
std::optional<std::uint32_t> only_emitter(const LightSelector& selector, std::uint32_t candidate) {
    if (selector.emitters == 1) return 0;
    if (has_candidate_of_each(selector)) return candidate;
    return {};
}

void choose(const Lights& lights, const std::array<Column, 4>& u, const ColumnVec3& position,
            const ActiveList& wanted, std::uint32_t candidate, Chosen& chosen, LightColumns& out) {
    if (wanted.count == 0) return;
    if (const auto only = only_emitter(lights.selector, candidate))
        return choose_only(lights, *only, u, position, wanted, chosen, out);
    for (std::size_t first = 0; first < wanted.count; first += kLanes) {
        const ColumnIndices lanes = indices(wanted, first);
        const auto selected = select_emitters(
            lights.selector, gather(position, lanes),
            {gather(u[0], lanes), gather(u[1], lanes), gather(u[2], lanes), gather(u[3], lanes)},
            candidate);
        choose(lights, u, position, lanes, selected, chosen, out);
    }
}

void sample_meshes(const Chosen& chosen, const std::array<Column, 4>& u, const ColumnVec3& position,
                   LightColumns& out) {
    for (std::size_t k = 0; k < chosen.mesh.count; k += kLanes) {
        const ColumnIndices i = indices(chosen.mesh, k);
        std::array<const TriangleRecord*, kLanes> records;
        for (std::size_t j = 0; j < kLanes; ++j) records[j] = chosen.triangle[i.at[j]];
        const auto point = sample_triangle(gather(records), gather(u[2], i), gather(u[3], i));
        const auto s =
            from_point(point, Packet(1.0f) / gather(chosen.area, i), gather(position, i));
        scatter(out.direction_world, i, s.direction_world);
        scatter(out.distance, i, s.distance);
        scatter(out.pdf, i, s.pdf / gather(chosen.inverse_probability, i));
    }
}

void sample_infinite(const Lights& lights, const Chosen& chosen, const std::array<Column, 4>& u,
                     LightColumns& out) {
    for (std::size_t k = 0; k < chosen.environment.count; k += kLanes) {
        const ColumnIndices i = indices(chosen.environment, k);
        const auto s = sample_environment<Packet>(
            *lights.environment,
            {gather(chosen.rest, i), gather(u[1], i), gather(u[2], i), gather(u[3], i)});
        scatter(out.direction_world, i, s.direction_world);
        scatter(out.radiance, i, s.radiance);
        scatter(out.pdf, i, s.pdf / gather(chosen.inverse_probability, i));
        scatter(out.distance, i, Packet(kInfinity));
    }
    for (std::size_t k = 0; k < chosen.constant.count; k += kLanes) {
        const ColumnIndices i = indices(chosen.constant, k);
        scatter(out.direction_world, i, uniform_direction(gather(u[1], i), gather(u[2], i)));
        scatter(out.pdf, i, Packet(1 / (4 * kPi)) / gather(chosen.inverse_probability, i));
        scatter(out.distance, i, Packet(kInfinity));
    }
}

}  // namespace

void sample_lights(const Lights& lights, const std::array<Column, 4>& u, const ColumnVec3& position,
                   const ActiveList& wanted, std::size_t count, std::uint32_t candidate,
                   LightColumns& out) {
    for (std::size_t i = 0; i < count; i += kLanes) {
        store(out.pdf, i, 0.0f), store(out.delta, i, 0.0f), store(out.distance, i, 1.0f);
        store(out.direction_world, i, {0.0f, 0.0f, 1.0f});
        store(out.radiance, i, {});
    }
    Chosen chosen;
    choose(lights, u, position, wanted, candidate, chosen, out);
    sample_meshes(chosen, u, position, out);
    sample_infinite(lights, chosen, u, out);
}

void emission_at_infinity(const Lights& lights, const ColumnVec3& origin,
                          const ColumnVec3& direction_world, const ActiveList& list,
                          ColumnVec3& radiance, Column& pdf) {
    for (std::size_t k = 0; k < list.count; k += kLanes) {
        const ColumnIndices i = indices(list, k);
        const auto e = emission_at_infinity(lights, gather(origin, i), gather(direction_world, i));
        scatter(radiance, i, e.radiance);
        scatter(pdf, i, e.pdf);
    }
}

}  // namespace burnish
