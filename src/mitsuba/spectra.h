// Tabulated spectra as linear RGB.
#pragma once

#include <filesystem>
#include <string>

#include "core/vec.h"
#include "mitsuba/node.h"

namespace burnish::mitsuba {

/// What a spectrum says: the colour of a surface is what it makes of daylight (D65), in [0, 1]; so
/// is an index of refraction, of any size; that of a light is its own.
enum class SpectrumUse { kReflectance, kIndex, kEmission };

/// The colour of `text`, pairs such as "400:0.1, 500:0.7" of wavelengths in nm, which increase, and
/// values, linear in between and 0 outside, as Mitsuba's rgb variants have it. What lies out of
/// gamut is clamped. Throws InputError where it is not of that form.
Rgbf rgb_of_spectrum(const std::string& text, SpectrumUse use, const Place& place);

/// The pairs of a file (`.spd`) as rgb_of_spectrum reads them: a wavelength and a value in each
/// line, what follows a # passed over. Throws InputError: unreadable, a line of another form.
std::string read_spectrum_file(const std::filesystem::path& file);

}  // namespace burnish::mitsuba
