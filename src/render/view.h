// Views of a scene: through other cameras, under other lights.
#pragma once

#include <string>
#include <vector>

#include "burnish/view.h"
#include "paths/traced_scene.h"

namespace burnish {

/// The same lights through another camera. Throws InputError: no such sensor, or numbers out of
/// range.
TracedScene through(const TracedScene& view, const ViewCamera& camera);

/// The same camera under other lights. Throws InputError: no such emitter, no environment to
/// change, or numbers out of range.
TracedScene under(const TracedScene& view, const Lighting& lighting);

/// Throws InputError where a camera is none that a scene can be seen through, whatever its lens.
void check_camera(const Camera& camera);

/// Throws InputError where the scene has no emitter of one of the ids.
void require_emitters(const Scene& scene, const std::vector<std::string>& ids);

/// Throws InputError where a picture has not the aspect ratio of a film, or of its crop window: to
/// less than a pixel. cut: as many rows less are allowed; scaling leaves out one.
void require_aspect(const Film& film, int width, int height, int cut = 0);

}  // namespace burnish
