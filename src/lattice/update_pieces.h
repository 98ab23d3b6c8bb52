// Keeps the pieces of a complex true while a few of its tetrahedra change.
#pragma once

#include <span>

#include "lattice/tet_complex.h"

namespace anatomesh {

/// Makes pieces true again that were so before some tetrahedra (each once) were relabelled, added or dropped. Pieces
/// keep their numbers where they can; of two that are joined now, the larger one does. What is gone stays in the list
/// without tetrahedra; `first` is not kept. Cost: by what has changed, and of what has fallen apart or been joined by
/// the smaller part.
void update_pieces(const TetComplex& complex, Pieces& pieces, std::span<const TetId> changed);

}  // namespace anatomesh
