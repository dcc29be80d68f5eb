#include <cstddef>

#include "breakaway/config/parse_toml.hpp"

namespace breakaway::config {
namespace {

// Goes through TOML text from one dot of a key to the next, past strings and comments. A dot of a number counts as one
// of a key, which a number has no more of than one.
class KeyDots {
 public:
  explicit KeyDots(std::string_view text) : text_{text} {}

  // The place of the first part of a key that is one too many; npos where none is.
  std::size_t first_beyond(std::size_t most) {
    std::size_t parts = 1;
    while (at_ < text_.size()) {
      const char c = text_[at_];
      if (c == '"' || c == '\'') {
        skip_string(c);
        continue;
      }
      if (c == '#') {
        at_ = text_.find('\n', at_);  // the end of the line ends a key, too
        continue;
      }
      if (c == '.' && ++parts > most) return at_;
      if (ends_key(c)) parts = 1;
      ++at_;
    }
    return std::string_view::npos;
  }

 private:
  static bool ends_key(char c) { return std::string_view{"\n=,[]{}"}.find(c) != std::string_view::npos; }

  bool thrice(char quote) const { return text_.substr(at_).starts_with(std::string(3, quote)); }

  // To behind a string that begins here; to the end of the text where it does not end, which toml++ says.
  void skip_string(char quote) {
    const bool lines = thrice(quote);
    for (at_ += lines ? 3 : 1; at_ < text_.size(); ++at_) {
      const char c = text_[at_];
      if (c == '\\' && quote == '"') {
        ++at_;
      } else if (c == '\n' && !lines) {
        break;
      } else if (c == quote && (!lines || thrice(quote))) {
        at_ += lines ? 3 : 1;
        // One or two quotes may be the last of what stands between the threes.
        for (int last = 0; lines && last < 2 && at_ < text_.size() && text_[at_] == quote; ++last) ++at_;
        return;
      }
    }
    at_ = text_.size();
  }

  std::string_view text_;
  std::size_t at_ = 0;
};

}  // namespace

void refuse_deep_keys(std::string_view text, std::string_view name) {
  const std::size_t at = KeyDots{text}.first_beyond(most_key_parts);
  if (at == std::string_view::npos) return;
  const auto line = 1 + std::ranges::count(text.substr(0, at), '\n');
  throw InputError{
      fmt::format("{}:{}: a key has more than {} parts between dots; no table here is as deep, so leave "
                  "dots out or put the key into quotes",
                  name, line, most_key_parts)};
}

}  // namespace breakaway::config
