// Numbers that people give: how they are written in messages, and the rules that nearly all of them keep.
#pragma once

#include <string>
#include <string_view>

namespace breakaway {

// The shortest decimal number that reads back as `value`.
std::string to_text(double value);

// Six digits, which people read.
std::string brief(double value);

// Two numbers that a sentence compares: brief, but with as many more digits as it takes for them to differ.
struct ComparedNumbers {
  std::string value, limit;
};
ComparedNumbers compared(double value, double limit);

// Throws InputError unless `value` is a finite number above 0.
void require_positive(std::string_view name, double value);

// Throws InputError unless `value` is a finite number, 0 or above.
void require_not_negative(std::string_view name, double value);

}  // namespace breakaway
