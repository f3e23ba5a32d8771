// The pictures of a run's views: read, made smaller, and what was found in them.
#pragma once

#include <string>
#include <vector>

#include "burnish/photograph.h"
#include "burnish/renderer.h"
#include "captures/pictures.h"
#include "cli/settings.h"

namespace burnish {

/// Parallel to the views.
struct Pictures {
    std::vector<Photograph> photographs;  ///< type empty: the picture is rendered
    std::vector<MaskFile> masks;          ///< how their files were read, without the weights
};

/// The pictures with the masks of their files, at the run's scale; of those that are rendered the
/// mask and its file's size alone. at_once: as many at a time at most. Throws InputError.
Pictures read_pictures(const RunSettings& run, const std::vector<CapturedView>& views,
                       std::size_t at_once);

/// The camera of a view for what read_pictures has read, at the run's scale. Throws InputError,
/// which begins with the place of what is wrong, if that has one: where there is no such sensor, or
/// the file of a picture does not fit its film, or that of a mask a rendered view.
ViewCamera camera_for(const RunSettings& run, const CapturedView& view,
                      const Photograph& photograph, const Renderer& renderer);

/// What the files of the views say before a run.
struct CheckedViews {
    std::vector<ViewCamera> cameras;  ///< for their pictures; a view's own where that does not fit
    std::vector<std::string> findings;  ///< what optimize would refuse or could not fit in their
                                        ///< pictures, masks and lights, and what it would warn of
};
/// Reads the pictures, with progress, as many at once as half of the machine's memory holds.
CheckedViews check_views(const Renderer& renderer, const std::vector<CapturedView>& views);

/// mask_blind_pixels of optimize/views.h. Returns what is said of it; empty: nothing is left out.
std::string leave_out_blind_pixels(const Renderer& renderer, std::size_t number, View& view);

/// How files were read, one text for each way: "a.jpg: JPEG, 8 bits, sRGB, turned by EXIF
/// orientation 6, 12 pixels clipped and left out"; of several pictures "17 pictures: EXR, 32 bits,
/// linear"; of several ways "a.png and 3 others: PNG, 8 bits, sRGB". Clipped pixels are those of
/// all that share a text.
std::vector<std::string> decoding_texts(const std::vector<CapturedView>& views,
                                        const std::vector<Photograph>& photographs);
/// "linear", "sRGB" or "gamma 2.2".
std::string encoding_text(const Encoding& encoding);

/// "alpha", "gray" or "colors".
const char* name_of(MaskSource source);
/// How the masks were read, one text for each way: "a.png and 3 others: masks from their alpha".
std::vector<std::string> mask_texts(const std::vector<CapturedView>& views,
                                    const std::vector<MaskFile>& masks);

/// What looks wrong in the pictures, and what they cannot tell, a sentence each.
/// has_unknown_color: a texture that is recovered is a colour.
std::vector<std::string> picture_warnings(const std::vector<CapturedView>& views,
                                          const Pictures& pictures, bool has_unknown_color);

}  // namespace burnish
