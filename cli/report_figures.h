// Pictures with captions and colour keys, as HTML.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "image/image.h"

namespace burnish {

/// `more` stands behind the name.
std::string figure(const std::string& name, const std::string& more, const Image& image, bool srgb);

/// Pictures side by side under one caption. pictures: what each is, and its data URI.
std::string strip(const std::string& name, const std::string& more,
                  const std::vector<std::pair<std::string, std::string>>& pictures);

/// Of false_color from 0 to white.
std::string color_key(float white, const std::string& meaning);

std::string loss_text(double loss);

}  // namespace burnish
