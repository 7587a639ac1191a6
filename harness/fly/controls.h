/* SPDX-License-Identifier: MIT
 *
 * From keys and mouse to what is meant by them. Knows no window and no scene.
 */
#ifndef NEPH_HARNESS_FLY_CONTROLS_H
#define NEPH_HARNESS_FLY_CONTROLS_H

#include "harness/fly/camera.h"
#include "harness/fly/event.h"

#include <stdbool.h>

enum neph_fly_command {
    NEPH_FLY_NOTHING,
    NEPH_FLY_PRESET, /* `number` is the preset's place */
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

/* A row of the help; keys of the table below. A NULL text ends it. */
struct neph_fly_help {
    const char *keys, *text;
};
extern const struct neph_fly_help neph_fly_help[];

struct neph_fly_order {
    enum neph_fly_command command;
    int number;
};

enum { NEPH_FLY_WAYS = 6, NEPH_FLY_ORDERS_MAX = 32 };

/* Start from {.split_share = 0.5}. */
struct neph_controls {
    bool held[NEPH_FLY_WAYS];
    bool is_fast, turns, is_captured, drags;
    double turn_right_share, turn_up_share; /* of the window's height, since the last motion */
    double wheel;                           /* notches, since the last motion */
    double split_share;                     /* of the window's width: where the wipe is split */
    struct neph_fly_order orders[NEPH_FLY_ORDERS_MAX];
    int order_count;
};

/* Orders beyond NEPH_FLY_ORDERS_MAX between two frames are dropped. */
void neph_controls_take(struct neph_controls *controls, const struct neph_fly_event *event);

/* The oldest order, removed; NEPH_FLY_NOTHING: there is none. */
struct neph_fly_order neph_controls_next(struct neph_controls *controls);

/* What is held and turned since the last call. A mouse that moves by the window's height turns the
 * camera by its vertical field of view: what is under the pointer stays there. */
struct neph_fly_motion neph_controls_motion(struct neph_controls *controls, double time_s,
                                            double vertical_fov_rad);

#endif
