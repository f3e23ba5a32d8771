#include "shading/texture.h"

namespace burnish {

template AxisTaps<float> axis_taps(const float&, int, TextureFilter, TextureWrap);
template Rgbf eval_texture(const TextureTable&, TextureId, const Vec2f&);

}  // namespace burnish
