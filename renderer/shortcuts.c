/* SPDX-License-Identifier: MIT */
#include "renderer/shortcuts.h"

#include "settings/march_shortcut_bits.h"
#include "shaders/structs.h"

#include <math.h>

/* Does not compile with a new kind: this file then needs a change. */
_Static_assert(NEPH_MARCH_LIGHTING_COUNT == 8, "a new kind");
_Static_assert(NEPH_MARCH_MODE_COUNT == 2, "a new kind");

const char *const neph_texel_formats[] = {"r32f", "r16f", "r8", NULL};
const char *const neph_sky_refills[] = {"stale", "views", "all", NULL};

static enum neph_status check_range(const char *name, double value, double least, double most,
                                    struct neph_diag *diag)
{
    if (value >= least && value <= most)
        return NEPH_OK;
    return neph_fail(diag, NEPH_ERR_USAGE, "march: %s is %g, outside %g..%g", name, value, least,
                     most);
}

#include "settings/march_shortcuts.inc"

static enum neph_status check_growth(const char *name, double growth, int steps,
                                     struct neph_diag *diag)
{
    if (growth > 1.0 && growth < NEPH_STEP_GROWTH_LEAST)
        return neph_fail(diag, NEPH_ERR_USAGE,
                         "march: %s is %.9g; allowed are 1 (equal steps) and values from %g on, "
                         "because float32 cannot resolve smaller growth",
                         name, growth, NEPH_STEP_GROWTH_LEAST);
    if (growth <= 1.0 || pow(growth, steps - 1) <= NEPH_STEP_GROWTH_WHOLE_MAX)
        return NEPH_OK;
    return neph_fail(diag, NEPH_ERR_USAGE,
                     "march: with %s=%g the last of %d steps is more than %g times as long as the "
                     "first; the limit is %s=%.6g",
                     name, growth, steps, NEPH_STEP_GROWTH_WHOLE_MAX, name,
                     pow(NEPH_STEP_GROWTH_WHOLE_MAX, 1.0 / (steps - 1)));
}

/* The value of SCALES_VIEW in shaders/march_light.glsl. */
static bool scales_view(enum neph_march_lighting lighting)
{
    return lighting == NEPH_MARCH_OCTAVES_FITTED || lighting == NEPH_MARCH_DIFFUSED ||
           lighting == NEPH_MARCH_SIMILARITY || lighting == NEPH_MARCH_SLAB;
}

static enum neph_status check_lighting(const struct neph_march_params *params,
                                       struct neph_diag *diag)
{
    const struct neph_shortcuts *shortcuts = &params->shortcuts;
    if (scales_view(params->lighting) && shortcuts->early_out > 0.0)
        return neph_fail(diag, NEPH_ERR_UNSUPPORTED,
                         "march: early_out=%g: multiple scattering also contributes where the "
                         "view's transmittance is small; set early_out=0",
                         shortcuts->early_out);
    if (params->lighting != NEPH_MARCH_HORIZON || !(shortcuts->sun_cache || shortcuts->skip))
        return NEPH_OK;
    return neph_fail(diag, NEPH_ERR_UNSUPPORTED,
                     shortcuts->skip ? "march: skip=majorant: the lighting of Horizon clouds also "
                                       "emits in clear air, which would be lost; set skip=off"
                                     : "march: sun_cache=grid: the lighting of Horizon clouds uses "
                                       "no optical depth towards the sun; set sun_cache=off");
}

static enum neph_status check_texture(const struct neph_march_params *params,
                                      struct neph_diag *diag)
{
    if (!params->shortcuts.grid_texture || params->transmittance == NEPH_MARCH_MARCHED ||
        params->sun == NEPH_MARCH_MARCHED)
        return NEPH_OK;
    return neph_fail(diag, NEPH_ERR_UNSUPPORTED,
                     "march: grid_sampling=texture: with transmittance=exact and sun=exact closed "
                     "forms integrate the voxels, so no samples of the texture are needed; set "
                     "transmittance=marched, sun=marched, or both");
}

enum neph_status neph_shortcuts_check(const struct neph_march_params *params,
                                      struct neph_diag *diag)
{
    const struct neph_shortcuts *shortcuts = &params->shortcuts;
    enum neph_status status = check_ranges(shortcuts, diag);
    if (!status)
        status = check_growth("step_growth", shortcuts->step_growth, params->steps, diag);
    if (!status)
        status = check_growth("sun_growth", shortcuts->sun_growth, params->sun_steps, diag);
    if (!status)
        status = check_texture(params, diag);
    return status ? status : check_lighting(params, diag);
}
