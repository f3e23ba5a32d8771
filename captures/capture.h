// capture.json: a scene and several pictures of it, see docs/reference/capture.md.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "burnish/photograph.h"
#include "burnish/solve.h"

namespace burnish {

/// Where a view and what it names stand, in messages: "capture.json: views[0].image". Empty: they
/// have the view's name alone.
struct ViewPlaces {
    std::string view, image, mask, camera, emitters;
};

/// A view and where its pictures come from.
struct CapturedView {
    View view;                            ///< without pictures
    std::string image;                    ///< file; empty: rendered from the scene's own textures
    std::string mask;                     ///< file; empty: all ones
    Encoding encoding = {};               ///< of the image's file
    Turning turning = Turning::kUpright;  ///< of the image and the mask
    std::string size_of = {};  ///< image whose size its camera has, that of the first view without
                               ///< a size; empty: the camera has one of its own
    ViewPlaces places = {};
};

struct Capture {
    std::string scene;  ///< file
    std::map<std::string, std::string> definitions;
    std::vector<CapturedView> views;
};

/// Whether a file is read as a capture: by its name, which ends in .json, also in capitals.
bool is_capture(const std::filesystem::path& file);

/// Throws InputError: file, key, what was found and what was expected. Environments are read,
/// images and masks are not.
Capture read_capture(const std::string& file);

/// The capture, where the file is one.
std::optional<Capture> capture_at(const std::string& file);

}  // namespace burnish
