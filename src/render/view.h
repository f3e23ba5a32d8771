// Views of a scene: through other cameras, under other lights.
#pragma once

#include "burnish/view.h"
#include "paths/traced_scene.h"

namespace burnish {

/// The same lights through another camera. Throws InputError: no such sensor, or numbers out of
/// range.
TracedScene through(const TracedScene& view, const ViewCamera& camera);

/// The same camera under other lights. Throws InputError: no such emitter, no environment to
/// change, or numbers out of range.
TracedScene under(const TracedScene& view, const Lighting& lighting);

}  // namespace burnish
