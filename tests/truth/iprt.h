/* SPDX-License-Identifier: MIT
 *
 * The droplets of the water cloud of the International Polarized Radiative Transfer group (C. Emde
 * et al., "IPRT polarized radiative transfer model intercomparison project - Phase A", JQSRT 164,
 * 2015): optical depth 5 at 800 nm, effective radius 10 um, sun at 50 degrees. NEPH_IPRT_DATA names
 * the folder with its files; they are not part of this project. */
#ifndef NEPH_TESTS_TRUTH_IPRT_H
#define NEPH_TESTS_TRUTH_IPRT_H

#include "tests/neph_test.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { IPRT_ANGLES_MAX = 2000 };
struct iprt_phase {
    int count;
    double degrees[IPRT_ANGLES_MAX], values[IPRT_ANGLES_MAX]; /* the integral is 4 pi */
};

/* Opens a file of the folder; a test without it is skipped. */
static inline FILE *iprt_open(const char *name)
{
    const char *folder = getenv("NEPH_IPRT_DATA");
    char path[1024];
    snprintf(path, sizeof(path), "%s/%s", folder ? folder : "", name);
    FILE *file = folder ? fopen(path, "r") : NULL;
    if (!file) {
        print_message("not run: NEPH_IPRT_DATA names no folder with %s\n", name);
        skip();
    }
    return file;
}

/* The numbers of the line after the one that begins with `heading`. */
static inline int iprt_read_row(FILE *file, const char *heading, double *numbers)
{
    enum { LINE_BYTES = 1 << 16 };
    char *line = malloc(LINE_BYTES);
    int count = 0, used;
    while (fgets(line, LINE_BYTES, file) && strncmp(line, heading, strlen(heading)) != 0)
        continue;
    const char *at = fgets(line, LINE_BYTES, file);
    while (at && count < IPRT_ANGLES_MAX && sscanf(at, "%lf%n", &numbers[count], &used) == 1) {
        at += used;
        count++;
    }
    free(line);
    return count;
}

/* The phase function of its droplets. */
static inline void iprt_read_phase(struct iprt_phase *phase)
{
    FILE *file = iprt_open("watercloud.mie.dat");
    phase->count = iprt_read_row(file, "# Scattering angles", phase->degrees);
    assert_int_equal(iprt_read_row(file, "# Phase matrix P1:", phase->values), phase->count);
    assert_true(phase->count > 100);
    fclose(file);
}

#endif
