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
  struct Name {
    SdoAbort code;
    std::string_view text;
  };
  constexpr Name names[] = {
      {SdoAbort::none, "not aborted"},
      {SdoAbort::toggle_bit, "toggle bit not alternated"},
      {SdoAbort::timeout, "SDO protocol timed out"},
      {SdoAbort::command_specifier, "command specifier not valid or unknown"},
      {SdoAbort::out_of_memory, "out of memory"},
      {SdoAbort::unsupported_access, "unsupported access to the object"},
      {SdoAbort::write_only, "object is write-only"},
      {SdoAbort::read_only, "object is read-only"},
      {SdoAbort::no_such_object, "object does not exist"},
      {SdoAbort::not_mappable, "object cannot be mapped to a PDO"},
      {SdoAbort::mapping_too_long, "mapped objects exceed the PDO's length"},
      {SdoAbort::parameter_incompatible, "parameters are incompatible"},
      {SdoAbort::device_incompatible, "incompatible inside the device"},
      {SdoAbort::hardware_error, "access failed by a hardware error"},
      {SdoAbort::length_mismatch, "data type and length do not match"},
      {SdoAbort::length_too_high, "data too long"},
      {SdoAbort::length_too_low, "data too short"},
      {SdoAbort::no_such_subindex, "sub-index does not exist"},
      {SdoAbort::invalid_value, "value not valid"},
      {SdoAbort::value_too_high, "value too high"},
      {SdoAbort::value_too_low, "value too low"},
      {SdoAbort::general_error, "general error"},
      {SdoAbort::cannot_store, "data cannot be transferred or stored"},
      {SdoAbort::local_control, "refused: the device is under local control"},
      {SdoAbort::device_state, "refused in the device's present state"},
      {SdoAbort::no_data, "no data available"},
  };
  for (const Name& name : names) {
    if (name.code == code) return name.text;
  }
  return "unknown SDO abort code";
}

}  // namespace breakaway::canopen
