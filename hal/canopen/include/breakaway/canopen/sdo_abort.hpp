// SDO abort codes (CiA 301, 7.2.4.3.17): why a transfer was ended before it was done.
#pragma once

#include <cstdint>
#include <string_view>

namespace breakaway::canopen {

enum class SdoAbort : std::uint32_t {
  none = 0,  // no code of the standard: nothing was aborted
  toggle_bit = 0x0503'0000,
  timeout = 0x0504'0000,
  command_specifier = 0x0504'0001,
  out_of_memory = 0x0504'0005,
  unsupported_access = 0x0601'0000,
  write_only = 0x0601'0001,
  read_only = 0x0601'0002,
  no_such_object = 0x0602'0000,
  not_mappable = 0x0604'0041,
  mapping_too_long = 0x0604'0042,
  parameter_incompatible = 0x0604'0043,
  device_incompatible = 0x0604'0047,
  hardware_error = 0x0606'0000,
  length_mismatch = 0x0607'0010,
  length_too_high = 0x0607'0012,
  length_too_low = 0x0607'0013,
  no_such_subindex = 0x0609'0011,
  invalid_value = 0x0609'0030,
  value_too_high = 0x0609'0031,
  value_too_low = 0x0609'0032,
  general_error = 0x0800'0000,
  cannot_store = 0x0800'0020,
  local_control = 0x0800'0021,
  device_state = 0x0800'0022,
  no_data = 0x0800'0024,
};

constexpr std::string_view to_string(SdoAbort code) noexcept {
  switch (code) {
    case SdoAbort::none:
      return "not aborted";
    case SdoAbort::toggle_bit:
      return "toggle bit not alternated";
    case SdoAbort::timeout:
      return "SDO protocol timed out";
    case SdoAbort::command_specifier:
      return "command specifier not valid or unknown";
    case SdoAbort::out_of_memory:
      return "out of memory";
    case SdoAbort::unsupported_access:
      return "unsupported access to the object";
    case SdoAbort::write_only:
      return "object is write-only";
    case SdoAbort::read_only:
      return "object is read-only";
    case SdoAbort::no_such_object:
      return "object does not exist";
    case SdoAbort::not_mappable:
      return "object cannot be mapped to a PDO";
    case SdoAbort::mapping_too_long:
      return "mapped objects exceed the PDO's length";
    case SdoAbort::parameter_incompatible:
      return "parameters are incompatible";
    case SdoAbort::device_incompatible:
      return "incompatible inside the device";
    case SdoAbort::hardware_error:
      return "access failed by a hardware error";
    case SdoAbort::length_mismatch:
      return "data type and length do not match";
    case SdoAbort::length_too_high:
      return "data too long";
    case SdoAbort::length_too_low:
      return "data too short";
    case SdoAbort::no_such_subindex:
      return "sub-index does not exist";
    case SdoAbort::invalid_value:
      return "value not valid";
    case SdoAbort::value_too_high:
      return "value too high";
    case SdoAbort::value_too_low:
      return "value too low";
    case SdoAbort::general_error:
      return "general error";
    case SdoAbort::cannot_store:
      return "data cannot be transferred or stored";
    case SdoAbort::local_control:
      return "refused: the device is under local control";
    case SdoAbort::device_state:
      return "refused in the device's present state";
    case SdoAbort::no_data:
      return "no data available";
  }
  return "unknown SDO abort code";
}

}  // namespace breakaway::canopen
