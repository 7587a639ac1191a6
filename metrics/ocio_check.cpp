/* SPDX-License-Identifier: MIT
 *
 * What OpenColorIO itself does not check before it makes a processor.
 */
extern "C" {
#include "base/files.h"
}
#include "metrics/ocio.h"

#include <cstring>
#include <map>
#include <string>
#include <unistd.h>

namespace ocio = OCIO_NAMESPACE;

namespace
{

constexpr uint64_t table_bytes_max = 512u << 20;

/* A walk over transforms and the spaces and looks that they name, each entered once. */
struct walk {
    const ocio::ConstConfigRcPtr &config;
    const ocio::ConstContextRcPtr &variables;
    struct neph_diag *diag;
    std::map<std::string, bool> entered; /* true: all that it names was entered, too */

    enum neph_status enter_space(const char *name);
    enum neph_status enter_looks(const char *text);
    enum neph_status enter_view(const ocio::DisplayViewTransform &view);
    enum neph_status enter_file(const char *source) const;
    enum neph_status enter(const ocio::ConstTransformRcPtr &transform);
    enum neph_status enter_pair(const char *from, const char *to);
    /* Run `inside`, which enters what `name` names. */
    template <typename Inside>
    enum neph_status enter_named(const std::string &name, const Inside &inside);
};

template <typename Inside>
enum neph_status walk::enter_named(const std::string &name, const Inside &inside)
{
    const auto [place, is_new] = entered.emplace(name, false);
    if (!is_new && !place->second) {
        neph_fail(diag, NEPH_ERR_INPUT, "'%s' of the OpenColorIO config is defined by itself",
                  name.c_str());
        neph_hint(diag, "its ColorSpaceTransforms and looks must not form a ring");
        return NEPH_ERR_INPUT;
    }
    const enum neph_status status = is_new ? inside() : NEPH_OK;
    entered[name] = true;
    return status;
}

enum neph_status walk::enter_space(const char *name)
{
    const ocio::ConstColorSpaceRcPtr space = config->getColorSpace(
        variables->resolveStringVar(name));
    if (!space) /* OpenColorIO's error names it */
        return NEPH_OK;
    return enter_named(space->getName(), [&] {
        const enum neph_status status = enter(
            space->getTransform(ocio::COLORSPACE_DIR_TO_REFERENCE));
        return status ? status : enter(space->getTransform(ocio::COLORSPACE_DIR_FROM_REFERENCE));
    });
}

enum neph_status walk::enter_pair(const char *from, const char *to)
{
    const enum neph_status status = enter_space(from);
    return status ? status : enter_space(to);
}

/* Looks whose names are in the text of a LookTransform, such as "warm, -contrast". */
enum neph_status walk::enter_looks(const char *text)
{
    enum neph_status status = NEPH_OK;
    for (int i = 0; i < config->getNumLooks() && !status; i++) {
        const char *name = config->getLookNameByIndex(i);
        if (!std::strstr(text, name))
            continue;
        status = enter_named(std::string("look ") + name, [&] {
            const ocio::ConstLookRcPtr look = config->getLook(name);
            enum neph_status inside = enter_space(look->getProcessSpace());
            if (!inside)
                inside = enter(look->getTransform());
            return inside ? inside : enter(look->getInverseTransform());
        });
    }
    return status;
}

enum neph_status walk::enter_view(const ocio::DisplayViewTransform &view)
{
    const char *display = view.getDisplay();
    enum neph_status status = enter_pair(
        view.getSrc(), config->getDisplayViewColorSpaceName(display, view.getView()));
    return status ? status : enter_space(display); /* a view may have its display's space */
}

enum neph_status walk::enter_file(const char *source) const
{
    const char *path = variables->resolveFileLocation(source);
    int fd;
    uint64_t bytes;
    if (!neph_path_exists(path)) /* in an archive */
        return NEPH_OK;
    const enum neph_status status = neph_file_open(path, &fd, &bytes, diag);
    if (status)
        return status;
    close(fd);
    return bytes <= table_bytes_max
               ? NEPH_OK
               : neph_fail(diag, NEPH_ERR_INPUT, "the table '%s' has %llu bytes, more than 512 MiB",
                           path, static_cast<unsigned long long>(bytes));
}

enum neph_status walk::enter(const ocio::ConstTransformRcPtr &transform)
{
    enum neph_status status = NEPH_OK;
    if (const auto group = OCIO_DYNAMIC_POINTER_CAST<const ocio::GroupTransform>(transform))
        for (int i = 0; i < group->getNumTransforms() && !status; i++)
            status = enter(group->getTransform(i));
    else if (const auto file = OCIO_DYNAMIC_POINTER_CAST<const ocio::FileTransform>(transform))
        status = enter_file(file->getSrc());
    else if (const auto pair = OCIO_DYNAMIC_POINTER_CAST<const ocio::ColorSpaceTransform>(
                 transform))
        status = enter_pair(pair->getSrc(), pair->getDst());
    else if (const auto look = OCIO_DYNAMIC_POINTER_CAST<const ocio::LookTransform>(transform)) {
        status = enter_pair(look->getSrc(), look->getDst());
        if (!status)
            status = enter_looks(variables->resolveStringVar(look->getLooks()));
    } else if (const auto view = OCIO_DYNAMIC_POINTER_CAST<const ocio::DisplayViewTransform>(
                   transform))
        status = enter_view(*view);
    return status;
}

} // namespace

enum neph_status neph_ocio::check_transform(const ocio::ConstConfigRcPtr &config,
                                            const ocio::ConstContextRcPtr &variables,
                                            const ocio::ConstTransformRcPtr &transform,
                                            struct neph_diag *diag)
{
    walk walked = {config, variables, diag, {}};
    return walked.enter(transform);
}
