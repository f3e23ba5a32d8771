// A scene folder to begin with: a mesh under a sky, with textures to recover.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "burnish/view.h"

namespace burnish {

enum class UpAxis { kY, kZ };

struct NewScene {
    std::filesystem::path mesh;  ///< .obj, .ply or .glb
    /// Radiance, longitude and latitude; empty: 1 from everywhere.
    std::filesystem::path environment;
    int texture_size = 1024;           ///< on a side
    UpAxis up = UpAxis::kY;            ///< of the mesh; the sky is turned along
    std::vector<Camera> cameras = {};  ///< of pictures; empty: one is made up
};

/// Throws InputError where a scene file cannot have the camera, without its lens.
void require_scene_camera(const Camera& camera);

/// What was found and made.
struct NewSceneReport {
    std::string material;  ///< "mat-model": its textures are base_color and roughness
    std::size_t triangles = 0, charts = 0;
    double used_share = 0;              ///< of the texels that the mesh reads
    std::vector<std::string> warnings;  ///< what is wrong with the mesh, one sentence each
    std::vector<std::string> camera_warnings = {};  ///< the same of the cameras
    std::vector<std::string> notes = {};            ///< what of the sky was not read
};

/// Writes scene.xml, meshes/, textures/ and environment/ to a folder that does not exist or is
/// empty, scene.xml last: a folder that has it is whole, and a failure leaves nothing. The material
/// is principled: base colour and roughness are textures of 0.5; it is twosided where the mesh is
/// not closed, or its file says so. The camera is the first one, without its lens; or it looks at
/// the whole mesh from the front, a little from above. Its clipping planes leave the mesh whole,
/// seen by any of the cameras, of which the first is one that a scene file can have. Throws
/// InputError: files that cannot be read, a mesh without texture coordinates; OutputError: a folder
/// that holds anything or cannot be written.
NewSceneReport write_new_scene(const NewScene& scene, const std::filesystem::path& folder);

}  // namespace burnish
