// InputError: what the user gave cannot be used. Its text is one line that names the place and the remedy.
#pragma once

#include <stdexcept>

namespace breakaway::scenario {

class InputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace breakaway::scenario
