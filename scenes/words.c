/* SPDX-License-Identifier: MIT */
#include "scenes/words.h"

#include "scenes/scene.h"

const char *const neph_scattering_words[] = {
    [NEPH_SCATTERING_NONE] = "none",
    [NEPH_SCATTERING_SINGLE] = "single",
    [NEPH_SCATTERING_MULTIPLE] = "multiple",
    NULL,
};

const char *const neph_gate_quantity_words[] = {
    [NEPH_QUANTITY_RADIANCE] = "radiance",
    [NEPH_QUANTITY_TRANSMITTANCE] = "transmittance",
    [NEPH_QUANTITY_DEPTH] = "depth",
    NULL,
};

const char *neph_scattering_name(enum neph_scattering scattering)
{
    return neph_scattering_words[scattering];
}

const char *neph_gate_quantity_name(enum neph_gate_quantity quantity)
{
    return neph_gate_quantity_words[quantity];
}
