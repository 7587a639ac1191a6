/* SPDX-License-Identifier: MIT
 *
 * Scripted keys, frame by frame: repeats the same flight, for tests and timings.
 */
#ifndef NEPH_HARNESS_FLY_SCRIPT_H
#define NEPH_HARNESS_FLY_SCRIPT_H

#include "base/status.h"
#include "harness/fly/event.h"

#include <stdbool.h>

/* The key that is pressed and the key that is released before a frame; NEPH_FLY_KEY_NONE: none. */
struct neph_fly_strokes {
    int down, up;
};

/* Check a script. "w*60 x p" presses W for 60 frames, then X for one, then P. A key is a character,
 * or space, tab, esc, home; '.' is a frame without a key. NEPH_ERR_USAGE names the first invalid
 * word. */
enum neph_status neph_fly_script_check(const char *script, struct neph_diag *diag);

/* The key events before a frame, counted from 0. The script must be valid. */
struct neph_fly_strokes neph_fly_script_at(const char *script, int frame);

#endif
