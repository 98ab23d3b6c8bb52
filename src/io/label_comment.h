// Comments that keep what a solver's format has no place for: "label 17 is White_matter: White matter".
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "anatomesh/tet_mesh.h"

namespace anatomesh {

struct LabelComment {
  Label label = 0;
  std::string set;   ///< name of the label's set in the file
  std::string name;  ///< in full; empty: not known
};

/// One for each set, by ascending label; see set_names(). Names are put into one line.
std::vector<LabelComment> label_comments(const TetMesh& mesh, const std::map<Label, std::string>& sets);

std::string text_of(const LabelComment& comment);

/// Nothing where the text, which may have white space at its ends, is another comment.
std::optional<LabelComment> label_comment_in(std::string_view text);

/// Adds the name, if it is known, to the table.
void add_name(const LabelComment& comment, LabelTable& names);

}  // namespace anatomesh
