// The text of a capture.json.
#pragma once

#include <nlohmann/json.hpp>

#include "captures/capture.h"

namespace burnish {

/// What read_capture reads as this capture again, bit by bit, where its files lie within the folder
/// of the text. Of views with encodings, exposures and lights of the defaults, as read_views gives
/// them.
nlohmann::ordered_json to_json(const Capture& capture);

}  // namespace burnish
