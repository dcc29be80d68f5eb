// Command lines in messages, to be copied into a shell.
#pragma once

#include <string>
#include <string_view>

namespace breakaway {

// Returns the text as one word of a POSIX shell: between quotes where it has characters that mean something there.
std::string shell_word(std::string_view text);

}  // namespace breakaway
