/* SPDX-License-Identifier: MIT
 *
 * OpenVDB for C++ files that read or write grids. The library contains compiled code for the grids
 * that it registers. These declarations stop gcc from compiling it again, which takes four fifths
 * of the build time. Functions that the library lacks are inlined by gcc from -O1 on; clang inlines
 * less, so it does not get the declarations.
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
