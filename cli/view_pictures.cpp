#include "cli/view_pictures.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <mutex>
#include <set>
#include <string>
#include <utility>
#include <variant>

#include "burnish/error.h"
#include "captures/pictures.h"
#include "cli/console.h"
#include "cli/picture_memory.h"
#include "cli/progress.h"
#include "core/at_place.h"
#include "core/lower_case.h"
#include "core/parallel.h"
#include "core/variant.h"
#include "optimize/view_loss.h"
#include "optimize/views.h"
#include "render/renderer.h"
#include "render/view.h"

namespace burnish {

namespace {

std::string name_and_file(const CapturedView& view, std::size_t i) {
    return fmt::format("{} ({})", name_of(view.view, i), view.image);
}

/// Calls body(i) for each of the pictures, `at_once` at a time at most, with progress.
template <class Body>
void for_pictures(std::size_t count, std::size_t at_once, const Body& body) {
    ProgressLine line("reading the pictures");
    std::mutex mutex;
    std::size_t done = 0;
    parallel_tasks(count, at_once, [&](std::size_t i) {
        body(i);
        const std::lock_guard lock(mutex);
        line.show_share(static_cast<double>(++done) / static_cast<double>(count));
    });
}

/// What a view has files of; scale: in (0, 1].
Photograph picture_of(const CapturedView& view, const Image& mask, double scale,
                      const std::string& what) {
    if (!view.image.empty()) return read_picture(view, mask, scale, what);
    Photograph p;
    if (mask.width == 0) return p;
    p.file_width = mask.width, p.file_height = mask.height;
    p.mask = scaled(mask, scale);
    return p;
}

}  // namespace

Pictures read_pictures(const RunSettings& run, const std::vector<CapturedView>& views,
                       std::size_t at_once) {
    Pictures pictures{std::vector<Photograph>(views.size()), std::vector<MaskFile>(views.size())};
    for_pictures(views.size(), at_once, [&](std::size_t i) {
        const std::string what =
            "the target" + (views.size() == 1 ? "" : " of " + name_of(views[i].view, i));
        MaskFile& mask = pictures.masks[i] = read_mask(views[i]);
        pictures.photographs[i] = picture_of(views[i], mask.weights, run.scale, what);
        mask.weights = {};
    });
    return pictures;
}

namespace {

/// Of a view that is rendered.
void require_mask_size(const CapturedView& view, const Photograph& p, int width, int height,
                       const char* expected) {
    if (!view.image.empty() || view.mask.empty()) return;
    at_place(view.places.mask, [&] {
        require_file_size(p, width, height, "the mask (" + view.mask + ")", expected);
    });
}

/// `seen`: through the sensor. The size of a film that --size gives counts for targets.
void require_film(const RunSettings& run, const CapturedView& view, const Photograph& p,
                  const Renderer& seen) {
    require_mask_size(view, p, seen.width(), seen.height(), "the size of the film");
    if (view.image.empty()) return;
    if (!run.size.empty())
        require_file_size(p, seen.width(), seen.height(),
                          fmt::format("the target ({}{})", view.image, turning_text(p)),
                          "the size of the film");
    at_place(view.places.image, [&] {
        at_place(view.image + turning_text(p),
                 [&] { require_aspect(seen.data().traced.film, p.file_width, p.file_height); });
    });
}

bool is_dark(const Lighting& lighting) {
    const bool no_emitter = lighting.emitters && lighting.emitters->empty();
    return no_emitter && (!lighting.environment || lighting.environment->scale == 0.0);
}

/// What was found in one view; the complaint without its name.
struct CheckedView {
    ViewCamera camera;
    Photograph photograph = {};  ///< without its pixels, as the mask
    MaskFile mask = {};
    std::string complaint = {};
};

CheckedView check_view(const Renderer& renderer, CapturedView view) {
    view.places = {};  // its name stands before what is found
    CheckedView checked{view.view.camera};
    Photograph& p = checked.photograph;
    const RunSettings whole_size;
    try {
        checked.mask = read_mask(view);
        p = picture_of(view, checked.mask.weights, whole_size.scale, "the target");
        checked.camera = camera_for(whole_size, view, p, renderer);
        (void)renderer.with_camera(checked.camera);
    } catch (const InputError& e) {
        checked.complaint = e.what();
    }
    if (checked.complaint.empty() && is_dark(view.view.lighting))
        checked.complaint = "no emitter is on: its rendered image is black";
    p.image = {}, p.mask = {}, p.clipped = {}, checked.mask.weights = {};
    return checked;
}

}  // namespace

ViewCamera camera_for(const RunSettings& run, const CapturedView& view, const Photograph& p,
                      const Renderer& renderer) {
    return match(
        view.view.camera,
        [&](const Sensor& sensor) -> ViewCamera {
            const Renderer seen =
                at_place(view.places.camera, [&] { return renderer.with_camera(sensor); });
            require_film(run, view, p, seen);
            ScaledSize size = scaled_size(seen.width(), seen.height(), run.scale);
            if (p.image.width > 0) size.width = p.image.width, size.height = p.image.height;
            if (size.width == seen.width() && size.height == seen.height()) return sensor;
            return Sensor{sensor.name, size.width, size.height};
        },
        [&](const Camera& camera) -> ViewCamera {
            require_mask_size(view, p, camera.width, camera.height, "the size of its camera");
            return scaled(camera, run.scale);
        });
}

CheckedViews check_views(const Renderer& renderer, const std::vector<CapturedView>& views) {
    std::vector<CheckedView> each(views.size());
    const double room = room_beside(renderer.data().scene());
    for_pictures(views.size(), pictures_at_once(views, room),
                 [&](std::size_t i) { each[i] = check_view(renderer, views[i]); });
    CheckedViews checked;
    Pictures pictures;
    for (std::size_t i = 0; i < views.size(); ++i) {
        checked.cameras.push_back(std::move(each[i].camera));
        pictures.photographs.push_back(std::move(each[i].photograph));
        pictures.masks.push_back(std::move(each[i].mask));
        if (!each[i].complaint.empty())
            checked.findings.push_back(name_of(views[i].view, i) + ": " + each[i].complaint);
    }
    for (std::string& warning : picture_warnings(views, pictures, false))
        checked.findings.push_back(std::move(warning));
    return checked;
}

std::string leave_out_blind_pixels(const Renderer& renderer, std::size_t number, View& view) {
    const double share = mask_blind_pixels(renderer, view);
    if (share == 0) return {};
    return fmt::format(
        "{}: {:.1f} % of the pixels lie outside of the field of its lens and are left out",
        name_of(view, number), 100 * share);
}

std::string encoding_text(const Encoding& encoding) {
    return match(
        encoding, [](const ByFileType&) -> std::string { return "by file type"; },
        [](const LinearEncoding&) -> std::string { return "linear"; },
        [](const SrgbEncoding&) -> std::string { return "sRGB"; },
        [](const GammaEncoding& g) { return fmt::format("gamma {:g}", g.gamma); });
}

namespace {

/// clipped_pixels: of all pictures that were read so.
std::string decoding_text(const Photograph& p, std::size_t clipped_pixels) {
    std::string text = fmt::format("{}, {} bits, {}", p.type, p.bits, encoding_text(p.encoding));
    if (p.has_alpha) text += ", alpha as mask";
    text += turning_text(p);
    if (p.clipped.width > 0)
        text += fmt::format(", {} clipped and left out", count_text(clipped_pixels, "pixel"));
    return text;
}

/// Pictures that were read alike.
struct AlikePictures {
    std::size_t first;  ///< of the views
    std::size_t count = 0, clipped_pixels = 0;
};

/// In the order of their first ones.
std::vector<AlikePictures> alike_pictures(const std::vector<Photograph>& photographs) {
    std::vector<AlikePictures> groups;
    std::map<std::string, std::size_t> known;  // where a way stands
    for (std::size_t i = 0; i < photographs.size(); ++i) {
        const Photograph& p = photographs[i];
        if (p.type.empty()) continue;
        const auto [place, is_new] = known.emplace(decoding_text(p, 0), groups.size());
        if (is_new) groups.push_back({i});
        AlikePictures& group = groups[place->second];
        ++group.count, group.clipped_pixels += p.clipped_pixels;
    }
    return groups;
}

}  // namespace

std::vector<std::string> decoding_texts(const std::vector<CapturedView>& views,
                                        const std::vector<Photograph>& photographs) {
    const std::vector<AlikePictures> groups = alike_pictures(photographs);
    std::vector<std::string> texts;
    for (const AlikePictures& group : groups) {
        std::string which = views[group.first].image;
        if (group.count > 1)
            which = groups.size() == 1
                        ? count_text(group.count, "picture")
                        : fmt::format("{} and {}", which, count_text(group.count - 1, "other"));
        texts.push_back(which + ": " +
                        decoding_text(photographs[group.first], group.clipped_pixels));
    }
    return texts;
}

const char* name_of(MaskSource source) {
    switch (source) {
        case MaskSource::kAlpha:
            return "alpha";
        case MaskSource::kGray:
            return "gray";
        case MaskSource::kColors:
            return "colors";
    }
    return "";
}

std::vector<std::string> mask_texts(const std::vector<CapturedView>& views,
                                    const std::vector<MaskFile>& masks) {
    std::vector<std::string> texts;
    for (const auto& [source, what] :
         {std::pair{MaskSource::kAlpha, "alpha"}, std::pair{MaskSource::kGray, "grey levels"},
          std::pair{MaskSource::kColors, "colours, each channel for its own"}}) {
        std::set<std::string> files;
        for (std::size_t i = 0; i < views.size(); ++i)
            if (!views[i].mask.empty() && masks[i].source == source) files.insert(views[i].mask);
        if (files.size() == 1) texts.push_back(*files.begin() + ": mask from its " + what);
        if (files.size() > 1)
            texts.push_back(fmt::format("{} and {} other{}: masks from their {}", *files.begin(),
                                        files.size() - 1, files.size() == 2 ? "" : "s", what));
    }
    return texts;
}

namespace {

/// Empty: nothing looks wrong.
std::string warning_of(const MaskFile& mask) {
    constexpr float kWhite = 0.98f;  // 1, but for what compression does to it
    if (mask.source != MaskSource::kColors || mask.max_weight >= kWhite) return {};
    return fmt::format(
        "its weights are colours, at most {:.2g} in all three channels of a pixel: expected white "
        "where the picture counts",
        mask.max_weight);
}

/// Of a name as "GIMP built-in Linear sRGB" or "sRGB-elle-V2-g10.icc".
bool is_linear(const std::string& profile) {
    const std::string name = lower_case(profile);
    const auto has = [&](const char* part) { return name.find(part) != std::string::npos; };
    return (has("linear") && !has("nonlinear") && !has("non-linear")) || has("-g10");
}

/// What it has that is not read; empty: nothing that says other colours than were decoded.
std::string warning_of_encoding(const Photograph& p) {
    const bool is_srgb = p.profile.find("sRGB") != std::string::npos;
    if (!p.profile.empty() && !is_srgb)
        return fmt::format("the colour profile \"{}\", which is not read: convert it to sRGB",
                           p.profile);
    if (!std::holds_alternative<SrgbEncoding>(p.encoding)) return {};
    constexpr const char* kDo = "which is not read: give \"encoding\": \"linear\" in a capture";
    if (is_srgb && is_linear(p.profile))
        return fmt::format("the linear profile \"{}\", {}", p.profile, kDo);
    if (p.says_linear) return std::string("the gamma 1 of linear numbers, ") + kDo;
    return {};
}

/// Of a mask of instant-ngp that lies beside a picture without another; empty: there is none.
std::string warning_of_dynamic_masks(const std::vector<CapturedView>& views) {
    for (const CapturedView& view : views) {
        if (view.image.empty() || !view.mask.empty()) continue;
        const std::filesystem::path image = view.image;
        const auto file = image.parent_path() / ("dynamic_mask_" + image.stem().string() + ".png");
        std::error_code ignored;
        if (std::filesystem::exists(file, ignored))
            return fmt::format(
                "masks of instant-ngp, as {}, are not read: invert them, since what is white "
                "counts, and name each as the mask of its view",
                file.string());
    }
    return {};
}

}  // namespace

std::vector<std::string> picture_warnings(const std::vector<CapturedView>& views,
                                          const Pictures& pictures, bool has_unknown_color) {
    std::vector<std::string> warnings;
    for (std::size_t i = 0; i < views.size(); ++i) {
        const Photograph& p = pictures.photographs[i];
        if (const std::string text = warning_of(pictures.masks[i]); !text.empty())
            warnings.push_back(
                fmt::format("{} ({}): {}", name_of(views[i].view, i), views[i].mask, text));
        if (p.negative_pixels > 0)
            warnings.push_back(fmt::format(
                "{}: {} pixel{} values below 0", name_and_file(views[i], i),
                count_text(p.negative_pixels), p.negative_pixels == 1 ? " has" : "s have"));
        if (const std::string text = warning_of_encoding(p); !text.empty())
            warnings.push_back(name_and_file(views[i], i) + " has " + text);
        if (p.is_gray)
            warnings.push_back(name_and_file(views[i], i) + " is grey: R = G = B everywhere");
    }
    if (std::string text = warning_of_dynamic_masks(views); !text.empty())
        warnings.push_back(std::move(text));
    const bool all_fitted = std::all_of(views.begin(), views.end(), [](const CapturedView& v) {
        return v.view.held_out || fits_exposure(v.view.exposure);
    });
    if (all_fitted && has_unknown_color)
        warnings.push_back(
            "every exposure is fitted and a colour is unknown: how bright it is follows from "
            "highlights and other surfaces alone; give one view a number if you know its exposure");
    return warnings;
}

}  // namespace burnish
