/* SPDX-License-Identifier: MIT
 *
 * Checks that settings of the post-processing chain are compatible.
 */
#include "renderer/post/chain.h"

/* FXAA and sharpening clamp their output to 0..1, which would cut off radiance. */
static enum neph_status check_range(const struct neph_settings *settings, struct neph_diag *diag)
{
    const bool wants_picture = settings->values[POST_FXAA] != 0.0 ||
                               settings->values[POST_SHARPEN] != 0.0;
    if (!wants_picture || neph_post_is_displayed(settings))
        return NEPH_OK;
    neph_fail(diag, NEPH_ERR_USAGE,
              "fxaa and sharpen need display-encoded values, but tone is off");
    neph_hint(diag, "--set tone=on, with --set tone_map=none for values that are within 0 and 1");
    return NEPH_ERR_USAGE;
}

static enum neph_status check_order(const struct neph_settings *settings, int low, int high,
                                    double apart, struct neph_diag *diag)
{
    if (settings->values[low] + apart <= settings->values[high])
        return NEPH_OK;
    return neph_fail(diag, NEPH_ERR_USAGE, "%s=%g must be at least %g below %s=%g",
                     neph_post_options[low].name, settings->values[low], apart,
                     neph_post_options[high].name, settings->values[high]);
}

static enum neph_status check_eye(const struct neph_settings *settings, struct neph_diag *diag)
{
    const double least_percent = 0.01; /* nothing would be metered */
    if (settings->values[POST_AUTO_EXPOSURE] == 0.0)
        return NEPH_OK;
    if (!neph_post_is_displayed(settings) && settings->values[POST_BLOOM] != POST_BLOOM_ADDITIVE) {
        neph_fail(diag, NEPH_ERR_USAGE, "auto_exposure needs tone mapping, but tone is off");
        neph_hint(diag, "--set tone=on");
        return NEPH_ERR_USAGE;
    }
    enum neph_status status = check_order(settings, POST_METER_LOW_PERCENT, POST_METER_HIGH_PERCENT,
                                          least_percent, diag);
    return status ? status
                  : check_order(settings, POST_EXPOSURE_MIN_EV, POST_EXPOSURE_MAX_EV, 0.0, diag);
}

enum neph_status neph_post_check(const struct neph_settings *settings, struct neph_diag *diag)
{
    const enum neph_status status = check_range(settings, diag);
    return status ? status : check_eye(settings, diag);
}
