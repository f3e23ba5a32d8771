// Burnish: recovers the textures of materials from images. This header is the whole library
// but for burnish/mpi.h.
#pragma once

#include "burnish/checkpoint.h"
#include "burnish/error.h"
#include "burnish/gradient.h"
#include "burnish/image.h"
#include "burnish/input.h"
#include "burnish/live.h"
#include "burnish/options.h"
#include "burnish/photograph.h"
#include "burnish/renderer.h"
#include "burnish/solve.h"
#include "burnish/view.h"
