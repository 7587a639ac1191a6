/* SPDX-License-Identifier: MIT
 *
 * Translates key and mouse events into commands and camera motion. Independent of window and scene.
 */
#ifndef NEPH_HARNESS_FLY_CONTROLS_H
#define NEPH_HARNESS_FLY_CONTROLS_H

#include "harness/fly/camera.h"
#include "harness/fly/event.h"

#include <stdbool.h>

enum neph_fly_command {
    NEPH_FLY_NOTHING,
    NEPH_FLY_PRESET, /* `number` is the index of the preset */
    NEPH_FLY_MARCH,
    NEPH_FLY_REALTIME,
    NEPH_FLY_WIPE,
    NEPH_FLY_ERROR,
    NEPH_FLY_FLICKER,
    NEPH_FLY_DARKER,
    NEPH_FLY_BRIGHTER,
    NEPH_FLY_PAUSE,
    NEPH_FLY_HOME,
    NEPH_FLY_RECORD,
    NEPH_FLY_SCREENSHOT,
    NEPH_FLY_PASSES,
    NEPH_FLY_CAPTURE,
    NEPH_FLY_HELP,
    NEPH_FLY_LEAVE,
    NEPH_FLY_COMMAND_COUNT,
};

/* A row of the on-screen help, from the table below, which ends with a NULL text. */
struct neph_fly_help {
    const char *keys, *text;
};
extern const struct neph_fly_help neph_fly_help[];

/* The key of each preset, in the order of the presets. */
extern const char neph_fly_preset_keys[];

struct neph_fly_command_event {
    enum neph_fly_command command;
    int number;
};

enum { NEPH_FLY_WAYS = 6, NEPH_FLY_ORDERS_MAX = 32 };

/* Start from {.split_share = 0.5}. */
struct neph_controls {
    bool held[NEPH_FLY_WAYS];
    bool is_fast, turns, is_captured, drags;
    double turn_right_share, turn_up_share; /* in window heights, since the last motion */
    double wheel;                           /* notches since the last motion */
    double split_share;                     /* in window widths: position of the split line */
    struct neph_fly_command_event orders[NEPH_FLY_ORDERS_MAX];
    int order_count;
};

/* Take an event. Commands beyond NEPH_FLY_ORDERS_MAX between two frames are dropped. */
void neph_controls_add_event(struct neph_controls *controls, const struct neph_fly_event *event);

/* Remove and return the oldest command; NEPH_FLY_NOTHING: there is none. */
struct neph_fly_command_event neph_controls_take_command(struct neph_controls *controls);

/* The motion since the last call, from pressed keys and mouse motion. A mouse motion of one window
 * height turns the camera by its vertical field of view, so the point under the pointer stays
 * there. */
struct neph_fly_motion neph_controls_read_motion(struct neph_controls *controls, double time_s,
                                                 double vertical_fov_rad);

#endif
