/* SPDX-License-Identifier: MIT
 *
 * The output of neph-mesh, whatever it contains. (A separate program reads mesh files and may
 * crash.)
 */
#include "tests/fuzz/fuzz.h"

#include "scenes/mesh_file.h"

#include <math.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct neph_mesh_data mesh = {0};
    struct neph_diag diag = {0};
    const enum neph_status status = neph_mesh_take(data, size, &mesh, &diag);
    fuzz_require_outcome(status, &diag, mesh.positions);
    fuzz_require(status == NEPH_OK || status == NEPH_ERR_INPUT, "the output is at fault");
    for (int v = 0; v < mesh.vertex_count; v++)
        fuzz_require(isfinite(mesh.positions[v].x) && isfinite(mesh.positions[v].y) &&
                         isfinite(mesh.positions[v].z),
                     "positions are finite");
    for (int t = 0; t < mesh.triangle_count; t++)
        for (int i = 0; i < 3; i++)
            fuzz_require(mesh.triangles[t][i] >= 0 && mesh.triangles[t][i] < mesh.vertex_count,
                         "indices are in range");
    neph_mesh_data_finish(&mesh);
    return 0;
}
