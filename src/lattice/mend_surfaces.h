// Makes every tissue's surface (and that of the background) a 2-manifold by relabelling tetrahedra.
//
// At a vertex, the tetrahedra around it cut a small sphere into regions. The surface of a tissue is one sheet there
// when its region and the rest of the sphere are each in one piece (reached through faces at the vertex): then the
// region is a disk. The edges at such a vertex are sound, too. So a mesh without singular vertices has no singular
// edges.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "lattice/tet_complex.h"

namespace anatomesh {

/// How far the surfaces at a vertex are from one sheet each: over all tissues around it, background included, the
/// pieces beyond the first of its region and of the rest. 0 when the vertex is sound. About 1 us.
unsigned star_defect(const TetComplex& complex, VertexId v);

/// Vertices with a defect, in ascending order: all of them, or those among some.
std::vector<VertexId> singular_vertices(const TetComplex& complex);
std::vector<VertexId> singular_among(const TetComplex& complex, std::vector<VertexId> vertices);

/// Whether the tetrahedra of t's tissue behind its faces still hang together around it without t.
bool neighbours_hang_together(const TetComplex& complex, TetId t);

/// What relabelling a tetrahedron costs, in voxels; more than kTooDear: not to be done.
using RelabelPrice = std::function<double(TetId, TissueId)>;
inline constexpr double kTooDear = 1e6;

/// Relabels single tetrahedra at the singular vertices as long as that leaves fewer defects. No piece of a tissue is
/// split, joined to another, or lost; `pieces` stay true. Returns the vertices that are singular then; relabelled
/// tetrahedra are added to `changed`.
std::vector<VertexId> mend_single_tets(TetComplex& complex, Pieces& pieces, std::vector<VertexId> singular,
                                       const RelabelPrice& price, double max_price, std::vector<TetId>& changed);

/// How far one group of vertices goes: as long as there is a tissue that all of them touch, so that no tissue creeps
/// along a line away from itself; or as far as they touch common tetrahedra.
enum class Reach { one_tissue, any };

/// Gives the tetrahedra that touch these vertices to one tissue for each group of them: the one with most volume among
/// those allowed that neither joins two pieces nor makes one vanish. With Reach::any, where the vertices are all the
/// singular ones and the tetrahedra around them lie as in a regular neighbourhood, no defect is left. Groups of more
/// than max_tets tetrahedra are left alone. sizes: volumes of the tetrahedra. `pieces` stay true.
void mend_neighbourhoods(TetComplex& complex, Pieces& pieces, std::span<const VertexId> vertices, Reach reach,
                         std::span<const float> sizes, std::size_t max_tets, std::vector<TetId>& changed);

}  // namespace anatomesh
