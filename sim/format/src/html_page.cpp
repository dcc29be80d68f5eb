#include "breakaway/format/html_page.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "breakaway/input/numbers.hpp"

namespace breakaway::format {
namespace {

constexpr const char* style = R"(
  :root { color-scheme: light; }
  body { margin: 0; background: #f4f5f6; color: #22272b; font: 16px/1.55 system-ui, "Segoe UI", Helvetica, Arial, sans-serif; }
  main { max-width: 960px; margin: 0 auto; padding: 2rem 1.25rem 4rem; }
  h1 { font-size: 1.7rem; line-height: 1.25; margin: 0 0 .4rem; }
  h1, h2, td { overflow-wrap: anywhere; } td span { display: inline-block; max-width: 100%; }
  h2 { font-size: 1.15rem; margin: 0 0 .3rem; }
  .verdict { display: inline-block; padding: .15rem .7rem; border-radius: 1rem; font-weight: 600; }
  .yes { background: #d9efe3; color: #14532d; } .no { background: #fbe0dc; color: #7f1d1d; }
  section { background: #fff; border: 1px solid #e1e4e6; border-radius: 8px; padding: 1.1rem 1.3rem; margin-top: 1.1rem; }
  table { border-collapse: collapse; width: 100%; } th, td { text-align: left; padding: .28rem .5rem; border-bottom: 1px solid #eceeef; }
  th { font-weight: 500; color: #596168; width: 46%; } td { font-variant-numeric: tabular-nums; }
  svg { width: 100%; height: auto; } p { margin: .2rem 0 .6rem; } .caption { color: #4a5258; font-size: .93rem; }
  .columns { display: grid; grid-template-columns: 1fr 1fr; gap: 0 2rem; } @media (max-width: 720px) { .columns { grid-template-columns: 1fr; } }
  .content { overflow-x: auto; } @media (max-width: 720px) { main { padding: 1rem .6rem 3rem; } section { padding: .8rem .8rem; } .content svg { min-width: 600px; } }
  @media print { body { background: #fff; } section { break-inside: avoid; } }
)";

std::string escaped(std::string_view text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '&':
        out += "&amp;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

// Of a name: behind what parts its words.
std::string with_breaks(std::string_view name) {
  std::string out;
  for (const char c : name) {
    out += escaped({&c, 1});
    if (c == '_' || c == '-') out += "<wbr>";
  }
  return out;
}

}  // namespace

void HtmlTable::row(std::string_view name, const std::string& value) { cell(name, escaped(value)); }

void HtmlTable::file(std::string_view name, std::string_view path) {
  std::string parts;
  for (std::size_t from = 0; from < path.size();) {
    const std::size_t to = std::min(path.find('/', from), path.size() - 1) + 1;
    parts += "<span>" + with_breaks(path.substr(from, to - from)) + "</span>";
    from = to;
  }
  cell(name, parts);
}

void HtmlTable::cell(std::string_view name, std::string_view html) {
  text_ += fmt::format("<tr><th>{}</th><td>{}</td></tr>\n", name, html);
}

void HtmlTable::quantity(std::string_view name, double value, std::string_view unit) {
  row(name, std::isfinite(value) ? fmt::format("{:.6g} {}", value, unit) : "–");
}

void HtmlTable::at_most(std::string_view name, double value, std::string_view unit) {
  row(name, std::isfinite(value) ? fmt::format("{} {}", brief_up(value), unit) : "–");
}

void HtmlTable::at_least(std::string_view name, double value, std::string_view unit) {
  quantity(name, value > 0 && std::isfinite(value) ? rounded_down(value, 6) : value, unit);
}

std::string HtmlTable::text() const { return "<table>\n" + text_ + "</table>\n"; }

std::string html_list(const std::vector<std::string>& items) {
  std::string text = "<ol>\n";
  for (const std::string& item : items) text += "<li>" + escaped(item) + "</li>\n";
  return text + "</ol>\n";
}

std::string html_section(std::string_view title, std::string_view content, std::string_view caption) {
  return fmt::format("<section><h2>{}</h2>\n<div class=\"content\">{}</div>\n<p class=\"caption\">{}</p></section>\n",
                     escaped(title), content, escaped(caption));
}

std::string html_page(std::string_view title, bool good, std::string_view verdict, std::string_view sections) {
  return fmt::format(
             "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" "
             "content=\"width=device-width, "
             "initial-scale=1\">\n<title>{0}</title>\n<style>{1}</style>\n</head>\n<body>\n<main>\n"
             "<h1>{0}</h1>\n<p><span class=\"verdict {2}\">{3}</span></p>\n",
             escaped(title), style, good ? "yes" : "no", verdict) +
         std::string{sections} + "</main>\n</body>\n</html>\n";
}

}  // namespace breakaway::format
