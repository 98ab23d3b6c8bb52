// Numbers and columns as text.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace anatomesh::apps {

/// "1,234,567".
std::string grouped(std::uint64_t number);

/// With that many decimals; "-" for a value that was not measured (NaN).
std::string fixed(double number, int decimals);

/// "12.3 MB".
std::string byte_size(std::uint64_t bytes);

/// "name      value", the values below one another in all lines of a block.
std::string field(std::string_view name, std::string_view value);

/// Characters of a text in UTF-8.
std::size_t character_count(std::string_view text);

/// The text, or its beginning and "..." where it has more characters than that.
std::string shortened_to(std::size_t most_characters, std::string_view text);

/// The title of columns of names, which are left-aligned.
inline constexpr const char* kNameTitle = "name";

/// Rows of cells below a row of titles, right-aligned columns but for names; every row has as many cells as there are
/// titles.
std::string columns(const std::vector<std::string>& titles, const std::vector<std::vector<std::string>>& rows);

}  // namespace anatomesh::apps
