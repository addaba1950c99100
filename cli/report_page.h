#pragma once
// Reports as self-contained HTML pages.

#include <string>
#include <utility>
#include <vector>

namespace promenade {

/// A page with a title (escaped here), a line below it and a body (both HTML). Readable in light and dark.
std::string html_page(const std::string& title, const std::string& subtitle, const std::string& body);

/// A table: its first row is the head when `head` says so. Cells are text, escaped here; all but the first of a row are
/// aligned to the right.
std::string html_table(const std::vector<std::vector<std::string>>& rows, bool head);

}  // namespace promenade
