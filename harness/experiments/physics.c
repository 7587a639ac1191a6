/* SPDX-License-Identifier: MIT
 *
 * `neph validate --suite physics`: engines against references that need no renderer.
 */
#include "harness/experiments/validate.h"

#include "harness/physics/physics.h"

/* Put the suite into the report of a validation without scenes. */
static void take(struct neph_physics *physics, struct neph_validation *validation)
{
    validation->title = "Nephelometer physics suite";
    validation->physics = physics;
    validation->verdict = physics->passes ? NEPH_VERDICT_PASS : NEPH_VERDICT_FAIL;
    validation->counts = (struct neph_counts){
        .expected = physics->expected, .reported = physics->row_count, .compared = physics->tests};
    validation->seconds = physics->seconds;
}

static enum neph_status run(void *request_, const struct neph_experiment_run *run,
                            struct neph_publication *publication, struct neph_diag *diag)
{
    const struct neph_validate_request *request = request_;
    const struct neph_validate_params about = neph_validate_make_params(request, run);
    const struct neph_physics_params params = {.engines = request->engines.words,
                                               .engine_count = request->engines.count,
                                               .only = request->only.words,
                                               .only_count = request->only.count,
                                               .jobs = request->shared.jobs,
                                               .samples = request->samples < 0 ? 256
                                                                               : request->samples,
                                               .time_limit_s = (int)about.budget_s,
                                               .device = run->device,
                                               .quiet = run->quiet};
    struct neph_validation validation = {.title = NULL};
    struct neph_physics physics = {.rows = NULL};
    enum neph_status status = neph_validate(&about, run->store, &validation, diag);
    if (!status)
        status = neph_physics_run(&params, run->store, &physics, diag);
    if (!status)
        take(&physics, &validation);
    status = neph_validate_publish(request, &validation, publication, status, diag);
    neph_validation_finish(&validation);
    neph_physics_finish(&physics);
    return status;
}

const struct neph_experiment neph_experiment_physics = {
    .prepare = neph_validate_open_report, .run = run, .finish = neph_validate_close_report};
