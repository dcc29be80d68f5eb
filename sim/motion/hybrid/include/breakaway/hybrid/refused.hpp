// Refused: what a method says of a machine that it cannot follow as asked.
#pragma once

#include <string>

#include "breakaway/input/input_error.hpp"

namespace breakaway::hybrid {

// A numerical refusal: one line "cause: remedy". It is an InputError, so that whoever refuses bad input refuses this
// alike; whoever has another method at hand catches it and tries that one.
class Refused : public InputError {
 public:
  Refused(const std::string& cause, const std::string& remedy) : InputError{cause + ": " + remedy} {}
};

// Returns a number as a sentence shows it, in four digits.
std::string shown(double number);

}  // namespace breakaway::hybrid
