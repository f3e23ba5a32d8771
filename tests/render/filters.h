// Every reconstruction filter, with the radius that a scene gives it by default.
#pragma once

#include "scene/camera.h"

namespace burnish::test {

inline const ReconstructionFilter kFilters[] = {
    {FilterKind::kBox, 0.5f},      {FilterKind::kTent, 1.0f},       {FilterKind::kGaussian, 2.0f},
    {FilterKind::kMitchell, 2.0f}, {FilterKind::kCatmullRom, 2.0f}, {FilterKind::kLanczos, 3.0f},
};

}  // namespace burnish::test
