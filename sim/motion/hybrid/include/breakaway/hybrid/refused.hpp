// Refused: what a method says of a machine that it cannot follow as asked.
#pragma once

#include <string>

#include "breakaway/input/input_error.hpp"

namespace breakaway::hybrid {

// A numerical refusal: one line "cause: remedy". It is an InputError, so that whoever refuses bad input refuses this
// alike; whoever has another method at hand catches it and tries that one.
class Refused : public InputError {
 public:
  // `another_method`, if any, is the remedy for whoever may choose the method: the end of a sentence "remedy, or ...".
  Refused(const std::string& cause, const std::string& remedy, const std::string& another_method = {})
      : InputError{cause + ": " + remedy + (another_method.empty() ? "" : ", or " + another_method)},
        cause_{cause},
        remedy_{remedy} {}

  const std::string& cause() const noexcept { return cause_; }
  // Returns it for where the method cannot be chosen.
  Refused without_another_method() const { return {cause_, remedy_}; }

 private:
  std::string cause_, remedy_;
};

// It would cost more work than its budget has.
class RefusedForWork : public Refused {
 public:
  using Refused::Refused;
};

// Returns a number as a sentence shows it, in four digits.
std::string shown(double number);

}  // namespace breakaway::hybrid
