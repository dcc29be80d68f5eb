// The frame of a report: one HTML file for browsers without a network.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace breakaway::format {

// Names and values side by side. Values are escaped, names are HTML.
class HtmlTable {
 public:
  void row(std::string_view name, const std::string& value);
  // One too long for its line ends it behind a folder, and within a name only where that alone is too long.
  void file(std::string_view name, std::string_view path);
  void quantity(std::string_view name, double value, std::string_view unit);  // a dash unless finite
  void at_most(std::string_view name, double value, std::string_view unit);   // the same, never below the value
  void at_least(std::string_view name, double value, std::string_view unit);  // nor above it
  std::string text() const;

 private:
  void cell(std::string_view name, std::string_view html);
  std::string text_;
};

// Numbered; the items are escaped.
std::string html_list(const std::vector<std::string>& items);

// `content` is HTML, such as a table or an <svg>; title and caption are escaped.
std::string html_section(std::string_view title, std::string_view content, std::string_view caption);

// `sections` is HTML; the title is escaped.
std::string html_page(std::string_view title, bool good, std::string_view verdict, std::string_view sections);

}  // namespace breakaway::format
