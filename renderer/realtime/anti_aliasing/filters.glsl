// SPDX-License-Identifier: MIT
//
// The filters of the history along one axis.
#ifndef NEPH_REALTIME_FILTERS_GLSL
#define NEPH_REALTIME_FILTERS_GLSL

#include "renderer/realtime/shared/names.h"

// Weights of the texels -1, 0, 1 and 2 for a place between texels 0 and 1, `place` of the way. The
// cubic is Catmull-Rom: R. Keys, "Cubic Convolution Interpolation for Digital Image Processing",
// IEEE Trans. ASSP 29(6), 1981, with a = -1/2.
vec4 tap_weights(int kind, float place)
{
    if (kind == RT_FILTER_NEAREST)
        return place < 0.5 ? vec4(0.0, 1.0, 0.0, 0.0) : vec4(0.0, 0.0, 1.0, 0.0);
    if (kind == RT_FILTER_BILINEAR)
        return vec4(0.0, 1.0 - place, place, 0.0);
    return 0.5 * vec4(place * (place * (2.0 - place) - 1.0),
                      place * place * (3.0 * place - 5.0) + 2.0,
                      place * (place * (4.0 - 3.0 * place) + 1.0), place * place * (place - 1.0));
}

#endif
