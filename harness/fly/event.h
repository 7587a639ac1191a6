/* SPDX-License-Identifier: MIT
 *
 * What a person does to a window, without the words of any library.
 */
#ifndef NEPH_HARNESS_FLY_EVENT_H
#define NEPH_HARNESS_FLY_EVENT_H

/* Letters, digits and signs are themselves, in lower case; these are the others. */
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
    NEPH_FLY_FOCUS_LOST, /* keys that are held are no longer ours to see */
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
    enum neph_fly_button button; /* of _BUTTON_DOWN and _UP */
    double x_share;              /* where in the window, 0 left, 1 right */
    double dx_share, dy_share;   /* moved by so much of the window's height; down is positive */
    double wheel;                /* notches, away from the person is positive */
};

#endif
