// JPEG by libjpeg. Its errors leave by longjmp, so every function between setjmp and libjpeg holds
// plain data only.
#include <fmt/format.h>

#include <cstddef>
#include <cstdio>

#include <jpeglib.h>

#include <jerror.h>

#include <algorithm>
#include <csetjmp>
#include <cstdint>

#include "image/formats.h"

namespace burnish {

namespace {

/// libjpeg's error state; `base` first, because libjpeg knows only that.
struct JpegErrors {
    jpeg_error_mgr base;
    std::jmp_buf jump;
    char message[JMSG_LENGTH_MAX];
    bool damaged;  ///< libjpeg went on by inventing data: refused here
};

struct JpegReader {
    jpeg_decompress_struct jpeg{};
    jpeg_progress_mgr progress{};
    JpegReader() = default;
    JpegReader(const JpegReader&) = delete;
    JpegReader& operator=(const JpegReader&) = delete;
    ~JpegReader() { jpeg_destroy_decompress(&jpeg); }
};

void on_error(j_common_ptr common) {
    auto* errors = reinterpret_cast<JpegErrors*>(common->err);
    common->err->format_message(common, errors->message);
    std::longjmp(errors->jump, 1);
}

void on_message(j_common_ptr common, int level) {
    auto* errors = reinterpret_cast<JpegErrors*>(common->err);
    if (level >= 0 || errors->damaged) return;
    if (common->err->msg_code == JWRN_EXTRANEOUS_DATA || common->err->msg_code == JWRN_ADOBE_XFORM)
        return;
    common->err->format_message(common, errors->message);
    errors->damaged = true;
}

std::size_t blocks_of(const jpeg_component_info& component) {
    return std::size_t{component.width_in_blocks} * component.height_in_blocks;
}

/// Each scan of a progressive file may go over all blocks. Sound files hold some ten scans, which
/// the largest picture may have, too.
std::size_t max_scans(const jpeg_decompress_struct& jpeg) {
    constexpr std::size_t kMax = 500, kMaxBlocks = std::size_t{1} << 27;  // of all scans
    std::size_t blocks = 0;
    for (int c = 0; c < jpeg.num_components; ++c) blocks += blocks_of(jpeg.comp_info[c]);
    return std::min(kMax, kMaxBlocks / std::max<std::size_t>(1, blocks));
}

/// All scans of a progressive file are read before the first row. A file of few bytes may hold
/// thousands.
void on_progress(j_common_ptr common) {
    auto* errors = reinterpret_cast<JpegErrors*>(common->err);
    const auto& jpeg = *reinterpret_cast<j_decompress_ptr>(common);
    const std::size_t max = max_scans(jpeg);
    if (static_cast<std::size_t>(jpeg.input_scan_number) > max && !errors->damaged) {
        std::snprintf(errors->message, sizeof errors->message,
                      "found more than %zu scans of %u x %u pixels", max, jpeg.image_width,
                      jpeg.image_height);
        errors->damaged = true;
    }
    if (errors->damaged) std::longjmp(errors->jump, 1);
}

/// Says what the error is; sound files may hold what libjpeg does not know.
[[noreturn]] void fail_by(const JpegErrors& errors, const std::string& name) {
    switch (errors.damaged ? 0 : errors.base.msg_code) {
        case JERR_ARITH_NOTIMPL:
        case JERR_BAD_PRECISION:
        case JERR_CCIR601_NOTIMPL:
        case JERR_FRACT_SAMPLE_NOTIMPL:
        case JERR_SOF_UNSUPPORTED:
            formats::refuse(name, "JPEG", errors.message);
        default:
            formats::fail(name, "JPEG", errors.message);
    }
}

bool read_header(jpeg_decompress_struct& jpeg, JpegErrors& errors, std::string_view bytes) {
    if (setjmp(errors.jump)) return false;
    jpeg_create_decompress(&jpeg);
    jpeg_mem_src(&jpeg, reinterpret_cast<const unsigned char*>(bytes.data()),
                 static_cast<unsigned long>(bytes.size()));
    jpeg_save_markers(&jpeg, JPEG_APP0 + 1, 0xffff);  // EXIF
    jpeg_save_markers(&jpeg, JPEG_APP0 + 2, 0xffff);  // ICC
    jpeg_read_header(&jpeg, TRUE);
    jpeg.out_color_space = jpeg.num_components == 1 ? JCS_GRAYSCALE : JCS_RGB;
    return true;
}

/// Before anything is allocated for the pixels that a header claims: each block of 8 x 8 values has
/// a Huffman code of a bit or more, in the first scan of a progressive file, too. Arithmetic coding
/// has no such limit.
void require_bytes(const std::string& name, const jpeg_decompress_struct& jpeg, std::size_t found) {
    if (jpeg.arith_code) return;
    std::size_t blocks = 0;  // of the component that has most of them
    for (int c = 0; c < jpeg.num_components; ++c)
        blocks = std::max(blocks, blocks_of(jpeg.comp_info[c]));
    const std::size_t min = blocks / 8;
    if (min > found)
        formats::fail(name, "JPEG",
                      fmt::format("found {} bytes, expected {} or more for {} x {} pixels", found,
                                  min, jpeg.image_width, jpeg.image_height));
}

std::string_view bytes_of(const jpeg_marker_struct& marker) {
    return {reinterpret_cast<const char*>(marker.data), marker.data_length};
}

/// What the segments say; the orientation is that of the first one that has one, else 1.
formats::Exif exif_of(const jpeg_decompress_struct& jpeg) {
    formats::Exif exif;
    for (jpeg_saved_marker_ptr m = jpeg.marker_list; m; m = m->next) {
        const formats::Exif found = formats::read_exif(bytes_of(*m));
        if (exif.orientation == 0) exif.orientation = found.orientation;
        exif.is_uncalibrated |= found.is_uncalibrated;
    }
    if (exif.orientation == 0) exif.orientation = 1;
    return exif;
}

/// In the place of a profile's name.
constexpr const char* kUncalibratedProfile = "uncalibrated by EXIF, as of Adobe RGB";

/// Of the first segment of a profile: of a longer one, the table of its tags and mostly its name
/// stand there.
std::string profile_of(const jpeg_decompress_struct& jpeg) {
    // Segment 1; a byte follows: of how many.
    constexpr std::string_view kProfileMagic{"ICC_PROFILE\0\x01", 13};
    for (jpeg_saved_marker_ptr m = jpeg.marker_list; m; m = m->next)
        if (const std::string_view bytes = bytes_of(*m);
            bytes.size() > kProfileMagic.size() && bytes.starts_with(kProfileMagic))
            return formats::profile_name(bytes.substr(kProfileMagic.size() + 1));
    return {};
}

bool read_rows(jpeg_decompress_struct& jpeg, JpegErrors& errors, std::uint8_t* data,
               std::size_t row_bytes) {
    if (setjmp(errors.jump)) return false;
    jpeg_start_decompress(&jpeg);
    while (jpeg.output_scanline < jpeg.output_height && !errors.damaged) {
        JSAMPROW row = data + jpeg.output_scanline * row_bytes;
        jpeg_read_scanlines(&jpeg, &row, 1);
    }
    if (!errors.damaged) jpeg_finish_decompress(&jpeg);
    return !errors.damaged;
}

}  // namespace

ImageFile formats::decode_jpeg(const std::string& name, std::string_view bytes, Content content) {
    JpegErrors errors{};
    JpegReader reader;
    reader.jpeg.err = jpeg_std_error(&errors.base);
    errors.base.error_exit = on_error;
    errors.base.emit_message = on_message;
    reader.progress.progress_monitor = on_progress;
    if (!read_header(reader.jpeg, errors, bytes)) fail_by(errors, name);
    reader.jpeg.progress = &reader.progress;
    const int channels = reader.jpeg.num_components;
    if (channels != 1 && channels != 3)
        refuse(name, "JPEG",
               "found " + std::to_string(channels) + " components, expected 1 (gray) or 3 (RGB)");
    check_size(name, "JPEG", reader.jpeg.image_width, reader.jpeg.image_height, channels);
    require_bytes(name, reader.jpeg, bytes.size());
    ImageFile file{{static_cast<int>(reader.jpeg.image_width),
                    static_cast<int>(reader.jpeg.image_height),
                    channels,
                    {}},
                   PixelEncoding::kUnorm8,
                   "JPEG",
                   8};
    if (content == Content::kHeader) return file;
    const std::size_t row_bytes = reader.jpeg.image_width * static_cast<std::size_t>(channels);
    std::vector<std::uint8_t> data(row_bytes * reader.jpeg.image_height);
    const Exif exif = exif_of(reader.jpeg);  // reading rows forgets the markers
    std::string profile = profile_of(reader.jpeg);
    if (profile.empty() && exif.is_uncalibrated) profile = kUncalibratedProfile;
    if (!read_rows(reader.jpeg, errors, data.data(), row_bytes)) fail_by(errors, name);

    file.image.values.resize(data.size());
    file.orientation = exif.orientation, file.profile = profile;
    std::transform(data.begin(), data.end(), file.image.values.begin(),
                   [](std::uint8_t v) { return static_cast<float>(v) / 255.0f; });
    return file;
}

}  // namespace burnish
