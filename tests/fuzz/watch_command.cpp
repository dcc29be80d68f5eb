// The body of a request to the page's server is a command or none; the target of one is a finite number.
#include <breakaway/watch/command.hpp>
#include <cmath>

#include "require.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t count) {
  using breakaway::watch::Action;
  const auto command = breakaway::watch::read_command({reinterpret_cast<const char*>(bytes), count});
  if (command) breakaway::fuzz::require(command->action <= Action::reset && std::isfinite(command->target_m));
  return 0;
}
