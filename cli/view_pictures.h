// The pictures of a run's views: read, made smaller, and what was found in them.
#pragma once

#include <string>
#include <vector>

#include "burnish/photograph.h"
#include "burnish/renderer.h"
#include "captures/capture.h"
#include "cli/settings.h"

namespace burnish {

/// The pictures with the masks of their files, at the run's scale, parallel to the views; of those
/// that are rendered the mask alone. Throws InputError.
std::vector<Photograph> read_pictures(const RunSettings& run,
                                      const std::vector<CapturedView>& views);

/// The camera of a view for its picture, at the run's scale. Throws InputError where the picture
/// does not fit the film of a sensor.
ViewCamera camera_for(const RunSettings& run, const CapturedView& view,
                      const Photograph& photograph, const Renderer& renderer);

/// What optimize would refuse or could not fit in the pictures, masks and lights of views, a
/// sentence for each view of which there is something to say. Reads the pictures, with progress.
std::vector<std::string> view_complaints(const Renderer& renderer,
                                         const std::vector<CapturedView>& views);

/// How a file was read: "JPEG, 8 bits, sRGB, turned (EXIF orientation 6), 12 pixels clipped and
/// left out".
std::string decoding_text(const Photograph& photograph);
/// "linear", "sRGB" or "gamma 2.2".
std::string encoding_text(const Encoding& encoding);

/// What looks wrong in the pictures, and what they cannot tell, a sentence each.
/// has_unknown_color: a texture that is recovered is a colour.
std::vector<std::string> picture_warnings(const std::vector<CapturedView>& views,
                                          const std::vector<Photograph>& photographs,
                                          bool has_unknown_color);

}  // namespace burnish
