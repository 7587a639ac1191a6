/* SPDX-License-Identifier: MIT
 *
 * OpenVDB for C++ files that read or write grids. The library holds the code of the grids that it
 * registers; a compiler that is not told so makes all of it again, four fifths of its time. What
 * little the library lacks is inlined, by gcc from -O1 on; clang inlines less, and is not told.
 */
#ifndef NEPH_SCENES_OPENVDB_GRIDS_H
#define NEPH_SCENES_OPENVDB_GRIDS_H

#include <openvdb/openvdb.h>

#ifndef __clang__
extern template class openvdb::tree::Tree<openvdb::FloatTree::RootNodeType>;
extern template class openvdb::Grid<openvdb::FloatTree>;
extern template class openvdb::tree::Tree<openvdb::Vec3STree::RootNodeType>;
extern template class openvdb::Grid<openvdb::Vec3STree>;
#endif

#endif
