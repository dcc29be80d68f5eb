// Status: what a call that can fail returns. Errors are values: nothing that is flashed throws.
#pragma once

#include <cstdint>
#include <string_view>

namespace breakaway::hal {

enum class StatusCode : std::uint8_t {
  ok,
  queue_full,        // try again in the next period; nothing was sent
  would_block,       // no result yet; ask again in the next period
  bus_off,           // the controller left the bus; frames that were queued are gone
  timeout,           // the peer did not answer in time
  sdo_aborted,       // detail: the SDO abort code of CiA 301
  protocol_error,    // the peer answered something that the standard forbids here; detail: what came
  not_supported,     // the device lacks what is needed; detail: object index << 8 | sub-index
  invalid_argument,  // a parameter is outside its stated range; detail: says which, where the call documents it
  bus_overload,      // the configuration does not fit the bus; detail: the cycle that it needs, in microseconds
};

struct [[nodiscard]] Status {
  StatusCode code = StatusCode::ok;
  std::uint32_t detail = 0;

  constexpr bool ok() const noexcept { return code == StatusCode::ok; }
  friend constexpr bool operator==(Status, Status) = default;
};

constexpr std::string_view to_string(StatusCode code) noexcept {
  switch (code) {
    case StatusCode::ok:
      return "ok";
    case StatusCode::queue_full:
      return "queue full";
    case StatusCode::would_block:
      return "would block";
    case StatusCode::bus_off:
      return "bus off";
    case StatusCode::timeout:
      return "timeout";
    case StatusCode::sdo_aborted:
      return "SDO aborted";
    case StatusCode::protocol_error:
      return "protocol error";
    case StatusCode::not_supported:
      return "not supported";
    case StatusCode::invalid_argument:
      return "invalid argument";
    case StatusCode::bus_overload:
      return "bus overload";
  }
  return "unknown status";
}

}  // namespace breakaway::hal
