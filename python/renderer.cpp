// The renderer: pictures, textures and gradients of a scene.
#include "burnish/renderer.h"

#include <fmt/format.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/variant.h>
#include <nanobind/stl/vector.h>

#include <algorithm>

#include "burnish/error.h"
#include "burnish/gradient.h"
#include "core/count_of.h"
#include "gradient/theta.h"
#include "image/image.h"
#include "optimize/option_value.h"
#include "python/arrays.h"
#include "python/bindings.h"
#include "python/work.h"
#include "render/renderer.h"

namespace burnish::python {

namespace {

/// The textures of a renderer by name; each is read when it is asked for.
struct Parameters {
    Renderer renderer;
    std::vector<ParameterInfo> infos;
};

nb::list names_of(const Parameters& p) {
    nb::list names;
    for (const ParameterInfo& info : p.infos) names.append(info.name);
    return names;
}

/// Throws InputError: there is none, or the name is no text.
nb::object texture_named(const Parameters& p, nb::handle name) {
    if (!nb::isinstance<nb::str>(name))
        throw InputError("found " + repr_of(name) + ", expected the name of a texture");
    return to_array(p.renderer.texture(text_of(name)));
}

nb::object texture_of(const Parameters& p, nb::object name) {
    try {
        return texture_named(p, name);
    } catch (const InputError& e) {
        throw nb::key_error(e.what());
    }
}

nb::object texture_or(const Parameters& p, nb::object name, nb::object other) {
    try {
        return texture_named(p, name);
    } catch (const InputError&) {
        return other;
    }
}

/// What `type` of collections.abc shows of a mapping, as that module's Mapping does.
auto shown_as(const char* type) {
    return [type](nb::handle self) -> nb::object {
        return nb::module_::import_("collections.abc").attr(type)(self);
    };
}

nb::tuple shape_of(const ParameterInfo& i) { return nb::make_tuple(i.height, i.width, i.channels); }

nb::dict shapes_of(const Parameters& p) {
    nb::dict shapes;
    for (const ParameterInfo& i : p.infos) shapes[i.name.c_str()] = shape_of(i);
    return shapes;
}

std::string name_of_texture(const Parameters& p, nb::object name) {
    const Scene& scene = p.renderer.data().scene();
    const TextureId id = find_texture(scene, text_of(name));
    return std::ranges::find(scene.parameters, id, &Parameter::texture)->name;
}

void bind_parameters(nb::module_& m) {
    nb::class_<Parameters>(m, "Parameters",
                           "The textures of a scene by the name of their parameter: a mapping of "
                           "names to arrays [height, width, channels].\nIt takes Mitsuba's names "
                           "and any short form that means one texture.",
                           nb::sig("class Parameters(collections.abc.Mapping[str, "
                                   "numpy.typing.NDArray[numpy.float32]])"))
        .def("__getitem__", texture_of, nb::arg("name").none(),
             nb::sig("def __getitem__(self, name: str, /) -> numpy.typing.NDArray[numpy.float32]"))
        .def("__len__", [](const Parameters& p) { return p.infos.size(); })
        .def(
            "__iter__", [](const Parameters& p) { return nb::iter(names_of(p)); },
            nb::sig("def __iter__(self) -> collections.abc.Iterator[str]"))
        .def(
            "__contains__",
            [](const Parameters& p, nb::object name) {
                if (!nb::isinstance<nb::str>(name)) return false;
                try {
                    texture_info(p.renderer, text_of(name));
                    return true;
                } catch (const InputError&) {
                    return false;
                }
            },
            nb::arg("name").none(), nb::sig("def __contains__(self, name: object, /) -> bool"))
        .def("keys", shown_as("KeysView"),
             nb::sig("def keys(self) -> collections.abc.KeysView[str]"))
        .def("values", shown_as("ValuesView"),
             nb::sig("def values(self) -> "
                     "collections.abc.ValuesView[numpy.typing.NDArray[numpy.float32]]"))
        .def("get", texture_or, nb::arg("name").none(), nb::arg("default") = nb::none(),
             nb::sig("def get(self, name: str, /, default: object = None) -> "
                     "typing.Any"))
        .def("items", shown_as("ItemsView"),
             nb::sig("def items(self) -> "
                     "collections.abc.ItemsView[str, numpy.typing.NDArray[numpy.float32]]"))
        .def_prop_ro("shapes", shapes_of,
                     nb::sig("def shapes(self) -> dict[str, tuple[int, int, int]]"),
                     "(height, width, channels) of each.")
        .def(
            "shape",
            [](const Parameters& p, nb::object name) {
                return shape_of(texture_info(p.renderer, text_of(name)));
            },
            nb::arg("name"), nb::sig("def shape(self, name: str) -> tuple[int, int, int]"),
            "That of one, by any form of its name; no texel is read. Throws InputError: there is "
            "none, or several.")
        .def("name", name_of_texture, nb::arg("name"), nb::sig("def name(self, name: str) -> str"),
             "The first whole name of a texture, by any form of its name. Throws InputError: there "
             "is none, there are several, or it is a constant.")
        .def("__repr__", [](const Parameters& p) {
            return std::string("Parameters(") + repr_of(shapes_of(p)) + ")";
        });
}

std::string definition_of(nb::handle value) {
    if (const auto truth = as_bool(value)) return *truth ? "true" : "false";
    return text_of(value);
}

SceneSettings settings_of(const std::optional<std::pair<int, int>>& size,
                          const std::string& light_selection,
                          const std::vector<std::string>& constants, nb::handle definitions,
                          const nb::kwargs& defines) {
    SceneSettings settings;
    if (size && (std::min(size->first, size->second) < 1 ||
                 std::max(size->first, size->second) > kMaxImageSide))
        throw InputError(
            fmt::format("size: found {} x {}, expected a width and a height from 1 to {}",
                        size->first, size->second, kMaxImageSide));
    if (size) settings.width = size->first, settings.height = size->second;
    constexpr OptionInfo kInfo{.name = "light_selection", .sentence = ""};
    if (const auto wrong = from_text(kInfo, light_selection, settings.light_selection);
        !wrong.empty())
        throw InputError("light_selection: " + wrong);
    settings.constants = constants;
    if (!definitions.is_none() && !nb::hasattr(definitions, "items"))
        throw type_error("definitions: expected a mapping of names to values, found " +
                         type_of(definitions));
    if (!definitions.is_none())
        for (const nb::handle item : definitions.attr("items")())
            settings.definitions[text_of(nb::object(item[0]))] = definition_of(item[1]);
    for (const auto& [name, value] : defines)
        settings.definitions[text_of(name)] = definition_of(value);
    return settings;
}

Renderer load(nb::handle path, const std::optional<std::pair<int, int>>& size,
              const std::string& light_selection, const std::vector<std::string>& constants,
              bool ignore_unsupported, nb::handle definitions, const nb::kwargs& defines) {
    SceneSettings settings = settings_of(size, light_selection, constants, definitions, defines);
    settings.ignore_unsupported = ignore_unsupported;
    return compute(
        [file = to_path(path), settings](const Flag&) { return Renderer::load(file, settings); });
}

nb::object render(const Renderer& renderer, nb::handle textures, nb::handle spp, nb::handle seed) {
    const std::uint32_t samples = to_count(spp, "spp", 1, kMaxSamplesPerPixel),
                        number = to_count(seed, "seed", 0);
    return to_array(compute([renderer, samples, number,
                             values = to_textures(textures, renderer)](const Flag& is_abandoned) {
        return renderer.render(samples, number, values, progress_of(is_abandoned));
    }));
}

/// Each texture by its first name.
std::vector<std::string> names_to_recover(const Scene& scene) {
    std::vector<std::string> names;
    std::vector<TextureId> textures;
    for (const Parameter& p : scene.parameters) {
        if (std::ranges::count(textures, p.texture) > 0 || !can_be_recovered(scene, p.texture))
            continue;
        names.push_back(p.name);
        textures.push_back(p.texture);
    }
    if (names.empty()) throw InputError("the scene has no texture that can be recovered");
    return names;
}

std::vector<std::string> names_to_differentiate(const Renderer& renderer, nb::handle names) {
    if (names.is_none()) return names_to_recover(renderer.data().scene());
    std::vector<std::string> all;
    if (nb::isinstance<nb::str>(names))
        all.push_back(text_of(names));
    else if (nb::hasattr(names, "items"))  // its values would be lost
        throw type_error("parameters: found " + type_of(names) +
                         ", expected names of parameters; values are those of textures={...}");
    else if (!nb::hasattr(names, "__iter__"))
        throw type_error("parameters: expected names of parameters, found " + repr_of(names));
    else
        for (const nb::handle name : names) {
            if (!nb::isinstance<nb::str>(name))
                throw type_error("parameters: expected names of parameters, found " +
                                 repr_of(name) + " among them");
            all.push_back(text_of(name));
        }
    return all;
}

nb::dict gradient(const Renderer& renderer, nb::handle adjoint, nb::handle parameters,
                  nb::handle textures, nb::handle spp, nb::handle seed) {
    const std::vector<std::string> names = names_to_differentiate(renderer, parameters);
    GradientOptions options{to_count(spp, "spp", 1), to_count(seed, "seed", 0),
                            to_textures(textures, renderer)};
    std::vector<Image> gradients =
        compute([renderer, names, image = to_image(adjoint, "the adjoint", Meaning::kColours),
                 options = std::move(options)](const Flag& is_abandoned) {
            return estimate_gradient(renderer, names, image, options, progress_of(is_abandoned));
        });
    nb::dict result;
    for (std::size_t i = 0; i < names.size(); ++i)
        result[names[i].c_str()] = to_array(std::move(gradients[i]));
    return result;
}

nb::list warnings_of(const Renderer& renderer) {
    nb::list all;
    for (const std::string& warning : renderer.warnings()) all.append(to_text(warning));
    return all;
}

void bind_work(nb::class_<Renderer>& c) {
    c.def("render", render, nb::arg("textures") = nb::none(), nb::arg("spp") = 64,
          nb::arg("seed") = 0,
          nb::sig("def render(self, textures: Parameters | collections.abc.Mapping[str, "
                  "numpy.typing.ArrayLike] | None = None, spp: int = 64, seed: int = 0) -> "
                  "numpy.typing.NDArray[numpy.float32]"),
          "The picture [height, width, 3], linear RGB radiance, of spp samples per pixel. "
          "textures: in the place of the\nscene's, {name: array}, or {name: number} for all "
          "texels; those of two names of one texture are the same. The same\nbytes for any number "
          "of threads. Throws InputError where more than one contribution for 1000 samples, or "
          "the picture, is not finite.");
    c.def("gradient", gradient, nb::arg("adjoint"), nb::arg("parameters") = nb::none(),
          nb::arg("textures") = nb::none(), nb::arg("spp") = 64, nb::arg("seed") = 0,
          nb::sig("def gradient(self, adjoint: numpy.typing.ArrayLike, parameters: str | "
                  "collections.abc.Iterable[str] | None = None, textures: Parameters | "
                  "collections.abc.Mapping[str, numpy.typing.ArrayLike] | None = None, spp: int = "
                  "64, seed: int = 0) -> dict[str, numpy.typing.NDArray[numpy.float32]]"),
          "dL/d(texture) of each parameter, {name: [height, width, channels]}, for a loss L with "
          "the adjoint dL/dI\n[height, width, 3]. parameters: names; None: all that can be "
          "recovered, each texture once.\nUnbiased for this adjoint, from samples that are "
          "independent of those of "
          "render with the same seed.");
}

}  // namespace

void bind_renderer(nb::module_& m) {
    bind_parameters(m);
    nb::class_<Renderer> c(m, "Renderer",
                           "A scene, ready to be rendered and optimised. It never changes, and may "
                           "be shared by threads.");
    c.def_prop_ro("width", &Renderer::width, "Of the picture, in pixels.");
    c.def_prop_ro("height", &Renderer::height, "Of the picture, in pixels.");
    c.def_prop_ro(
        "parameters",
        [](const Renderer& r) {
            return Parameters{r, r.parameters()};
        },
        "The textures that others can replace, by name. Those of smooth conductors, plastics and "
        "dielectrics, and those that\nturn normals, cannot be recovered; those that are an "
        "emitter's, too, can neither be recovered nor replaced.");
    c.def_prop_ro("warnings", warnings_of, nb::sig("def warnings(self) -> list[str]"),
                  "What was left out or assumed when the scene was read, one sentence each.");
    bind_work(c);
    c.def("with_camera", &Renderer::with_camera, nb::arg("camera"),
          nb::call_guard<nb::gil_scoped_release>(),
          nb::sig("def with_camera(self, camera: Sensor | Camera) -> Renderer"),
          "The same scene through another camera.");
    c.def(
        "with_lighting",
        [](const Renderer& renderer, const Lighting& lighting) {
            return compute([=](const Flag&) { return renderer.with_lighting(lighting); });
        },
        nb::arg("lighting"), "The same scene under other lights.");
    c.def(
        "__copy__", [](nb::handle self) { return nb::borrow(self); },
        nb::sig("def __copy__(self) -> Renderer"));
    c.def(
        "__deepcopy__", [](nb::handle self, nb::handle) { return nb::borrow(self); },
        nb::arg("memo"), nb::sig("def __deepcopy__(self, memo: object) -> Renderer"));
    c.def("__repr__", [](const Renderer& r) {
        return fmt::format("Renderer({} x {} pixels, {})", r.width(), r.height(),
                           count_of(r.parameters().size(), "parameter"));
    });
    m.def("load", load, nb::arg("path"), nb::kw_only(), nb::arg("size") = nb::none(),
          nb::arg("light_selection") = "resampled",
          nb::arg("constants") = std::vector<std::string>{}, nb::arg("ignore_unsupported") = false,
          nb::arg("definitions") = nb::none(), nb::arg("defines"),
          nb::sig("def load(path: str | os.PathLike[str], *, size: tuple[int, int] | None = None, "
                  "light_selection: typing.Literal['resampled', 'uniform', 'power', 'tree'] = "
                  "'resampled', "
                  "constants: collections.abc.Sequence[str] = [], ignore_unsupported: bool = "
                  "False, definitions: "
                  "collections.abc.Mapping[str, object] | None = None, **defines: object) -> "
                  "Renderer"),
          "Reads a Mitsuba 3 scene file and all that it names.\n\nsize: width and height of the "
          "film; None: the scene's. constants: constants of materials that become textures, so\n"
          "that they can be recovered: 'mat.metallic' a single texel, 'mat.metallic:512' or "
          "'mat.metallic:512x256' that many.\nignore_unsupported: goes on without what is not "
          "supported; Renderer.warnings say what was left out.\ndefines, definitions: values for "
          "$names of the scene file, as keyword arguments or as a dictionary.");
}

}  // namespace burnish::python
