/* SPDX-License-Identifier: MIT */
#include "scenes/words.h"

#include "scenes/failing.h"
#include "scenes/gates.h"
#include "scenes/injection.h"
#include "scenes/scene.h"

/* A new kind does not compile before this file was looked through for it. */
_Static_assert(NEPH_FAILING_MEASURES == 8, "a new kind");
_Static_assert(NEPH_FAILING_REFERENCE_COUNT == 2, "a new kind");
_Static_assert(NEPH_INJECTED_VALUES == 6, "a new kind");
_Static_assert(NEPH_QUANTITY_COUNT == 3, "a new kind");
_Static_assert(NEPH_SCATTERING_COUNT == 3, "a new kind");

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

const char *const neph_failing_measure_words[] = {
    [NEPH_FAILING_ERROR] = "error",
    [NEPH_FAILING_FLICKER] = "flicker",
    [NEPH_FAILING_PERIOD_4] = "period_4",
    [NEPH_FAILING_LAG] = "lag",
    [NEPH_FAILING_EDGE_RATIO] = "edge_ratio",
    [NEPH_FAILING_NEVER_SEEN] = "never_seen",
    [NEPH_FAILING_ENERGY] = "energy",
    [NEPH_FAILING_BAD_VALUES] = "bad_values",
    NULL,
};

const char *const neph_failing_reference_words[] = {
    [NEPH_FAILING_MARCH] = "march",
    [NEPH_FAILING_EXACT] = "exact",
    NULL,
};

const char *const neph_injected_value_words[] = {
    [NEPH_INJECTED_NAN] = "nan",
    [NEPH_INJECTED_INFINITE] = "infinite",
    [NEPH_INJECTED_NEGATIVE] = "negative",
    [NEPH_INJECTED_HUGE] = "huge",
    [NEPH_INJECTED_GARBAGE] = "garbage",
    [NEPH_INJECTED_BLACK] = "black",
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

const char *neph_failing_measure_name(enum neph_failing_measure measure)
{
    return neph_failing_measure_words[measure];
}

const char *neph_injected_value_name(enum neph_injected_value value)
{
    return neph_injected_value_words[value];
}

const char *neph_failing_reference_name(enum neph_failing_reference truth)
{
    return neph_failing_reference_words[truth];
}
