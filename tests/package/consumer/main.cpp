#include <breakaway/hal/status.hpp>
#include <iostream>

int main() {
  const breakaway::hal::Status status{breakaway::hal::StatusCode::bus_overload, 1250};
  std::cout << breakaway::hal::to_string(status.code) << ": needs a cycle of " << status.detail << " us\n";
  return status.ok() ? 1 : 0;
}
