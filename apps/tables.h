// What is measured of a mesh, as tables for people.
#pragma once

#include <string>

#include "anatomesh/assess.h"

namespace anatomesh::apps {

/// Which tissues get a row of their own: all, or the worst of them where they are many.
enum class TissueRows { worst, all };

/// Quality, fidelity (with an image) and topology, overall and per tissue, with names where there are any.
std::string assessment_tables(const Assessment& assessment, TissueRows rows, const LabelTable& names = {});

}  // namespace anatomesh::apps
