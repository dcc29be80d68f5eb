// Holds the sentences of an enum against what their reader needs: the field that is wrong, and what to do about it.
#pragma once

#include <gtest/gtest.h>

#include <initializer_list>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "breakaway/hal/motor_drive.hpp"

namespace breakaway::test {

template <hal::ExplainedEnum E>
struct Sentence {
  E value;
  std::vector<std::string> words;  // that it must hold: the field, and from the remedy
};

// There must be a row for every value, in the order of their declaration.
template <hal::ExplainedEnum E>
void expect_sentences(std::initializer_list<Sentence<E>> rows) {
  std::set<std::string_view> texts;
  int number = 0;
  for (const Sentence<E>& row : rows) {
    const std::string_view text = to_string(row.value);
    EXPECT_EQ(static_cast<int>(row.value), number++) << text;
    EXPECT_TRUE(texts.insert(text).second) << "twice: " << text;
    EXPECT_FALSE(text.starts_with("unknown")) << number;
    EXPECT_EQ(text.find_first_of("{}%\n"), text.npos) << "has holes: " << text;
    EXPECT_FALSE(text.empty() || text.ends_with('.')) << "to be embedded in a line: " << text;
    for (const std::string& word : row.words) EXPECT_NE(text.find(word), text.npos) << word << " is not in: " << text;
  }
  EXPECT_TRUE(to_string(static_cast<E>(number)).starts_with("unknown")) << "a value has no row here";
}

}  // namespace breakaway::test
