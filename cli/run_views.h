// The views of a run: from a capture, from other programs' cameras, from pairs of --sensor and
// --target, or the scene's camera.
#pragma once

#include <optional>
#include <vector>

#include "burnish/renderer.h"
#include "captures/capture.h"
#include "cli/scene_input.h"
#include "cli/settings.h"

namespace burnish {

/// The scene that a capture is of, in the place of the capture; its definitions where the command
/// line gives none of the name.
void use_capture(const Capture& capture, SceneOptions& scene);

/// Throws UsageError where options do not fit the capture, or each other, and InputError.
std::vector<CapturedView> views_of(const RunSettings& run, const std::optional<Capture>& capture);

/// Gives the views the cameras of their pictures' sizes. photographs: of the views. Throws
/// InputError.
void size_cameras(const RunSettings& run, const Renderer& renderer,
                  const std::vector<Photograph>& photographs, std::vector<CapturedView>& views);

/// What make_views makes of a problem with these views, at their places.
std::vector<Renderer> make_captured_views(const Problem& problem,
                                          const std::vector<CapturedView>& views);

/// The views with their pictures and masks, those that were read, which it takes, or rendered.
/// renderers, photographs: of the views. Throws InputError.
std::vector<View> with_pictures(const Settings& settings, const std::vector<CapturedView>& views,
                                const std::vector<Renderer>& renderers,
                                std::vector<Photograph>& photographs);

}  // namespace burnish
