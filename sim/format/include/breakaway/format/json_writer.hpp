// JsonWriter: JSON text, written from front to back.
#pragma once

#include <fmt/format.h>

#include <cmath>
#include <concepts>
#include <string>
#include <string_view>

namespace breakaway::format {

// Numbers have as many digits as a double needs to survive the way there and back, and no more. JSON knows neither NaN
// nor infinity: both become null. Names and texts must be UTF-8.
class JsonWriter {
 public:
  void value(double number) { put(std::isfinite(number) ? fmt::format("{}", number) : "null"); }
  void value(std::integral auto number) { put(fmt::format("{}", number)); }
  void value(bool truth) { put(truth ? "true" : "false"); }
  void value(std::string_view text) { put(quoted(text)); }
  void value(const char* text) { value(std::string_view{text}); }

  template <class Fill>
  void object(Fill fill) {
    nest('{', '}', fill);
  }
  template <class Fill>
  void array(Fill fill) {
    nest('[', ']', fill);
  }

  // Members of the object that is being filled.
  template <class T>
  void member(std::string_view name, const T& content) {
    put_name(name);
    value(content);
  }
  template <class Fill>
  void object(std::string_view name, Fill fill) {
    put_name(name);
    object(fill);
  }
  template <class Fill>
  void array(std::string_view name, Fill fill) {
    put_name(name);
    array(fill);
  }

  template <class Numbers>
  void numbers(std::string_view name, const Numbers& entries) {
    array(name, [&] {
      for (const double entry : entries) value(entry);
    });
  }

  // The document so far, with a line feed at its end.
  std::string text() const { return text_ + "\n"; }

 private:
  static constexpr int lines_to_depth = 2;  // deeper containers stay on one line: a kick a line

  static std::string quoted(std::string_view text) {
    std::string out = "\"";
    for (const char c : text) {
      if (c == '"' || c == '\\') out += '\\';
      if (static_cast<unsigned char>(c) < 0x20) {
        out += fmt::format("\\u{:04x}", static_cast<int>(c));
      } else {
        out += c;
      }
    }
    return out + "\"";
  }

  void put_name(std::string_view name) {
    put(quoted(name) + ": ");
    first_ = true;
    named_ = true;
  }

  void put(std::string_view content) {
    if (!first_) text_ += depth_ > lines_to_depth ? ", " : ",";
    if (!named_ && depth_ > 0 && depth_ <= lines_to_depth) new_line();
    text_ += content;
    first_ = named_ = false;
  }

  template <class Fill>
  void nest(char open, char close, Fill fill) {
    put(std::string(1, open));
    ++depth_;
    first_ = true;
    fill();
    const bool empty = first_;
    --depth_;
    if (!empty && depth_ < lines_to_depth) new_line();
    text_ += close;
    first_ = false;
  }

  void new_line() {
    text_ += '\n';
    text_.append(2 * static_cast<std::size_t>(depth_), ' ');
  }

  std::string text_;
  int depth_ = 0;
  bool first_ = true;   // no comma before what comes next
  bool named_ = false;  // what comes next belongs to a name on this line
};

}  // namespace breakaway::format
