// Label tables: names and colours of labels, as programs of the field write them.
#pragma once

#include <filesystem>

#include "anatomesh/label_table.h"
#include "io/text_cursor.h"

namespace anatomesh {

/// As read_label_table(), of a text that is there already. Throws InvalidInput.
LabelTable label_table_from(TextCursor text);

}  // namespace anatomesh
