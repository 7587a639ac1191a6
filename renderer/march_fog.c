/* SPDX-License-Identifier: MIT */
#include "renderer/march_params.h"

struct neph_march_fog neph_fog_for_march(int choice)
{
    static const struct neph_march_fog fogs[] = {
        {false, NEPH_FOG_UNREAL}, {true, NEPH_FOG_UNREAL}, {true, NEPH_FOG_FILAMENT}};
    return fogs[choice];
}
