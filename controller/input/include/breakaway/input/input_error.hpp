// InputError: the one exception of all code that runs on a PC. What a person gave cannot be used, and its text is one
// line that names the place and the remedy.
#pragma once

#include <algorithm>
#include <stdexcept>
#include <string>
#include <utility>

namespace breakaway {

class InputError : public std::runtime_error {
 public:
  // `problem`: what is wrong and what to do about it. Control characters become spaces: a parser's message or a quoted
  // key may hold line breaks.
  explicit InputError(std::string problem) : InputError{{}, std::move(problem)} {}

  // `key`: the number or key that is concerned, with which the text begins.
  InputError(std::string key, std::string problem)
      : std::runtime_error{one_line(key.empty() ? problem : key + " " + problem)},
        key_{one_line(std::move(key))},
        problem_{one_line(std::move(problem))} {}

  // Returns the same error with the file that it was found in.
  InputError in_file(const std::string& file) const {
    InputError error{file.empty() ? what() : file + ": " + what()};
    error.file_ = file;
    error.key_ = key_;
    error.problem_ = problem_;
    return error;
  }

  const std::string& file() const noexcept { return file_; }  // empty: no file is concerned, or its reader adds it
  const std::string& key() const noexcept { return key_; }    // empty: no single one
  const std::string& problem() const noexcept { return problem_; }  // the text without file and key

 private:
  static std::string one_line(std::string text) {
    constexpr auto control = [](char c) {
      const auto byte = static_cast<unsigned char>(c);
      return byte < 0x20 || byte == 0x7F;
    };
    std::ranges::replace_if(text, control, ' ');
    return text;
  }

  std::string file_, key_, problem_;
};

}  // namespace breakaway
