/* SPDX-License-Identifier: MIT
 *
 * A post-processing chain from a YAML file: order, settings and volumes.
 */
#ifndef NEPH_RENDERER_POST_PLAN_H
#define NEPH_RENDERER_POST_PLAN_H

#include "base/arena.h"
#include "base/status.h"
#include "renderer/post/chain.h"
#include "renderer/post/volumes.h"

#include <stdio.h>

/* An entry of the file's list of passes. */
struct neph_post_entry {
    enum neph_post_pass pass;
    bool is_on;
};

struct neph_post_plan {
    struct neph_arena arena;          /* of texts and volumes */
    const char *title;                /* NULL: none */
    const char *preset;               /* of neph_post_presets, applied first; NULL: none */
    struct neph_post_changes changes; /* applied after the preset */
    struct neph_post_entry entries[NEPH_POST_PASS_COUNT];
    int entry_count; /* 0: the usual order */
    struct neph_post_volume *volumes;
    int volume_count;
    struct neph_post_order order; /* of the enabled entries */
};

/* NEPH_ERR_INPUT with file, line and column, the value and the allowed values; NEPH_ERR_NOT_FOUND,
 * NEPH_ERR_IO, NEPH_ERR_MEMORY. Free with _finish. */
enum neph_status neph_post_plan_load(const char *path, struct neph_post_plan *plan,
                                     struct neph_diag *diag);
void neph_post_plan_finish(struct neph_post_plan *plan);

/* Preset and settings of the plan, without its volumes. */
struct neph_settings neph_post_plan_settings(const struct neph_post_plan *plan);

/* Whether the settings depend on the camera's position. */
bool neph_post_plan_needs_camera(const struct neph_post_plan *plan);

/* Print the keys as rows of a Markdown table. */
void neph_post_plan_print_keys(FILE *file);

#endif
