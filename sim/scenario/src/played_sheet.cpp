#include "played_sheet.hpp"

#include "breakaway/cia402/objects.hpp"
#include "breakaway/config/drive_sheet.hpp"

namespace breakaway::scenario {
namespace {

constexpr std::uint32_t object_does_not_exist = 0x0602'0000;

}  // namespace

void play_sheet(const config::Node& node, const config::Axis& axis, drive_emulator::EmulatorConfig& drive) {
  const config::DataSheet& sheet = *axis.drive->data_sheet;
  if (!sheet.product().empty()) drive.device_name = sheet.product();
  drive.supported_modes = sheet.value(cia402::object::supported_modes, 0).value_or(drive.supported_modes);
  drive_emulator::Quirks& quirks = drive.quirks;
  if (quirks.refused_objects.empty()) quirks.refusal_code = object_does_not_exist;
  for (const std::uint16_t index : config::objects_done_without(node, axis)) quirks.refused_objects.push_back(index);
  // A sheet whose fixed mapping does not fit was refused before.
  if (quirks.fixed_mapping == drive_emulator::FixedMapping::none && config::has_fixed_mapping(sheet))
    quirks.fixed_mapping = drive_emulator::FixedMapping::fits;
}

}  // namespace breakaway::scenario
