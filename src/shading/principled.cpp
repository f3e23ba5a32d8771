#include "shading/principled.h"

namespace burnish {

template Rgbf eval_principled_diffuse(const PrincipledParameters<float>&,
                                      const PrincipledGeometry<float>&);
template Rgbf eval_principled(const PrincipledParameters<float>&, const PrincipledGeometry<float>&,
                              const Vec3f&, const Vec3f&);

}  // namespace burnish
