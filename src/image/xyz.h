// Colours of the standard observer.
#pragma once

namespace burnish {

/// XYZ to linear Rec. 709, with the digits that Mitsuba has; the rows are red, green and blue.
inline constexpr double kRec709OfXyz[3][3] = {{3.240479, -1.537150, -0.498535},
                                              {-0.969256, 1.875991, 0.041556},
                                              {0.055648, -0.204043, 1.057311}};

}  // namespace burnish
