// A scene, ready to be rendered and optimised.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "burnish/image.h"
#include "burnish/view.h"

namespace burnish {

/// Which light a light sample goes to. To add one: here, its name in optimize/option_value.cpp,
/// what it needs to know in paths/light_selection.h, and what the compiler then asks for.
enum class LightSelection {
    kUniform,  ///< every emitter equally often, as Mitsuba does
    kPower,    ///< by luminous power, whatever the position
    kTree,     ///< by the irradiance that it could cause at the position: a light tree
    /// By what a point on each light, or on four of more than eight, would send to the eye if
    /// nothing hid it: resampled importance sampling [RIS].
    kResampled,
};

struct SceneSettings {
    std::map<std::string, std::string> definitions = {};  ///< win over <default> of the scene file
    /// Of the film, at most 32768, where both are positive; else the scene's.
    int width = 0, height = 0;
    LightSelection light_selection = LightSelection::kResampled;
    bool ignore_unsupported = false;  ///< goes on without what is not supported; Renderer::warnings
                                      ///< say what was left out
    /// Constants of materials that become textures of their value, so that they can be recovered:
    /// "mat.metallic" a single texel, "mat.metallic:512" or "mat.metallic:512x256" that many. What
    /// is a bitmap already may be named, too, with no other size than its own.
    std::vector<std::string> constants = {};
};

/// A texture of materials, or a constant that became one.
struct ParameterInfo {
    std::string name = {};  ///< Mitsuba's, e.g. "mat-tire.brdf_0.roughness.data"
    int width = 0, height = 0, channels = 0;
};

/// Textures in the place of the scene's, by the name of their parameter (Mitsuba's or a short
/// form); of the bitmap's size, [height, width, 1 or 3], linear. Any finite texels are rendered, so
/// that finite differences need no margin: beyond [0, 1], or what the parameter may be in a scene,
/// the picture means nothing physically.
using TextureValues = std::map<std::string, Image>;

/// Called from time to time with the share of the work that is done, in [0, 1]; one call at a time,
/// from any thread. It may call Burnish; what it throws ends the work and is thrown.
using Progress = std::function<void(double share)>;

struct RendererData;

/// A handle of a scene with its ray structure and lights. It owns what it needs, never changes, and
/// may be copied and shared by threads.
class Renderer {
  public:
    /// Reads a Mitsuba 3 scene file and all that it names. Throws InputError: a file that is
    /// missing or damaged, or what is not supported, with file:line:column; a definition that the
    /// file does not use; a film that is too large; a constant that is no parameter, is several or
    /// cannot become such a texture. ResourceError: no memory for the ray structure.
    static Renderer load(const std::string& file, const SceneSettings& settings = {});

    /// For the library's own use; not null.
    explicit Renderer(std::shared_ptr<const RendererData> data) : data_(std::move(data)) {}

    /// Of the picture, in pixels; of the film's crop window, where the scene has one.
    int width() const;
    int height() const;
    /// What textures can replace: bitmaps of materials, in the order of the scene, and
    /// SceneSettings::constants. Several names may mean one texture. Those of smooth conductors,
    /// plastics and dielectrics, and those that turn normals, can be replaced but not recovered;
    /// those that are an emitter's, too, neither.
    std::vector<ParameterInfo> parameters() const;
    /// What was left out or assumed when the scene was read, one sentence each.
    const std::vector<std::string>& warnings() const;
    /// The linear texels of a parameter, [height, width, channels]. Throws InputError: no such
    /// parameter, several, or a constant that is no texture.
    Image texture(const std::string& parameter) const;
    /// The picture [height, width, 3], linear RGB radiance. samples_per_pixel: 1 to 2^20. The same
    /// bytes for any number of threads. Throws InputError: no sample, or too many; of `textures`,
    /// what texture() throws, two names of one texture, one that an emitter reads, too, texels that
    /// are not as TextureValues says, or one that is not finite. Contributions that are not
    /// finite are left out; where they are more than one for 1000 samples, or the picture is not
    /// finite, values are too large: InputError, too.
    Image render(std::uint32_t samples_per_pixel, std::uint32_t seed = 0,
                 const TextureValues& textures = {}, const Progress& progress = {}) const;

    /// The same scene through another camera, or under other lights: geometry and textures are
    /// shared. A camera that is no sensor of the scene takes its filter and clipping planes from
    /// the first one. Throws InputError: no such sensor, a size that is out of range or of another
    /// aspect ratio, numbers out of range, a matrix that is no rotation and translation, or a lens
    /// that shows nothing.
    Renderer with_camera(const ViewCamera& camera) const;
    /// Throws InputError: no such emitter; an environment without an image where the scene has no
    /// environment map; an image, a scale or a matrix that is not as Environment says.
    Renderer with_lighting(const Lighting& lighting) const;

    /// For the library's own use.
    const RendererData& data() const { return *data_; }

  private:
    std::shared_ptr<const RendererData> data_;
};

}  // namespace burnish
