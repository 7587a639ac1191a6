/* SPDX-License-Identifier: MIT
 *
 * How long an engine takes to a stated error, bias included, from the rungs of a ladder on which it
 * was measured. No law of the noise is assumed: within the ladder log error^2 is interpolated
 * linearly in log time, beyond it goes on as the noise did on the ladder, down to the bias.
 */
#ifndef NEPH_HARNESS_RUN_RMSE_TIME_H
#define NEPH_HARNESS_RUN_RMSE_TIME_H

/* One rung. The squares are relative and estimated without bias: all but noise2 may be below 0. */
struct neph_rmse_rung {
    double render_s;       /* > 0; on a busy machine more samples may take less of it */
    double noise2, error2; /* squared noise; squared error, which is noise2 and the squared bias */
    double bias2;          /* squared bias, from frames none of whose noise is in it twice */
    int samples;           /* of a pixel; no law needs them */
};

enum neph_rmse_found {
    NEPH_RMSE_WITHIN,  /* between two rungs */
    NEPH_RMSE_BEFORE,  /* the shortest rung is better already; extrapolated */
    NEPH_RMSE_BEYOND,  /* the longest rung is worse; extrapolated */
    NEPH_RMSE_NEVER,   /* the bias is larger, and significantly so */
    NEPH_RMSE_UNKNOWN, /* not within, and the bias may be larger, or the noise does not fall */
    NEPH_RMSE_FOUND_COUNT,
};

struct neph_rmse_time {
    double rmse;     /* the one asked for, relative */
    double render_s; /* finite; NaN: never, or unknown */
    enum neph_rmse_found found;
};

/* What a ladder says of the engine as a whole. */
struct neph_rmse_law {
    double slope;                        /* of log noise^2 in log time; -1: samples of chance;
                                            NaN: all rungs took the same time */
    double bias2, bias2_low, bias2_high; /* of all rungs, with its 95 % interval */
};

enum { NEPH_RMSE_RUNGS_MAX = 8 };

/* `count`: 2..NEPH_RMSE_RUNGS_MAX. */
struct neph_rmse_law neph_rmse_law_of(const struct neph_rmse_rung *rungs, int count);

/* Between two rungs that follow each other by their times. */
struct neph_rmse_time neph_rmse_time_to(const struct neph_rmse_rung *rungs, int count, double rmse);

/* "within", "before", "beyond", "never", "unknown". */
const char *neph_rmse_found_name(enum neph_rmse_found found);

#endif
