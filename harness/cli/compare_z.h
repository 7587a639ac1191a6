/* SPDX-License-Identifier: MIT
 *
 * `neph compare --z`: whether two renders by Monte Carlo differ by more than their noise.
 */
#ifndef NEPH_HARNESS_CLI_COMPARE_Z_H
#define NEPH_HARNESS_CLI_COMPARE_Z_H

#include "harness/compare/noisy_render.h"
#include "harness/document/junit.h"

struct neph_cli_z {
    const struct neph_sequence *reference, *test; /* all files of each are one render */
    struct neph_noisy_reading reading;
    const char *window; /* mode of differing data windows: neph_windows_find() */
    const char *maps;   /* folder for the map of scores; NULL: none */
    const char *group;  /* of the test case */
    bool json, quiet, all;
};

/* Compare and print. Adds a case to `junit`. NEPH_ERR_GATE: a bias was found. */
enum neph_status neph_cli_z_run(const struct neph_cli_z *request, struct neph_junit *junit,
                                struct neph_diag *diag);

#endif
