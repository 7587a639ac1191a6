/* SPDX-License-Identifier: MIT
 *
 * Numbers of other programs beside neph's, measured by these programs from the same frames:
 * `--partner cvvdp` is the JOD of ColorVideoVDP (Mantiuk et al., SIGGRAPH 2024).
 */
#ifndef NEPH_HARNESS_COMPARE_PARTNER_H
#define NEPH_HARNESS_COMPARE_PARTNER_H

#include "harness/compare/frame.h"
#include "harness/compare/sequence.h"
#include "harness/json.h"
#include "metrics/extractor.h"

#include <stdio.h>

/* A display model of the file display_models.json of ColorVideoVDP. */
struct neph_partner_display {
    const char *name;
    bool
        is_linear; /* it takes cd/m2: 2^EV * white * value; else sRGB codes of 2^EV * value, clamped
                       to 0..1 */
};

/* The display of a word "cvvdp" (its default, standard_4k) or "cvvdp:DISPLAY". NEPH_ERR_USAGE:
 * another program or display; the message lists them. */
enum neph_status neph_partner_find(const char *word, const struct neph_partner_display **display,
                                   struct neph_diag *diag);

/* The frames that the program gets. */
struct neph_partner_job {
    const struct neph_partner_display *display;
    const struct neph_sequence *reference; /* one frame for all, or as many as the test has */
    const struct neph_sequence *test;
    const struct neph_sequence *other; /* another test with as many frames; count 0: none */
    int first;                         /* number of frames left out at the start */
    bool is_sequence;                  /* one number for the whole sequence; else one for each
                                          frame */
    struct neph_frame_choice choice;
    size_t negative_allowed; /* as for neph_frame_read() */
    struct neph_viewing viewing;
    bool with_pixels_per_degree; /* those of `viewing`, else those of the display */
    double time_limit_s;         /* of the program; <= 0: by the number of pixels */
};

/* JOD: 10 is no visible difference; it may be negative. */
struct neph_partner_value {
    int frame;          /* after those left out, from 0; -1: the sequence */
    double test, other; /* NaN: there is no other test */
};

/* Start from {0}; free with neph_partner_finish(). */
struct neph_partner_numbers {
    const struct neph_partner_display *display; /* NULL: not asked for */
    struct neph_viewing viewing;
    char not_measured[1024]; /* the reason; "": measured */
    char hint[512];          /* the way out; or "" */
    char conditions[256]; /* as the program states them: version, pixels per degree, luminances */
    char version[32];
    struct neph_partner_value *list; /* owned */
    int count;
};

/* Write the frames as EXR into a folder in TMPDIR, run the program, and remove the folder.
 * `numbers` has the values, or the reason why there are none, whatever the status is.
 *
 * NEPH_ERR_UNAVAILABLE: the program is not in PATH. NEPH_ERR_UNSUPPORTED: the frames lack R, G and
 * B, are for an HDR display, or are too many. NEPH_ERR_ENGINE: the program failed, or its output
 * is not understood. NEPH_ERR_TIMEOUT, NEPH_ERR_INTERRUPTED; errors of neph_frame_read(). */
enum neph_status neph_partner_run(const struct neph_partner_job *job,
                                  struct neph_partner_numbers *numbers, struct neph_diag *diag);
void neph_partner_finish(struct neph_partner_numbers *numbers);

/* Print one line; nothing if the program was not asked for. Returns the number of lines. */
int neph_partner_print(const struct neph_partner_numbers *numbers, FILE *out);

/* {"name": "cvvdp_jod", "unit", "program", "display", "frames_as", "version", "conditions",
 * "values": [{"frame", "test", "other"}], "not_measured"}. `frame` is absent for a sequence, and
 * `other` without another test. `not_measured` is null, or the reason why there are no values,
 * version and conditions. */
json_t *neph_partner_json(const struct neph_partner_numbers *numbers);

#endif
