// A page of HTML, and what it shows: pictures with captions, colour keys, tables.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "image/image.h"

namespace burnish {

/// title: HTML. more_style: CSS beside that of all reports. body: from the <h1> of a <header> that
/// is open on; it closes it.
std::string page_html(const std::string& title, const char* more_style, const std::string& body);

/// `more` stands behind the name.
std::string figure(const std::string& name, const std::string& more, const Image& image, bool srgb);

struct StripPicture {
    const char* what;
    const Image& image;
    bool srgb;
};
/// Pictures side by side under one caption.
std::string strip(const std::string& name, const std::string& more,
                  const std::vector<StripPicture>& pictures);

/// Of false_color from 0 to white.
std::string color_key(float white, const std::string& meaning);

/// What each row is, and what it says.
using TableRows = std::vector<std::pair<std::string, std::string>>;
/// title: HTML; empty: there is none.
std::string table(const std::string& title, const TableRows& rows);

std::string loss_text(double loss);

}  // namespace burnish
