/* SPDX-License-Identifier: MIT
 *
 * The render time that an engine needs for a given error, bias included, from measured sample
 * levels. Within the levels log error^2 is interpolated linearly over log time, without a model of
 * the noise. Beyond them the noise is extrapolated with its measured slope, down to the bias.
 */
#ifndef NEPH_HARNESS_RUN_RMSE_TIME_H
#define NEPH_HARNESS_RUN_RMSE_TIME_H

/* One level: a number of samples. The squares are relative and estimated without bias, so all
 * except noise2 can be negative. */
struct neph_rmse_level {
    double render_s;       /* > 0; can fall with more samples on a busy machine */
    double noise2, error2; /* squared noise; squared error = noise2 + squared bias */
    double bias2;          /* squared bias, from four frames with independent noise */
    int samples;           /* per pixel; not used in any formula */
};

enum neph_rmse_found {
    NEPH_RMSE_WITHIN,  /* between two levels */
    NEPH_RMSE_BEFORE,  /* below the shortest level's time; extrapolated */
    NEPH_RMSE_BEYOND,  /* above the longest level's time; extrapolated */
    NEPH_RMSE_NEVER,   /* the bias is significantly larger */
    NEPH_RMSE_UNKNOWN, /* beyond the levels, and the bias may be larger or the noise does not fall
                          */
    NEPH_RMSE_FOUND_COUNT,
};

struct neph_rmse_time {
    double rmse;     /* the requested error, relative */
    double render_s; /* finite; NaN: NEVER or UNKNOWN */
    enum neph_rmse_found found;
};

/* Fit over all levels. */
struct neph_rmse_law {
    double slope;                        /* of log noise^2 over log time; -1: independent samples;
                                            NaN: all levels took the same time */
    double bias2, bias2_low, bias2_high; /* weighted mean over all levels, with its 95 % interval */
};

enum { NEPH_RMSE_LEVELS_MAX = 8 };

/* `count` is in 2..NEPH_RMSE_LEVELS_MAX. */
struct neph_rmse_law neph_rmse_law_fit(const struct neph_rmse_level *rungs, int count);

/* Sorts the levels by time and searches the pair that encloses the error. `count` as above. */
struct neph_rmse_time neph_rmse_time_to(const struct neph_rmse_level *rungs, int count,
                                        double rmse);

/* "within", "before", "beyond", "never", "unknown". */
const char *neph_rmse_found_name(enum neph_rmse_found found);

#endif
