// Colour constants: rgb, srgb, spectra and numbers, and the plugins `uniform`, `srgb`,
// `rawconstant` and `d65`, which are one colour in RGB.
#pragma once

#include "core/vec.h"
#include "mitsuba/properties.h"
#include "mitsuba/spectra.h"

namespace burnish::mitsuba {

/// Whether an element is a <spectrum> or a <texture> of a type that is one colour.
bool is_color_plugin(const Node& node);
/// Whether a property is a texture that is no colour constant.
bool is_texture(const Property& property);
/// Linear RGB of a colour constant: rgb, srgb, spectrum or number, or a plugin that is one. A
/// uniform spectrum gives gray.
Rgbf read_color(const Property& property, SpectrumUse use = SpectrumUse::kReflectance);
Rgbf take_color(Properties& properties, const std::string& name, const Rgbf& fallback,
                SpectrumUse use = SpectrumUse::kReflectance);
/// Whether a property is a <spectrum> whose attribute is one value.
bool is_uniform_spectrum(const Property& property);

}  // namespace burnish::mitsuba
