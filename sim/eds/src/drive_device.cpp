// The device of an emulated drive, from the emulator's own dictionary.
#include "breakaway/drive_emulator/drive_emulator.hpp"
#include "breakaway/drive_emulator/objects.hpp"
#include "breakaway/eds/device.hpp"
#include "values.hpp"

namespace breakaway::eds {
namespace {

using drive_emulator::Entry;
using drive_emulator::Mapping;
using drive_emulator::ObjectDictionary;
using drive_emulator::Type;
namespace object = cia402::object;
namespace own_object = drive_emulator::own_object;

constexpr std::uint8_t first_id = 1, second_id = 2;

// Nothing hangs on the motor of a drive that is only asked for its objects.
class NoMechanism final : public drive_emulator::Mechanism {
 public:
  void advance_to(double, const model::AppliedForce&) override {}
  double position_m() const override { return 0; }
};

// A drive that was just powered on.
struct AskedDrive {
  AskedDrive(drive_emulator::EmulatorConfig config, std::uint8_t node_id)
      : drive{(config.node_id = node_id, config), mechanism, [](const hal::CanFrame&, hal::Time) {}} {}
  NoMechanism mechanism;
  drive_emulator::DriveEmulator drive;
};

struct TypeFacts {
  DataType type;
  std::int64_t lowest, highest;
};

TypeFacts facts_of(Type type) {
  const auto bits = 8 * drive_emulator::size_bytes(type);
  const std::int64_t span = std::int64_t{1} << bits;
  switch (type) {
    case Type::i8:
      return {DataType::i8, -span / 2, span / 2 - 1};
    case Type::i16:
      return {DataType::i16, -span / 2, span / 2 - 1};
    case Type::i32:
      return {DataType::i32, -span / 2, span / 2 - 1};
    case Type::u8:
      return {DataType::u8, 0, span - 1};
    case Type::u16:
      return {DataType::u16, 0, span - 1};
    case Type::u32:
      return {DataType::u32, 0, span - 1};
    case Type::text:
      break;
  }
  return {DataType::text, 0, 0};
}

Access access_of(const Entry& entry) {
  switch (entry.access) {
    case drive_emulator::Access::write_only:
      return Access::write_only;
    case drive_emulator::Access::read_write:
      return Access::read_write;
    case drive_emulator::Access::read_only:
      break;
  }
  return Access::read_only;
}

std::optional<std::string> power_on_value(const Entry& entry, const Entry& under_second_id) {
  const bool measured = entry.access == drive_emulator::Access::read_only && entry.mapping == Mapping::transmit;
  if (measured) return std::nullopt;
  if (entry.type == Type::text) return entry.text;
  const bool is_signed = facts_of(entry.type).lowest < 0;
  const auto digits = is_signed ? 0 : static_cast<int>(2 * drive_emulator::size_bytes(entry.type));
  return value_text({entry.value, under_second_id.value, first_id, second_id, digits});
}

Object described(drive_emulator::Address address, const Entry& entry, const Entry& under_second_id) {
  const TypeFacts facts = facts_of(entry.type);
  Object object{.index = address.index, .sub = address.sub, .type = facts.type, .access = access_of(entry)};
  object.mappable_to_rpdo = entry.mapping == Mapping::receive || entry.mapping == Mapping::both;
  object.mappable_to_tpdo = entry.mapping == Mapping::transmit || entry.mapping == Mapping::both;
  if (entry.type != Type::text && entry.low > facts.lowest) object.low = entry.low;
  if (entry.type != Type::text && entry.high < facts.highest) object.high = entry.high;
  object.power_on_value = power_on_value(entry, under_second_id);
  return object;
}

std::uint32_t identity(const ObjectDictionary& objects, std::uint8_t sub) {
  return static_cast<std::uint32_t>(objects.get({object::identity, sub}));
}

}  // namespace

Device drive_device(const drive_emulator::EmulatorConfig& config) {
  const AskedDrive asked{config, first_id}, again{config, second_id};
  const ObjectDictionary& objects = asked.drive.objects();
  Device device{.name = objects.find({own_object::device_name, 0})->text,
                .description = "CiA 402 drive in cyclic synchronous torque mode, emulated",
                .vendor = identity(objects, 1),
                .product = identity(objects, 2),
                .revision = identity(objects, 3),
                .rpdos = drive_emulator::DriveEmulator::pdo_count,
                .tpdos = drive_emulator::DriveEmulator::pdo_count,
                .bit_rates_kHz = {std::begin(bit_rates_kHz), std::end(bit_rates_kHz)},
                .comments = {},
                .objects = {}};
  for (const auto& [address, entry] : objects.entries())
    device.objects.push_back(described(address, entry, *again.drive.objects().find(address)));
  return device;
}

}  // namespace breakaway::eds
