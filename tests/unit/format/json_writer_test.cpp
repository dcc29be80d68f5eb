#include "breakaway/format/json_writer.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <limits>

namespace {

using breakaway::format::JsonWriter;

std::string without_space(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c != ' ' && c != '\n') out += c;
  }
  return out;
}

TEST(JsonWriter, NestsObjectsAndArrays) {
  JsonWriter json;
  json.object([&] {
    json.member("a", 1);
    json.array("rows", [&] {
      json.object([&] { json.member("x", 0.5); });
      json.object([&] {
        json.member("x", true);
        json.array("none", [] {});
      });
    });
    json.member("b", "text");
  });
  EXPECT_EQ(without_space(json.text()), R"({"a":1,"rows":[{"x":0.5},{"x":true,"none":[]}],"b":"text"})");
}

TEST(JsonWriter, KeepsEveryBitOfADouble) {
  for (const double number : {0.1, 1.0 / 3, 5e-324, 1.7976931348623157e308, -2.2250738585072014e-308}) {
    JsonWriter json;
    json.value(number);
    EXPECT_EQ(std::strtod(json.text().c_str(), nullptr), number);
  }
}

TEST(JsonWriter, WritesNullForWhatJsonCannotSay) {
  JsonWriter json;
  json.array([&] {
    json.value(std::numeric_limits<double>::quiet_NaN());
    json.value(-std::numeric_limits<double>::infinity());
  });
  EXPECT_EQ(without_space(json.text()), "[null,null]");
}

TEST(JsonWriter, EscapesQuotesBackslashesAndControlCharacters) {
  JsonWriter json;
  json.value("a\"b\\c\nd");
  EXPECT_EQ(json.text(), "\"a\\\"b\\\\c\\u000ad\"\n");
}

}  // namespace
