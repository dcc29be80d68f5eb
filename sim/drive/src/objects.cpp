#include "breakaway/drive_emulator/objects.hpp"

#include "breakaway/canopen/cob_id.hpp"
#include "breakaway/drive_emulator/home_seeker.hpp"

namespace breakaway::drive_emulator {

using canopen::SdoAbort;
namespace object = cia402::object;

namespace {

constexpr auto rw = Access::read_write;
constexpr std::uint32_t servo_drive_profile = 0x00020192;  // CiA 402 (192h), servo drive (bit 17)
constexpr std::uint8_t history_depth = 8;

void set_communication_rules(ObjectDictionary& dictionary) {
  dictionary.set_rule(own_object::error_history, [](Address, std::int64_t value) -> std::optional<SdoAbort> {
    if (value != 0) return SdoAbort::invalid_value;  // 0 empties the history; nothing else makes sense
    return std::nullopt;
  });
  const auto eleven_bits = [](Address, std::int64_t value) -> std::optional<SdoAbort> {
    const auto cob_id = static_cast<std::uint32_t>(value) & ~canopen::cob_id_invalid;
    if (cob_id == 0 || cob_id > 0x7FF) return SdoAbort::invalid_value;  // also refuses bit 30, being SYNC producer
    return std::nullopt;
  };
  dictionary.set_rule(object::sync_cob_id, eleven_bits);
  dictionary.set_rule(object::emcy_cob_id, eleven_bits);
}

// These are the ranges of 605Ah to 605Eh. In torque mode every stop is the same: the torque demand goes to zero at
// once.
void add_option_codes(ObjectDictionary& dictionary) {
  dictionary.add({object::quick_stop_option, 0}, {.type = Type::i16, .access = rw, .value = 2, .low = 0, .high = 8});
  dictionary.add({object::shutdown_option, 0}, {.type = Type::i16, .access = rw, .value = 0, .low = 0, .high = 1});
  dictionary.add({object::disable_option, 0}, {.type = Type::i16, .access = rw, .value = 1, .low = 0, .high = 1});
  dictionary.add({object::halt_option, 0}, {.type = Type::i16, .access = rw, .value = 1, .low = 1, .high = 4});
  dictionary.add({object::fault_reaction_option, 0},
                 {.type = Type::i16, .access = rw, .value = 2, .low = 0, .high = 4});
}

// A gear of 1 : 1, and a unit of position that is one count of the encoder unless the quirk says otherwise.
void add_factor_group(ObjectDictionary& dictionary, std::uint32_t feed_constant) {
  const auto add = [&](std::uint16_t index, std::uint32_t numerator) {
    dictionary.add({index, 0}, {.type = Type::u8, .value = 2});
    dictionary.add({index, 1}, {.type = Type::u32, .access = rw, .value = numerator, .low = 1});
    dictionary.add({index, 2}, {.type = Type::u32, .access = rw, .value = 1, .low = 1});
  };
  add(object::encoder_resolution, encoder_counts_per_revolution);
  add(object::gear_ratio, 1);
  add(object::feed_constant, feed_constant == 0 ? encoder_counts_per_revolution : feed_constant);
}

// At methods 35 and 37 the axis stands at home: the others need switches.
void add_homing_objects(ObjectDictionary& dictionary, bool has_switches) {
  dictionary.add({object::home_offset, 0}, {.type = Type::i32, .access = rw});
  dictionary.add({object::homing_method, 0}, {.type = Type::i8, .access = rw, .value = 37});
  dictionary.add({object::homing_speeds, 0}, {.type = Type::u8, .value = 2});
  dictionary.add({object::homing_speeds, 1}, {.type = Type::u32, .access = rw, .value = 10'000});
  dictionary.add({object::homing_speeds, 2}, {.type = Type::u32, .access = rw, .value = 1'000});
  dictionary.add({object::homing_acceleration, 0}, {.type = Type::u32, .access = rw, .value = 100'000});
  dictionary.set_rule(object::homing_method, [has_switches](Address, std::int64_t method) -> std::optional<SdoAbort> {
    if (method == 35 || method == 37 || (has_switches && HomeSeeker::knows(method))) return std::nullopt;
    return SdoAbort::invalid_value;
  });
}

void add_torque_objects(ObjectDictionary& dictionary, const EmulatorConfig& config) {
  dictionary.add({object::target_torque, 0}, {.type = Type::i16, .access = rw, .mapping = Mapping::both});
  dictionary.add({object::max_torque, 0},
                 {.type = Type::u16, .access = rw, .value = config.max_torque_per_mille, .mapping = Mapping::both});
  dictionary.add({object::torque_demand, 0}, {.type = Type::i16, .mapping = Mapping::transmit});
  dictionary.add({object::rated_current, 0}, {.type = Type::u32, .value = config.rated_current_mA});
  dictionary.add({object::rated_torque, 0}, {.type = Type::u32, .value = config.rated_torque_mNm});
  dictionary.add({object::torque_actual, 0}, {.type = Type::i16, .mapping = Mapping::transmit});
  dictionary.add({object::torque_offset, 0}, {.type = Type::i16, .access = rw, .mapping = Mapping::both});
}

void add_mode_objects(ObjectDictionary& dictionary, const EmulatorConfig& config) {
  dictionary.add({object::mode, 0}, {.type = Type::i8, .access = rw, .mapping = Mapping::both});
  dictionary.add({object::mode_display, 0}, {.type = Type::i8, .mapping = Mapping::transmit});
  dictionary.add({object::supported_modes, 0}, {.type = Type::u32, .value = config.supported_modes});
  dictionary.set_rule(object::mode, [&dictionary](Address, std::int64_t mode) -> std::optional<SdoAbort> {
    if (mode == 0) return std::nullopt;
    const std::int64_t supported = dictionary.get({object::supported_modes, 0});
    if (mode < 0 || mode > 32 || (supported >> (mode - 1) & 1) == 0) return SdoAbort::invalid_value;
    return std::nullopt;
  });
  const bool ms_only = config.quirks.interpolation_in_ms_only;
  dictionary.add({object::interpolation_period, 0}, {.type = Type::u8, .value = 2});
  dictionary.add({object::interpolation_period, 1}, {.type = Type::u8, .access = rw, .value = 1});
  dictionary.add({object::interpolation_period, 2},
                 {.type = Type::i8, .access = rw, .value = -3, .low = ms_only ? -3 : -128, .high = ms_only ? -3 : 63});
}

}  // namespace

void add_communication_objects(ObjectDictionary& dictionary, const EmulatorConfig& config) {
  const std::uint8_t node = config.node_id;
  dictionary.add({object::device_type, 0}, {.type = Type::u32, .value = servo_drive_profile});
  dictionary.add({object::error_register, 0}, {.type = Type::u8, .mapping = Mapping::transmit});
  dictionary.add({own_object::error_history, 0}, {.type = Type::u8, .access = rw});
  for (std::uint8_t sub = 1; sub <= history_depth; ++sub)
    dictionary.add({own_object::error_history, sub}, {.type = Type::u32});
  dictionary.add({object::sync_cob_id, 0}, {.type = Type::u32, .access = rw, .value = canopen::sync_cob_id});
  dictionary.add({object::sync_period, 0}, {.type = Type::u32, .access = rw});
  dictionary.add({object::sync_window, 0}, {.type = Type::u32, .access = rw});
  dictionary.add({own_object::device_name, 0}, {.type = Type::text, .text = config.device_name});
  dictionary.add({object::emcy_cob_id, 0}, {.type = Type::u32, .access = rw, .value = canopen::emcy_cob_id(node)});
  dictionary.add({object::consumer_heartbeat, 0}, {.type = Type::u8, .value = 1});
  dictionary.add({object::consumer_heartbeat, 1}, {.type = Type::u32, .access = rw, .high = 0x7F'FFFF});
  dictionary.add({object::producer_heartbeat, 0},
                 {.type = Type::u16, .access = rw, .value = config.producer_heartbeat_ms});
  dictionary.add({object::identity, 0}, {.type = Type::u8, .value = 4});
  for (std::uint8_t sub = 1; sub <= 4; ++sub) dictionary.add({object::identity, sub}, {.type = Type::u32});
  dictionary.add({own_object::error_behaviour, 0}, {.type = Type::u8, .value = 1});
  dictionary.add({own_object::error_behaviour, 1},
                 {.type = Type::u8, .access = rw, .value = config.error_behaviour, .low = 0, .high = 2});
  dictionary.add({own_object::sdo_server_parameter, 0}, {.type = Type::u8, .value = 2});
  dictionary.add({own_object::sdo_server_parameter, 1},
                 {.type = Type::u32, .value = canopen::sdo_request_cob_id(node)});
  dictionary.add({own_object::sdo_server_parameter, 2},
                 {.type = Type::u32, .value = canopen::sdo_response_cob_id(node)});
  set_communication_rules(dictionary);
}

void add_drive_objects(ObjectDictionary& dictionary, const EmulatorConfig& config) {
  dictionary.add({object::error_code, 0}, {.type = Type::u16, .mapping = Mapping::transmit});
  dictionary.add({object::controlword, 0}, {.type = Type::u16, .access = rw, .mapping = Mapping::both});
  dictionary.add({object::statusword, 0}, {.type = Type::u16, .mapping = Mapping::transmit});
  dictionary.add({object::position_actual, 0}, {.type = Type::i32, .mapping = Mapping::transmit});
  dictionary.add({object::velocity_actual, 0}, {.type = Type::i32, .mapping = Mapping::transmit});
  dictionary.add({object::polarity, 0},
                 {.type = Type::u8, .access = rw, .value = config.quirks.position_reversed ? 0x80 : 0});
  const std::uint32_t range = config.quirks.position_range_counts;
  dictionary.add({object::position_range, 0}, {.type = Type::u8, .value = 2});
  dictionary.add({object::position_range, 1}, {.type = Type::i32, .access = rw});
  dictionary.add({object::position_range, 2}, {.type = Type::i32, .access = rw, .value = range == 0 ? 0 : range - 1});
  add_factor_group(dictionary, config.quirks.feed_constant);
  add_homing_objects(dictionary, config.quirks.switches.has_value());
  dictionary.add({own_object::motor_catalogue_number, 0}, {.type = Type::text, .access = rw});
  add_option_codes(dictionary);
  add_torque_objects(dictionary, config);
  add_mode_objects(dictionary, config);
}

}  // namespace breakaway::drive_emulator
