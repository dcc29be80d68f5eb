// What is said of input that is refused.
#pragma once

#include <string>

#include "breakaway/input/input_error.hpp"

namespace breakaway::testing {

// The text of the InputError that `action` throws; empty when it throws none.
template <class Action>
std::string refusal(Action&& action) {
  try {
    action();
  } catch (const InputError& error) {
    return error.what();
  }
  return {};
}

}  // namespace breakaway::testing
