/* SPDX-License-Identifier: MIT
 *
 * Common parts of the C++ files that use OpenColorIO: display.cpp, display_cube.cpp and
 * colour_config.cpp. Only these, ocio.cpp and ocio_check.cpp include this file; no exception leaves
 * the first three.
 */
#ifndef NEPH_METRICS_OCIO_H
#define NEPH_METRICS_OCIO_H

extern "C" {
#include "base/status.h"
}

#include <exception>
#include <new>

#include <OpenColorIO/OpenColorIO.h>

namespace neph_ocio
{

namespace ocio = OCIO_NAMESPACE;

/* All optimizations but approximate log, exp and pow: results must not depend on the CPU. */
constexpr auto optimization = ocio::OPTIMIZATION_LOSSLESS;

/* Count the NaN values in the tables of a processor: OpenColorIO silently treats them as 0. */
int count_nan_entries(const ocio::ConstProcessorRcPtr &processor);

/* The matrix from ACES2065-1, the space of the role aces_interchange, to linear Rec.709 with white
 * D65 (base/chromaticities.h). */
ocio::MatrixTransformRcPtr make_aces_matrix(ocio::TransformDirection direction);

/* Refuse spaces and looks that are defined by themselves, for which OpenColorIO has no end, and
 * tables that are no regular files or larger than 512 MiB. `variables` are those of the paths. A
 * missing table is OpenColorIO's exception. */
enum neph_status check_transform(const ocio::ConstConfigRcPtr &config,
                                 const ocio::ConstContextRcPtr &variables,
                                 const ocio::ConstTransformRcPtr &transform,
                                 struct neph_diag *diag);

/* Run `work`, which returns a status; exceptions become errors about the config of this path. */
template <typename Work>
enum neph_status run(const char *config, struct neph_diag *diag, const Work &work)
{
    try {
        return work();
    } catch (const std::bad_alloc &) {
        return neph_fail_memory(diag);
    } catch (const std::exception &error) {
        return neph_fail(diag, NEPH_ERR_INPUT, "OpenColorIO, of '%s': %s", config, error.what());
    } catch (...) {
        return neph_fail(diag, NEPH_ERR_INTERNAL, "OpenColorIO failed without a word");
    }
}

} // namespace neph_ocio

#endif
