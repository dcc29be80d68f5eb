#include "breakaway/format/html_page.hpp"

#include <gtest/gtest.h>

#include <string>
#include <utility>

namespace breakaway::format {
namespace {

TEST(HtmlTable, EndsTheLineOfAFileBehindAFolderFirst) {
  HtmlTable table;
  table.file("Read from", "a b/x_1/y-2.toml");
  EXPECT_NE(table.text().find("<td><span>a b/</span><span>x_<wbr>1/</span><span>y-<wbr>2.toml</span></td>"),
            std::string::npos)
      << table.text();
}

TEST(HtmlTable, TakesAnyNameOfAFile) {
  for (const auto& [path, html] : {std::pair{"", "<td></td>"},
                                   {"/", "<td><span>/</span></td>"},
                                   {"-", "<td><span>-<wbr></span></td>"},
                                   {"<a>/", "<td><span>&lt;a&gt;/</span></td>"}}) {
    HtmlTable table;
    table.file("Read from", path);
    EXPECT_NE(table.text().find(html), std::string::npos) << table.text();
  }
}

}  // namespace
}  // namespace breakaway::format
