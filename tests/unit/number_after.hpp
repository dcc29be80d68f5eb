// Numbers that a sentence tells its reader to write.
#pragma once

#include <gtest/gtest.h>

#include <string>

namespace breakaway::testing {

// The word behind these words, as it stands; empty where they are not in the sentence, which fails the test.
inline std::string word_after(const std::string& sentence, const std::string& words) {
  const auto place = sentence.find(words);
  if (place == std::string::npos) ADD_FAILURE() << words << " in: " << sentence;
  if (place == std::string::npos) return {};
  const auto from = place + words.size();
  return sentence.substr(from, sentence.find_first_of(" ;,", from) - from);
}

inline double number_after(const std::string& sentence, const std::string& words) {
  const std::string word = word_after(sentence, words);
  return word.empty() ? 0 : std::stod(word);
}

}  // namespace breakaway::testing
