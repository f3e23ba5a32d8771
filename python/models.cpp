// Files for other programs.
#include "burnish/renderer.h"
#include "image/files.h"
#include "models/model_glb.h"
#include "python/bindings.h"
#include "python/work.h"
#include "render/renderer.h"

namespace burnish::python {

namespace {

void write_model(nb::handle path, const Renderer& renderer, nb::handle textures) {
    compute(
        [renderer, file = to_path(path), values = to_textures(textures, renderer)](const Flag&) {
            const Scene& scene = renderer.data().scene();
            write_bytes(file, model_glb(scene, replace_textures(scene, values).table));
            return true;
        });
}

}  // namespace

void bind_models(nb::module_& m) {
    m.def(
        "write_model", write_model, nb::arg("path"), nb::arg("renderer"),
        nb::arg("textures") = nb::none(),
        nb::sig("def write_model(path: str | os.PathLike[str], renderer: Renderer, textures: "
                "Parameters | collections.abc.Mapping[str, numpy.typing.ArrayLike] | None = None) "
                "-> None"),
        "Writes the scene as binary glTF 2.0 (.glb): its shapes in world space, their materials, "
        "its cameras.\ntextures: in the place of the scene's, as for render; a Summary's are "
        "those that were recovered.");
}

}  // namespace burnish::python
