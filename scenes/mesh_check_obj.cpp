/* SPDX-License-Identifier: MIT
 *
 * The lines of an OBJ file: vertices are finite numbers, and faces name vertices that exist.
 */
#include "scenes/mesh_check.h"

#include <cfloat>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <fstream>

namespace
{

/* What a face names: vertices, texture coordinates, normals. `numbers_min`: of its line. */
struct kind {
    const char *keyword, *name;
    int numbers_min;
};

constexpr kind kinds[] = {{"v", "vertex", 3}, {"vt", "texture coordinate", 1}, {"vn", "normal", 3}};
constexpr int kind_count = 3;

class obj_lines
{
  public:
    obj_lines(const char *path, const mesh_limits &of_neph) : file(path), limits(of_neph)
    {
    }

    /* The number of faces. A line that ends in a backslash goes on in the next one. */
    int64_t check()
    {
        for (std::string line, more; std::getline(file, line);) {
            number++;
            while (trim(line) && std::getline(file, more)) {
                number++;
                line.back() = ' ';
                line += more;
            }
            check_line(line.c_str() + strspn(line.c_str(), " \t"));
        }
        for (int k = 0; k < kind_count; k++)
            if (largest[k] > counts[k])
                throw bad_file(words("line %lld: a face names %s %lld, and there are %lld",
                                     static_cast<long long>(largest_line[k]), kinds[k].name,
                                     static_cast<long long>(largest[k]),
                                     static_cast<long long>(counts[k])));
        return faces;
    }

  private:
    /* Whether a line without the end of a DOS line goes on. */
    static bool trim(std::string &line)
    {
        if (!line.empty() && line.back() == '\r')
            line.pop_back();
        return !line.empty() && line.back() == '\\';
    }
    [[noreturn]] void refuse(const char *line, const char *what) const
    {
        throw bad_file(words("line %lld, '%.60s': %s", static_cast<long long>(number), line, what));
    }

    void check_line(const char *line)
    {
        const size_t length = strcspn(line, " \t");
        for (int k = 0; k < kind_count; k++)
            if (length == strlen(kinds[k].keyword) && memcmp(line, kinds[k].keyword, length) == 0) {
                check_numbers(line, line + length, kinds[k].numbers_min);
                counts[k]++;
            }
        if (length == 1 && line[0] == 'f')
            check_face(line, line + length);
        if (counts[0] > limits.vertices_max)
            refuse_triangles(limits);
    }

    void check_numbers(const char *line, const char *at, int numbers_min) const
    {
        for (int i = 0; i < numbers_min; i++) {
            char *end = nullptr;
            const double value = strtod(at, &end);
            if (end == at || !strchr(" \t", *end))
                refuse(line, words("it must have %d numbers", numbers_min).c_str());
            if (!(std::fabs(value) <= static_cast<double>(FLT_MAX)))
                refuse(line, "a number is not finite");
            at = end;
        }
    }

    /* Corners are v, v/vt, v//vn or v/vt/vn; an index below 0 counts from the last one back. */
    void check_face(const char *line, const char *at)
    {
        int corners = 0;
        for (at += strspn(at, " \t"); *at; at += strspn(at, " \t"), corners++)
            for (int k = 0; k < kind_count; k++) {
                char *end = nullptr;
                const long long index = strtoll(at, &end, 10);
                if (end == at && !(k == 1 && *at == '/'))
                    refuse(line, "a corner is an index, or several with / between");
                if (end != at)
                    check_index(line, k, index);
                at = end == at ? at : end;
                if (*at != '/') {
                    if (!strchr(" \t", *at))
                        refuse(line, "a corner is an index, or several with / between");
                    break;
                }
                at++;
            }
        if (corners < 3)
            refuse(line, "a face has three corners or more");
        if (++faces > limits.triangles_max)
            refuse_triangles(limits);
    }

    void check_index(const char *line, int k, int64_t index)
    {
        if (index == 0 || index < -counts[k])
            refuse(
                line,
                words("there is no %s %lld", kinds[k].name, static_cast<long long>(index)).c_str());
        if (index > largest[k]) {
            largest[k] = index;
            largest_line[k] = number;
        }
    }

    std::ifstream file;
    const mesh_limits &limits;
    int64_t number = 0, faces = 0; /* of the line; so far */
    int64_t counts[kind_count] = {}, largest[kind_count] = {}, largest_line[kind_count] = {};
};

} // namespace

int64_t check_obj(const char *path, const mesh_limits &limits)
{
    return obj_lines(path, limits).check();
}
