/* SPDX-License-Identifier: MIT
 *
 * The summary lines of a benchmark for `neph benchmark`: which engine is faster, and by how much.
 */
#ifndef NEPH_HARNESS_RUN_BENCHMARK_ANSWER_H
#define NEPH_HARNESS_RUN_BENCHMARK_ANSWER_H

#include "harness/document/answer.h"
#include "harness/run/benchmark.h"
#include "harness/run/benchmark_frames.h"

/* Adds "tracer: 12.3 times (10.1 to 14.9) as fast as cycles for the same noise" for each further
 * engine, then one line for each engine. Adds nothing for a benchmark without engines. */
void neph_benchmark_answer(const struct neph_benchmark *benchmark, struct neph_answer *answer);

/* Adds "realtime: 4.2 times as fast as march, 12.3 ms a frame against 51.7 ms" for each further
 * engine, then one line for each engine. */
void neph_benchmark_frames_answer(const struct neph_benchmark_frames *benchmark,
                                  struct neph_answer *answer);

#endif
