// Indices of the objects of CiA 301 and CiA 402 that a torque-controlled drive is set up and run with. The comment of
// an index gives the object's type and unit, and those of its sub-indices where it has any.
#pragma once

#include <cstdint>

namespace breakaway::cia402::object {

// CiA 301

inline constexpr std::uint16_t device_type = 0x1000;         // u32: the device profile's number is in bits 0..15
inline constexpr std::uint16_t error_register = 0x1001;      // u8
inline constexpr std::uint16_t sync_cob_id = 0x1005;         // u32; bit 30 is set in the node that produces SYNC
inline constexpr std::uint16_t sync_period = 0x1006;         // u32, microseconds
inline constexpr std::uint16_t sync_window = 0x1007;         // u32, microseconds
inline constexpr std::uint16_t emcy_cob_id = 0x1014;         // u32
inline constexpr std::uint16_t consumer_heartbeat = 0x1016;  // :01 u32, node id << 16 | milliseconds
inline constexpr std::uint16_t producer_heartbeat = 0x1017;  // u16, milliseconds; 0 produces none
inline constexpr std::uint16_t identity = 0x1018;            // :01 vendor, :02 product, :03 revision, :04 serial number

// :01 COB-ID u32, :02 transmission type u8, :05 deadline u16 in milliseconds
inline constexpr std::uint16_t rpdo1_parameter = 0x1400;
// :00 number of mapped objects u8, :01.. one entry u32 for each
inline constexpr std::uint16_t rpdo1_mapping = 0x1600;
inline constexpr std::uint16_t tpdo1_parameter = 0x1800;  // sub-indices as those of rpdo1_parameter
inline constexpr std::uint16_t tpdo1_mapping = 0x1A00;    // sub-indices as those of rpdo1_mapping

// CiA 402. Torques are per mille of the rated torque.

// i16: 0 nothing, 1 fault, 2 disable voltage, 3 quick stop
inline constexpr std::uint16_t abort_connection_option = 0x6007;
inline constexpr std::uint16_t error_code = 0x603F;             // u16
inline constexpr std::uint16_t controlword = 0x6040;            // u16
inline constexpr std::uint16_t statusword = 0x6041;             // u16
inline constexpr std::uint16_t quick_stop_option = 0x605A;      // i16, default 2
inline constexpr std::uint16_t shutdown_option = 0x605B;        // i16, default 0
inline constexpr std::uint16_t disable_option = 0x605C;         // i16, default 1
inline constexpr std::uint16_t halt_option = 0x605D;            // i16, default 1
inline constexpr std::uint16_t fault_reaction_option = 0x605E;  // i16, default 2
inline constexpr std::uint16_t mode = 0x6060;                   // i8, see Mode
inline constexpr std::uint16_t mode_display = 0x6061;           // i8, see Mode
inline constexpr std::uint16_t position_actual = 0x6064;        // i32, encoder counts
inline constexpr std::uint16_t velocity_actual = 0x606C;        // i32, encoder counts a second
inline constexpr std::uint16_t target_torque = 0x6071;          // i16, per mille
inline constexpr std::uint16_t max_torque = 0x6072;             // u16, per mille
inline constexpr std::uint16_t torque_demand = 0x6074;          // i16, per mille
// :01 i32 lowest, :02 i32 highest; 0 and 0, or the whole range, is none
inline constexpr std::uint16_t position_range = 0x607B;
inline constexpr std::uint16_t home_offset = 0x607C;          // i32: the position of home, in units of position
inline constexpr std::uint16_t homing_method = 0x6098;        // i8
inline constexpr std::uint16_t homing_speeds = 0x6099;        // :01 u32 to the switch, :02 u32 to zero; units a second
inline constexpr std::uint16_t homing_acceleration = 0x609A;  // u32, units a second squared
inline constexpr std::uint16_t polarity = 0x607E;             // u8: bit 7 reverses the position
// :01 u32 encoder counts, :02 u32 motor revolutions
inline constexpr std::uint16_t encoder_resolution = 0x608F;
inline constexpr std::uint16_t gear_ratio = 0x6091;     // :01 u32 motor revolutions, :02 u32 revolutions of the shaft
inline constexpr std::uint16_t feed_constant = 0x6092;  // :01 u32 units of position, :02 u32 revolutions of the shaft
inline constexpr std::uint16_t rated_current = 0x6075;  // u32, mA
inline constexpr std::uint16_t rated_torque = 0x6076;   // u32, mNm
inline constexpr std::uint16_t torque_actual = 0x6077;  // i16, per mille
inline constexpr std::uint16_t torque_offset = 0x60B2;  // i16, per mille
inline constexpr std::uint16_t interpolation_period = 0x60C2;  // :01 u8 x 10^(:02 i8) seconds
inline constexpr std::uint16_t supported_modes = 0x6502;       // u32; bit 9 is cyclic synchronous torque

}  // namespace breakaway::cia402::object

namespace breakaway::cia402 {

// The value 0 of the option codes 605Ah to 605Ch and 605Eh: the motor is without force at once, and runs out.
inline constexpr std::uint16_t disable_drive_function = 0;

inline constexpr std::uint16_t device_profile = 402;              // in the lower half of 1000h
inline constexpr std::uint32_t supports_homing = 1U << 5;         // in 6502h
inline constexpr std::uint32_t supports_cyclic_torque = 1U << 9;  // in 6502h

// The values of 6060h and 6061h: modes of operation.
enum class Mode : std::int8_t {
  none = 0,
  profile_position = 1,
  profile_velocity = 3,
  profile_torque = 4,
  homing = 6,
  cyclic_position = 8,
  cyclic_velocity = 9,
  cyclic_torque = 10,
};

}  // namespace breakaway::cia402
