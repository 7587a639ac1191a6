/* SPDX-License-Identifier: MIT
 *
 * Phase functions as tables for shaders/phase_table.glsl: all kinds that have no file of their own
 * there. A table has its number of rows, its mean cosine, the distance to the next one, and per row
 * the versine 1 - cos, the phase function [1/sr] and the light within that angle, 0..1. Where the
 * channels differ, the table of their mean is in front of theirs; else the distance is 0. All
 * tables of a phase function have equal angles. Private to renderer/.
 */
#ifndef NEPH_RENDERER_PHASE_TABLES_H
#define NEPH_RENDERER_PHASE_TABLES_H

#include "scenes/phase.h"

#include <stddef.h>

/* The number of floats of the table; 0: the kind has a file in shaders/. */
size_t neph_gpu_phase_table_size(const struct neph_phase *phase);

/* Writes them. A formula becomes NEPH_TABULATED_ROWS_MAX - 1 rows, dense towards both peaks; the
 * straight lines between them are within 1e-4 of it. */
void neph_gpu_phase_table_write(const struct neph_phase *phase, float *values);

#endif
