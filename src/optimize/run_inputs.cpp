#include "optimize/run_inputs.h"

#include <fmt/ranges.h>

#include <algorithm>

#include "burnish/error.h"
#include "optimize/input_hash.h"
#include "optimize/option_table.h"
#include "optimize/ranks.h"
#include "optimize/scene_inputs.h"
#include "optimize/state_fields.h"
#include "optimize/views.h"

namespace burnish {

void fields(auto& archive, Is<SearchStart> auto&) { archive(); }
void fields(auto& archive, Is<FitExposure> auto& v) { archive(v.by_channel); }
void fields(auto& archive, Is<Sensor> auto& v) { archive(v.name, v.width, v.height); }
void fields(auto& archive, Is<Lens> auto& v) { archive(v.kind, v.coefficients); }
void fields(auto& archive, Is<Camera> auto& v) {
    archive(v.width, v.height, v.focal_x, v.focal_y, v.center_x, v.center_y, v.camera_to_world,
            v.lens);
}
void fields(auto& archive, Is<Environment> auto& v) {
    static const Image none;
    archive(v.image ? *v.image : none, v.scale, v.to_world);
}
void fields(auto& archive, Is<Lighting> auto& v) { archive(v.emitters, v.environment); }

namespace {

template <class... T>
Input input(std::string name, const T&... values) {
    return hashed_input(std::move(name), [&](ArchiveWriter& archive) { archive(values...); });
}

}  // namespace

bool may_change(const std::string& option) {
    return option.starts_with("stop.") || option == "evaluation_samples";
}

std::vector<Input> inputs_of(const Setup& setup) {
    std::vector<Input> inputs;
    for (const OptionRow& row : option_table())
        if (has_effect(row, setup.options) && !may_change(row.info.name))
            inputs.push_back(
                input(std::string("the option ") + row.info.name, get_option(row, setup.options)));
    const Problem& problem = setup.problem;
    for (Input& i : inputs_of(problem.renderer.data())) inputs.push_back(std::move(i));
    if (problem.loss) inputs.push_back(input("the loss, which is one's own"));
    for (std::size_t i = 0; i < problem.views.size(); ++i) {
        const View& v = problem.views[i];
        const std::string of = " of " + name_of(v, i);
        inputs.push_back(input("the image" + of, v.image));
        inputs.push_back(input("the mask" + of, v.mask));
        inputs.push_back(input("the camera" + of, v.camera));
        inputs.push_back(input("the light" + of, v.lighting));
        inputs.push_back(input("the exposure" + of, v.exposure));
        inputs.push_back(input("the part" + of, v.held_out));
    }
    for (std::size_t i = 0; i < problem.unknowns.size(); ++i) {
        const Unknown& u = problem.unknowns[i];
        const std::string start = "the start of " + u.name;
        const UnknownTexture& texture = setup.unknowns[i];
        inputs.push_back(texture.start_kind == StartKind::kGiven
                             ? input(start, texture.start, u.learning_rate)
                             : input(start, u.start, u.learning_rate));
    }
    return inputs;
}

namespace {

std::vector<std::string> changed_inputs(const std::vector<Input>& expected,
                                        const std::vector<Input>& found) {
    std::vector<std::string> changed;
    const auto note = [&](const std::vector<Input>& those, const std::vector<Input>& others) {
        for (const Input& i : those)
            if (std::find(others.begin(), others.end(), i) == others.end() &&
                std::find(changed.begin(), changed.end(), i.name) == changed.end())
                changed.push_back(i.name);
    };
    note(expected, found), note(found, expected);
    if (changed.empty() && expected != found) changed.push_back("the order of views or textures");
    return changed;
}

}  // namespace

void require_same_inputs(const std::vector<Input>& expected, const std::vector<Input>& found) {
    const std::vector<std::string> changed = changed_inputs(expected, found);
    if (!changed.empty())
        throw ChangedRun(fmt::format("the run cannot go on as it was: changed since it began: {}",
                                     fmt::join(changed, ", ")));
}

void require_one_problem(const Setup& setup, const State::Values* from) {
    const Ranks& ranks = setup.problem.ranks;
    if (ranks.count == 1) return;
    std::vector<Input> own = inputs_of(setup);
    for (const OptionRow& row : option_table())  // they decide on the exchanges
        if (may_change(row.info.name))
            own.push_back(
                input(std::string("the option ") + row.info.name, get_option(row, setup.options)));
    if (from)
        own.push_back(input(fmt::format("the state after {} iterations", from->iteration),
                            from->iteration, from->theta));
    std::string bytes;
    ArchiveWriter{sink_into(bytes)}(own);
    bytes = from_first(ranks, bytes);
    std::vector<Input> expected;
    ArchiveReader reader = reader_of(bytes);
    reader(expected);
    const std::vector<std::string> changed = changed_inputs(expected, own);
    const std::vector<std::string> all =
        all_gather(ranks, fmt::format("{}", fmt::join(changed, ", ")));
    for (std::size_t r = 0; r < all.size(); ++r)
        if (!all[r].empty())
            throw InputError(fmt::format(
                "process {} has another problem than process 0, expected the same: {}", r, all[r]));
}

}  // namespace burnish
