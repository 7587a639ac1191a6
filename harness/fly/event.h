/* SPDX-License-Identifier: MIT
 *
 * Input events of the window, independent of the window library.
 */
#ifndef NEPH_HARNESS_FLY_EVENT_H
#define NEPH_HARNESS_FLY_EVENT_H

/* Letters (in lower case), digits and signs are their own character codes; the other keys are
 * these. */
enum neph_fly_key {
    NEPH_FLY_KEY_NONE = 0,
    NEPH_FLY_KEY_TAB = '\t',
    NEPH_FLY_KEY_ESCAPE = 27,
    NEPH_FLY_KEY_SPACE = ' ',
    NEPH_FLY_KEY_SHIFT = 256,
    NEPH_FLY_KEY_HOME,
};

enum neph_fly_event_kind {
    NEPH_FLY_KEY_DOWN,
    NEPH_FLY_KEY_UP,
    NEPH_FLY_BUTTON_DOWN,
    NEPH_FLY_BUTTON_UP,
    NEPH_FLY_MOUSE_MOVED,
    NEPH_FLY_WHEEL,
    NEPH_FLY_FOCUS_LOST, /* releases of pressed keys no longer arrive */
    NEPH_FLY_CLOSED,
};

enum neph_fly_button {
    NEPH_FLY_BUTTON_OTHER,
    NEPH_FLY_BUTTON_LEFT,
    NEPH_FLY_BUTTON_RIGHT,
};

struct neph_fly_event {
    enum neph_fly_event_kind kind;
    int key;                     /* enum neph_fly_key, or a character */
    enum neph_fly_button button; /* for _BUTTON_DOWN and _BUTTON_UP */
    double x_share;              /* position in the window, 0 left, 1 right */
    double dx_share, dy_share;   /* motion in window heights; down is positive */
    double wheel;                /* notches, positive away from the user */
};

#endif
