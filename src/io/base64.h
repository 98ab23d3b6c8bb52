// Bytes as text: base64, as RFC 4648 has it.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace anatomesh {

/// The bytes; nothing where the text is no base64. White space is passed over. Padding ends a piece, and another one
/// may follow: VTK encodes what tells sizes and what it is about one after the other.
std::optional<std::string> base64_decoded(std::string_view text);

}  // namespace anatomesh
