/* SPDX-License-Identifier: MIT
 *
 * The fog models of the ray marcher's setting `fog`.
 */
#include "renderer/march_params.h"

struct neph_march_fog neph_march_fog_choose(int choice)
{
    static const struct neph_march_fog fogs[] = {
        {.is_look = false},
        {.is_look = true, .model = NEPH_FOG_UNREAL},
        {.is_look = true, .model = NEPH_FOG_FILAMENT},
    };
    return fogs[choice];
}
