// Numbers that people give: how they are written in messages, and the rules that nearly all of them keep.
#pragma once

#include <string>
#include <string_view>

namespace breakaway {

// The shortest decimal number that reads back as `value`.
std::string to_text(double value);

// Six digits, which people read.
std::string brief(double value);

// The same, and not less: for what something is said to be at most.
std::string brief_up(double value);

// Return the value to so many significant digits, which is the double that they are read as. What has no more digits
// stays, in spite of roundings. Require a finite value above 0.
double rounded_up(double value, int digits);
double rounded_down(double value, int digits);

// Two numbers that a sentence compares: brief, but with as many more digits as it takes for them to differ, and rounded
// away from each other, so that one who types the other one for either has done enough.
struct ComparedNumbers {
  std::string value, limit;
};
ComparedNumbers compared(double value, double limit);

// Throws InputError unless `value` is a finite number above 0.
void require_positive(std::string_view name, double value);

// Throws InputError unless `value` is a finite number, 0 or above.
void require_not_negative(std::string_view name, double value);

}  // namespace breakaway
