// Photographs: how the numbers of a file become the picture and the weights of a view.
#pragma once

#include <cstddef>
#include <string>
#include <variant>

#include "burnish/image.h"

namespace burnish {

/// EXR, HDR and PFM are linear, all others sRGB.
struct ByFileType {
    friend bool operator==(const ByFileType&, const ByFileType&) = default;
};
struct LinearEncoding {
    friend bool operator==(const LinearEncoding&, const LinearEncoding&) = default;
};
/// IEC 61966-2-1.
struct SrgbEncoding {
    friend bool operator==(const SrgbEncoding&, const SrgbEncoding&) = default;
};
/// A number is the linear one to the power of 1 / gamma.
struct GammaEncoding {
    double gamma = 2.2;  ///< above 0, at most 10

    friend bool operator==(const GammaEncoding&, const GammaEncoding&) = default;
};
/// What the numbers of a file mean.
using Encoding = std::variant<ByFileType, LinearEncoding, SrgbEncoding, GammaEncoding>;

/// What becomes of an EXIF orientation. Programs that find cameras leave it alone: their cameras
/// are those of the stored picture.
enum class Turning { kUpright, kAsStored };

/// A picture as it was taken, and how its file was read.
struct Photograph {
    Image image = {};    ///< [height, width, 3], linear RGB
    Image mask = {};     ///< [height, width, 1 or 3]: alpha, and what `add_mask` adds; width 0: all
                         ///< ones
    Image clipped = {};  ///< [height, width, 1]: above 0 where a channel of an integer file is at
                         ///< its maximum; width 0: nowhere
    std::string type = {};                ///< of the file: "JPEG"
    int bits = 0;                         ///< of a stored number
    Encoding encoding = {};               ///< that was decoded; never ByFileType
    int orientation = 1;                  ///< EXIF's, 1 to 8, of the file
    Turning turning = Turning::kUpright;  ///< whether `image` has been turned by it
    std::string profile = {};             ///< name of the file's ICC profile, which is not read;
                                          ///< of a file without one, that EXIF or a PNG's cHRM
                                          ///< has its colours as others than those of sRGB
    bool says_linear = false;             ///< a PNG's gamma, which is not read, is that of linear
                                          ///< numbers, and it has no profile
    bool is_gray = false;                 ///< R = G = B everywhere
    bool has_alpha = false;               ///< the file has
    std::size_t clipped_pixels = 0;       ///< with a mask above 0: of the file, and where
                                          ///< `add_mask` counts them again, of `image`
    std::size_t negative_pixels = 0;      ///< of the file, with a value below 0
    int file_width = 0;                   ///< of the file, turned as `image` is; `scaled` keeps it
    int file_height = 0;                  ///< likewise
};

/// Reads what read_image reads; colours are taken as those of sRGB, whatever profile a file has.
/// Throws InputError as read_image does, for a gamma out of range, for an EXR with overscan, and
/// where a value is not finite: how many are not, and where the first one is.
Photograph read_photograph(const std::string& file, const Encoding& encoding = {},
                           Turning turning = Turning::kUpright);

/// Multiplies the mask with one of your own, [height, width, 1 or 3] of the same size; its weights
/// are finite and not negative. Throws InputError where it is not so, where the photograph's own
/// images are not of one size, or where one of all these has not one value for each channel of a
/// pixel.
void add_mask(const Image& mask, Photograph& photograph);

/// The weights of its pixels for View::mask: the mask, 0 where a pixel is clipped; width 0: all
/// ones. Throws InputError where the photograph's images are not of one size, or one has not one
/// value for each channel of a pixel.
Image weights_of(const Photograph& photograph);

/// At a fraction of the size, in (0, 1]: means over exact areas, in linear light. Colours are
/// weighed by the mask, the mask is averaged; a pixel is clipped where any part of it with a mask
/// above 0 is. Throws InputError where the factor is out of range, the images are not of one size,
/// or one has not one value for each channel of a pixel.
Photograph scaled(Photograph photograph, double factor);

/// An image at a fraction of its size, as the mask of a photograph; an empty one stays empty.
/// Throws InputError where the factor is out of range, or there is not one value for each channel
/// of a pixel.
Image scaled(const Image& image, double factor);

/// The size of a scaled picture. Its pixels are `step` pixels wide and high; their middle is that
/// of the picture, so that a row that would be there in part is left out.
struct ScaledSize {
    int width = 0, height = 0;
    double step = 1;
};
/// factor: in (0, 1]. Throws InputError for others, and for a picture without pixels.
ScaledSize scaled_size(int width, int height, double factor);

}  // namespace burnish
