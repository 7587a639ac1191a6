/* SPDX-License-Identifier: MIT
 *
 * Volume files: the reader for each extension, and the checks for all of them.
 */
#include "scenes/volume_file.h"

#include "scenes/volume_format.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include <unistd.h>

static enum neph_status write_vdb(const char *path, const struct neph_grid *grid,
                                  struct neph_diag *diag)
{
    return neph_volume_write_vdb(path, grid, NEPH_VDB_WORLD, diag);
}

struct format {
    const char *extension;
    bool has_transform;
    neph_volume_reader *read;
    enum neph_status (*write)(const char *path, const struct neph_grid *grid,
                              struct neph_diag *diag);
};

static const struct format formats[] = {
    {".vdb", true, neph_volume_read_vdb, write_vdb},
    {".df3", false, neph_volume_read_df3, neph_volume_write_df3},
    {".nc", true, neph_volume_read_netcdf, NULL},
    {".dat", true, neph_volume_read_text, NULL},
    {".lwc", true, neph_volume_read_text, NULL},
    {".txt", true, neph_volume_read_text, NULL},
};
enum { FORMAT_COUNT = sizeof(formats) / sizeof(formats[0]) };

/* NULL when the extension is unknown. */
static const struct format *find_format(const char *path)
{
    const char *name = strrchr(path, '/');
    const char *extension = strrchr(name ? name : path, '.');
    for (int i = 0; extension && i < FORMAT_COUNT; i++)
        if (strcasecmp(extension, formats[i].extension) == 0)
            return &formats[i];
    return NULL;
}

static enum neph_status refuse_format(const char *shown, struct neph_diag *diag)
{
    neph_fail(diag, NEPH_ERR_INPUT, "'%s' is not a volume file that neph supports", shown);
    neph_hint(diag,
              "its name must end in .vdb or .df3, to be read also in .nc, .dat, .lwc or .txt");
    return NEPH_ERR_INPUT;
}

bool neph_volume_has_known_extension(const char *path)
{
    return find_format(path) != NULL;
}

bool neph_volume_is_netcdf(const char *path)
{
    const struct format *format = find_format(path);
    return format && format->read == neph_volume_read_netcdf;
}

bool neph_volume_is_text(const char *path)
{
    const struct format *format = find_format(path);
    return format && format->read == neph_volume_read_text;
}

bool neph_volume_has_transform(const char *path)
{
    const struct format *format = find_format(path);
    return format && format->has_transform;
}

enum neph_status neph_volume_write(const char *path, const struct neph_grid *grid,
                                   struct neph_diag *diag)
{
    const struct format *format = find_format(path);
    return format && format->write ? format->write(path, grid, diag) : refuse_format(path, diag);
}

/* O_NONBLOCK: a named pipe must be refused, not waited for. */
static enum neph_status open_file(const char *path, struct neph_volume_source *source,
                                  struct neph_diag *diag)
{
    const int fd = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    if (fd < 0)
        return neph_fail(diag, errno == ENOENT ? NEPH_ERR_NOT_FOUND : NEPH_ERR_IO, "%s",
                         strerror(errno));
    struct stat info;
    FILE *opened = NULL;
    enum neph_status status = NEPH_OK;
    if (fstat(fd, &info) != 0)
        status = neph_fail(diag, NEPH_ERR_IO, "%s", strerror(errno));
    else if (!S_ISREG(info.st_mode))
        status = neph_fail(diag, NEPH_ERR_INPUT, "not a regular file");
    else if (!(opened = fdopen(fd, "rb")))
        status = neph_fail_memory(diag);
    if (status) {
        close(fd);
        return status;
    }
    *source = (struct neph_volume_source){opened, (size_t)info.st_size};
    return NEPH_OK;
}

static enum neph_status read_and_seal(neph_volume_reader *read,
                                      const struct neph_volume_request *request,
                                      const struct neph_volume_source *source,
                                      struct neph_grid **grid, struct neph_diag *diag)
{
    struct neph_grid *made = NULL;
    enum neph_status status = read(request, source, &made, diag);
    if (!status) {
        if (request->interpolation)
            made->is_constant = request->interpolation == NEPH_INTERPOLATION_CONSTANT;
        memcpy(made->is_endless, request->is_endless, sizeof(made->is_endless));
        status = neph_grid_seal(made, diag);
    }
    if (status)
        neph_grid_destroy(made);
    else
        *grid = made;
    return status;
}

enum neph_status neph_volume_read(const struct neph_volume_request *request,
                                  struct neph_grid **grid, struct neph_diag *diag)
{
    const char *shown = request->shown ? request->shown : request->path;
    const struct format *format = find_format(request->path);
    if (!format && !request->table_size)
        return refuse_format(shown, diag);
    neph_volume_reader *read = request->table_size ? neph_volume_read_text : format->read;
    struct neph_diag inner = {.line = 0};
    struct neph_volume_source source = {.file = NULL};
    enum neph_status status = open_file(request->path, &source, &inner);
    if (!status)
        status = read_and_seal(read, request, &source, grid, &inner);
    if (source.file)
        fclose(source.file);
    if (status) {
        neph_fail(diag, status, "cannot read the volume '%s': %s", shown, inner.message);
        if (inner.hint[0])
            neph_hint(diag, "%s", inner.hint);
    }
    return status;
}
