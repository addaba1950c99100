#include "cli/report_page.h"

#include <fmt/format.h>

#include "cli/plot.h"

namespace promenade {
namespace {

constexpr const char* kStyle = R"(<style>
:root { color-scheme: light dark; --ink: #1d2430; --paper: #fbfaf7; --faint: #d9d6cf; --bound: #b3261e; }
@media (prefers-color-scheme: dark) { :root { --ink: #e8e6e1; --paper: #171a1f; --faint: #3a3f47; --bound: #ff8a80; } }
body { font: 15px/1.5 system-ui, sans-serif; color: var(--ink); background: var(--paper); max-width: 900px; margin: 2rem auto; padding: 0 1rem; }
h1 { font-size: 1.5rem; margin-bottom: 0; } p { margin-top: .2rem; }
table { border-collapse: collapse; } th { text-align: left; font-weight: normal; padding-right: 2rem; } td { text-align: right; white-space: nowrap; font-variant-numeric: tabular-nums; }
tr { border-bottom: 1px solid var(--faint); }
.pictures { display: grid; grid-template-columns: repeat(auto-fill, minmax(270px, 1fr)); gap: .6rem; margin: 1.2rem 0; }
figure { margin: 0; } img { width: 100%; border-radius: 4px; } figcaption { font-size: 12px; }
svg.plot { display: block; width: 100%; height: auto; margin: 1.2rem 0; font-size: 12px; }
svg text { fill: var(--ink); } svg .title { font-weight: 600; font-size: 13px; } svg .grid { stroke: var(--faint); } svg .bar { fill: #0072b2; } svg .bound { stroke: var(--bound); stroke-dasharray: 5 4; }
</style>
)";

}  // namespace

std::string html_page(const std::string& title, const std::string& subtitle, const std::string& body) {
  return fmt::format(
      "<!doctype html>\n<html lang=en><meta charset=utf-8><meta name=viewport content=\"width=device-width\">\n"
      "<title>{0}</title>\n{1}<h1>{0}</h1>\n<p>{2}</p>\n{3}</html>\n",
      escaped(title), kStyle, subtitle, body);
}

std::string html_table(const std::vector<std::vector<std::string>>& rows, bool head) {
  std::string html = "<table>\n";
  for (size_t i = 0; i < rows.size(); ++i) {
    html += "<tr>";
    for (size_t k = 0; k < rows[i].size(); ++k) {
      const char* tag = k == 0 || (head && i == 0) ? "th" : "td";
      html += fmt::format("<{0}>{1}</{0}>", tag, escaped(rows[i][k]));
    }
    html += "</tr>\n";
  }
  return html + "</table>\n";
}

}  // namespace promenade
