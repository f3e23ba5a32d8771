// The pictures of captured views: read with their masks, at a fraction of their size.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "captures/capture.h"

namespace burnish {

/// Throws InputError: "WHAT is 3 x 4 pixels, expected EXPECTED, 5 x 6".
void require_size(const Image& image, int width, int height, const std::string& what,
                  const std::string& expected);
/// The same of a photograph's file, whatever it was scaled to.
void require_file_size(const Photograph& photograph, int width, int height, const std::string& what,
                       const std::string& expected);

/// ", turned by EXIF orientation 6", ", EXIF orientation 6 left out"; empty: it has none.
std::string turning_text(const Photograph& photograph);

/// What the weights of a mask's file are; kColors: its channels differ somewhere.
enum class MaskSource { kAlpha, kGray, kColors };

struct MaskFile {
    Image weights = {};  ///< [height, width, 1 or 3]; width 0: there is no file
    MaskSource source = MaskSource::kGray;
    float max_weight = 0;  ///< the largest that a pixel has in all of its channels
};

/// Weights of pixels. Integer files mean their codes, 0 to 1, without decoding, turned as asked
/// for. Of a file whose alpha is below 1 somewhere, the alpha. Throws InputError: outside of 0 to
/// 1, not finite, all zero.
MaskFile read_mask(const std::filesystem::path& file, Turning turning);
/// That of a view, if it names one. Its errors begin with the place of the mask, if it has one.
MaskFile read_mask(const CapturedView& view);

/// The picture of a view with a mask, empty or of the picture's size, which weighs its colours
/// where it is made smaller. scale: in (0, 1]. what: "the target of front", in messages. Throws
/// InputError, which begins with the place of the picture or of the mask, if that has one: it is
/// not as large as its camera, the mask is of another size, or no pixel counts.
Photograph read_picture(const CapturedView& view, const Image& mask, double scale,
                        const std::string& what);

/// Bytes of memory that the picture and the mask of a view take at most.
struct PictureBytes {
    double reading = 0;  ///< while they are read
    double kept = 0;     ///< of what is read, at the scale
};
/// By the headers of their files. None where one cannot be read: read_mask or read_picture says
/// why.
PictureBytes picture_bytes(const CapturedView& view, double scale);

}  // namespace burnish
