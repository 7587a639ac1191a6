/* SPDX-License-Identifier: MIT */
extern "C" {
#include "base/colour_convert.h"
#include "base/files.h"
}
#include "metrics/colour_config.h"
#include "metrics/ocio.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <string>
#include <unistd.h>
#include <utility>
#include <vector>

namespace ocio = OCIO_NAMESPACE;

namespace
{

constexpr uint64_t config_bytes_max = 16u << 20;
constexpr size_t listed_max = 8;

struct colour_config : neph_colour_source {
    std::string path, name, space; /* `space` empty: by the role */
    ocio::ConstConfigRcPtr config;
    ocio::ConstContextRcPtr variables;
};

const colour_config *as_config(const void *context)
{
    return static_cast<const colour_config *>(context);
}

/* ---- names ----------------------------------------------------------------------------------- */

char lower(char letter)
{
    return static_cast<char>(std::tolower(static_cast<unsigned char>(letter)));
}

/* Levenshtein's distance: insertions, deletions and replacements of letters in any case. */
size_t edit_distance(const std::string &a, const std::string &b)
{
    std::vector<size_t> row(b.size() + 1);
    for (size_t j = 0; j <= b.size(); j++)
        row[j] = j;
    for (size_t i = 1; i <= a.size(); i++) {
        size_t diagonal = std::exchange(row[0], i);
        for (size_t j = 1; j <= b.size(); j++) {
            const size_t replaced = diagonal + (lower(a[i - 1]) != lower(b[j - 1]));
            diagonal = row[j];
            row[j] = std::min({row[j] + 1, row[j - 1] + 1, replaced});
        }
    }
    return row[b.size()];
}

/* The names of spaces that are most similar to a name. */
std::string list_similar_names(const ocio::ConstConfigRcPtr &config, const std::string &name)
{
    std::vector<std::pair<size_t, std::string>> names;
    for (int i = 0; i < config->getNumColorSpaces(); i++) {
        const char *known = config->getColorSpaceNameByIndex(i);
        names.emplace_back(edit_distance(name, known), known);
    }
    std::sort(names.begin(), names.end());
    std::string list = names.size() > listed_max ? "the most similar names are " : "it has ";
    for (size_t i = 0; i < names.size() && i < listed_max; i++)
        list += (i ? ", " : "") + names[i].second;
    return list;
}

enum neph_status refuse_name(const colour_config &self, const char *name, struct neph_diag *diag)
{
    neph_fail(diag, NEPH_ERR_INPUT, "the OpenColorIO config '%s' has no colour space '%s'",
              self.path.c_str(), name);
    neph_hint(diag, "%s", list_similar_names(self.config, name).c_str());
    return NEPH_ERR_INPUT;
}

enum neph_status find_space(void *context, const char *name, const char **space,
                            struct neph_diag *diag)
{
    const colour_config *self = as_config(context);
    return neph_ocio::run(self->path.c_str(), diag, [&] {
        const ocio::ConstColorSpaceRcPtr found = self->config->getColorSpace(name);
        if (!found)
            return refuse_name(*self, name, diag);
        *space = found->getName(); /* of the config */
        return NEPH_OK;
    });
}

/* ---- conversion ------------------------------------------------------------------------------ */

ocio::ConstTransformRcPtr make_transform(const colour_config &self, const char *space)
{
    const ocio::ColorSpaceTransformRcPtr named = ocio::ColorSpaceTransform::Create();
    const ocio::GroupTransformRcPtr group = ocio::GroupTransform::Create();
    named->setSrc(space);
    named->setDst(self.space.empty() ? ocio::ROLE_INTERCHANGE_SCENE : self.space.c_str());
    group->appendTransform(named);
    if (self.space.empty())
        group->appendTransform(neph_ocio::make_aces_matrix(ocio::TRANSFORM_DIR_FORWARD));
    return group;
}

enum neph_status check_finite(const colour_config &self, const char *space,
                              const float *const planes[3], const int size_px[2],
                              struct neph_diag *diag)
{
    const size_t width = static_cast<size_t>(size_px[0]),
                 count = width * static_cast<size_t>(size_px[1]);
    for (size_t c = 0; c < 3; c++)
        for (size_t i = 0; i < count; i++)
            if (!std::isfinite(planes[c][i]))
                return neph_fail(diag, NEPH_ERR_INPUT,
                                 "the space '%s' of '%s' gives no finite number for the pixel "
                                 "(%zu, %zu)",
                                 space, self.path.c_str(), i % width, i / width);
    return NEPH_OK;
}

enum neph_status convert(void *context, const char *space, float *const planes[3],
                         const int size_px[2], struct neph_diag *diag)
{
    const colour_config *self = as_config(context);
    return neph_ocio::run(self->path.c_str(), diag, [&] {
        if (self->config->getColorSpace(space)->isData())
            return neph_fail(diag, NEPH_ERR_INPUT, "the space '%s' of '%s' is data, no colour",
                             space, self->path.c_str());
        const ocio::ConstTransformRcPtr whole = make_transform(*self, space);
        const enum neph_status status = neph_ocio::check_transform(self->config, self->variables,
                                                                   whole, diag);
        if (status)
            return status;
        const ocio::ConstProcessorRcPtr processor = self->config->getProcessor(
            self->variables, whole, ocio::TRANSFORM_DIR_FORWARD);
        if (neph_ocio::count_nan_entries(processor) > 0)
            return neph_fail(diag, NEPH_ERR_INPUT, "the space '%s' of '%s' has a table with NaN",
                             space, self->path.c_str());
        ocio::PlanarImageDesc image(planes[0], planes[1], planes[2], nullptr, size_px[0],
                                    size_px[1]);
        processor->getOptimizedCPUProcessor(neph_ocio::optimization)->apply(image);
        return check_finite(*self, space, planes, size_px, diag);
    });
}

/* ---- the config ------------------------------------------------------------------------------ */

enum neph_status check_size(const char *path, struct neph_diag *diag)
{
    int fd;
    uint64_t bytes;
    const enum neph_status status = neph_file_open(path, &fd, &bytes, diag);
    if (status)
        return status;
    close(fd);
    if (bytes <= config_bytes_max)
        return NEPH_OK;
    return neph_fail(diag, NEPH_ERR_INPUT,
                     "'%s' has %llu bytes, more than the 16 MiB of an OpenColorIO config", path,
                     static_cast<unsigned long long>(bytes));
}

/* The context of the config without the variables of the shell. */
ocio::ConstContextRcPtr make_context(const ocio::ConstConfigRcPtr &config)
{
    const ocio::ContextRcPtr context = config->getCurrentContext()->createEditableCopy();
    context->clearStringVars();
    for (int i = 0; i < config->getNumEnvironmentVars(); i++) {
        const char *name = config->getEnvironmentVarNameByIndex(i);
        context->setStringVar(name, config->getEnvironmentVarDefault(name));
    }
    return context;
}

enum neph_status check_rec709(const colour_config &self, struct neph_diag *diag)
{
    if (!self.space.empty())
        return self.config->getColorSpace(self.space.c_str())
                   ? NEPH_OK
                   : refuse_name(self, self.space.c_str(), diag);
    if (self.config->hasRole(ocio::ROLE_INTERCHANGE_SCENE))
        return NEPH_OK;
    neph_fail(diag, NEPH_ERR_INPUT,
              "the OpenColorIO config '%s' has no role aces_interchange: which of its spaces is "
              "linear Rec.709?",
              self.path.c_str());
    neph_hint(diag, "name it by --space; %s",
              list_similar_names(self.config, "Linear Rec.709").c_str());
    return NEPH_ERR_INPUT;
}

enum neph_status fill(colour_config *self, const char *path, const char *space,
                      struct neph_diag *diag)
{
    self->path = path;
    self->name = self->path.substr(self->path.rfind('/') + 1);
    self->space = space ? space : "";
    self->config = ocio::Config::CreateFromFile(path);
    self->variables = make_context(self->config);
    self->context = self;
    self->label = self->name.c_str();
    self->find = find_space;
    self->convert = convert;
    return check_rec709(*self, diag);
}

} // namespace

enum neph_status neph_colour_config_open(const char *path, const char *space,
                                         struct neph_colour_source **source, struct neph_diag *diag)
{
    colour_config *made = nullptr;
    enum neph_status status = check_size(path, diag);
    if (!status)
        status = neph_ocio::run(path, diag, [&] {
            made = new colour_config();
            return fill(made, path, space, diag);
        });
    if (status)
        neph_colour_config_close(made);
    else
        *source = made;
    return status;
}

void neph_colour_config_close(struct neph_colour_source *source)
{
    delete static_cast<colour_config *>(source);
}
