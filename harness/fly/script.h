/* SPDX-License-Identifier: MIT
 *
 * Keys that are pressed by a text, frame by frame: the same flight again, for tests and timings.
 */
#ifndef NEPH_HARNESS_FLY_SCRIPT_H
#define NEPH_HARNESS_FLY_SCRIPT_H

#include "base/status.h"
#include "harness/fly/event.h"

#include <stdbool.h>

/* Which key goes down before a frame and which goes up; NEPH_FLY_KEY_NONE: none. */
struct neph_fly_strokes {
    int down, up;
};

/* "w*60 x p": W held for 60 frames, then X for one, then P. The keys are a character, or space,
 * tab, esc, home; '.' is none, a wait. NEPH_ERR_USAGE names the word that is none. */
enum neph_status neph_fly_script_check(const char *script, struct neph_diag *diag);

/* The strokes before a frame, 0-based, of a script that is right. */
struct neph_fly_strokes neph_fly_script_at(const char *script, int frame);

#endif
