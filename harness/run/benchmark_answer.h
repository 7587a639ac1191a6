/* SPDX-License-Identifier: MIT
 *
 * What a benchmark answers: which engine is faster, by how much.
 */
#ifndef NEPH_HARNESS_RUN_BENCHMARK_ANSWER_H
#define NEPH_HARNESS_RUN_BENCHMARK_ANSWER_H

#include "harness/document/answer.h"
#include "harness/run/benchmark.h"
#include "harness/run/benchmark_frames.h"

/* "tracer: 12.3 times (10.1 to 14.9) as fast as cycles for the same noise", then a line for each
 * engine; nothing where the benchmark has no engine. */
void neph_benchmark_answer(const struct neph_benchmark *benchmark, struct neph_answer *answer);

/* "realtime: 12.3 ms a frame, 4.2 times as fast as march", likewise. */
void neph_benchmark_frames_answer(const struct neph_benchmark_frames *benchmark,
                                  struct neph_answer *answer);

#endif
