// Files of images.
#include <nanobind/stl/string.h>

#include "burnish/error.h"
#include "burnish/photograph.h"
#include "image/image.h"
#include "python/arrays.h"
#include "python/bindings.h"
#include "python/work.h"
#include "scenes/procedural.h"

namespace burnish::python {

namespace {

Encoding to_encoding(nb::handle value) {
    if (value.is_none()) return ByFileType{};
    if (nb::isinstance<nb::str>(value)) {
        const std::string name = text_of(value);
        if (name == "linear") return LinearEncoding{};
        if (name == "srgb") return SrgbEncoding{};
    } else if (const auto gamma = as_number(value, "encoding")) {
        if (*gamma > 0 && *gamma <= 10) return GammaEncoding{*gamma};
    }
    throw InputError(std::string("encoding: found ") + repr_of(value) +
                     ", expected None, 'linear', 'srgb' or a gamma above 0, at most 10");
}

nb::tuple read_with_weights(const std::string& path, nb::handle encoding, nb::handle mask,
                            double scale) {
    const Encoding decoded = to_encoding(encoding);
    std::optional<Image> own;
    if (!mask.is_none()) own = to_image(mask, "mask", Meaning::kWeights);
    Photograph p = compute([=](const Flag&) {
        Photograph read = read_photograph(path, decoded);
        if (own) add_mask(*own, read);
        return scaled(std::move(read), scale);
    });
    Image weights = weights_of(p);
    return nb::make_tuple(to_array(std::move(p.image)), to_array(std::move(weights)));
}

void bind_photographs(nb::module_& m) {
    m.def(
        "read_photograph",
        [](nb::object path, nb::object encoding, nb::object mask, double scale) {
            return read_with_weights(to_path(path), encoding, mask, scale);
        },
        nb::arg("path"), nb::arg("encoding") = nb::none(), nb::arg("mask") = nb::none(),
        nb::arg("scale") = 1.0,
        nb::sig("def read_photograph(path: str | os.PathLike[str], encoding: "
                "typing.Literal['linear', 'srgb'] | float | None = None, mask: "
                "numpy.typing.ArrayLike | None = None, scale: float = 1.0) -> "
                "tuple[numpy.typing.NDArray[numpy.float32], numpy.typing.NDArray[numpy.float32] | "
                "None]"),
        "Reads a photograph: its linear image [height, width, 3], and the weights of its pixels "
        "[height, width, 1 or 3], 0\nwhere alpha or the mask is or where it is clipped; None: all "
        "ones.\n\nencoding: 'linear', 'srgb', a gamma; None: by the type of the file. scale: of "
        "its size, in (0, 1].");
}

}  // namespace

void bind_images(nb::module_& m) {
    bind_photographs(m);
    m.def(
        "read_image",
        [](nb::object path) {
            const std::string file = to_path(path);
            return to_array(compute([=](const Flag&) { return read_image(file); }));
        },
        nb::arg("path"),
        nb::sig("def read_image(path: str | os.PathLike[str]) -> "
                "numpy.typing.NDArray[numpy.float32]"),
        "Reads PNG, JPEG, BMP, TGA, EXR, HDR or PFM as linear values [height, width, 1 or 3].");
    m.def(
        "write_image",
        [](nb::object path, nb::object image) {
            const std::string file = to_path(path);
            compute([file, i = to_image(image, "image")](const Flag&) {
                write_image(file, i);
                return true;
            });
        },
        nb::arg("path"), nb::arg("image"),
        nb::sig("def write_image(path: str | os.PathLike[str], image: numpy.typing.ArrayLike) -> "
                "None"),
        "Writes linear values by extension: .exr (32-bit float), .pfm, .png (8 bit, sRGB).");
    m.def(
        "encode_png",
        [](nb::object image) {
            const Image i = to_image(image, "image");
            std::string bytes;
            without_gil([&] { bytes = encode_png(i, i.channels == 3); });
            return nb::bytes(bytes.data(), bytes.size());
        },
        nb::arg("image"), nb::sig("def encode_png(image: numpy.typing.ArrayLike) -> bytes"),
        "The bytes of a PNG file, 8 bit: of three channels sRGB, of one as it is.");
    m.def(
        "write_scene",
        [](const std::string& name, nb::object folder, int texture_size) {
            const std::string path = to_path(folder);
            compute([=](const Flag&) {
                write_procedural_scene(name, path, {.texture_size = texture_size});
                return true;
            });
        },
        nb::arg("name"), nb::arg("folder"), nb::arg("texture_size") = 512,
        nb::sig("def write_scene(name: str, folder: str | os.PathLike[str], texture_size: int = "
                "512) -> None"),
        "Writes a built-in scene, 'goblet', 'tyre', 'bowl' or 'tree', as a folder with a Mitsuba "
        "scene.xml.");
}

}  // namespace burnish::python
