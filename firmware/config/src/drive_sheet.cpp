#include "breakaway/config/drive_sheet.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "breakaway/canopen/pdo.hpp"
#include "breakaway/cia402/objects.hpp"
#include "breakaway/cia402/pdo_layout.hpp"
#include "breakaway/cia402/setup_plan.hpp"
#include "breakaway/config/flash.hpp"

namespace breakaway::config {
namespace {

namespace object = cia402::object;
using canopen::PdoMapping;

constexpr std::uint32_t profile_402 = 402;

cia402::SetupPlan plan_of(const Node& node, const Axis& axis) {
  const Loop& loop = *node.loop;
  return {drive_config<double>(axis),
          {.period = loop.period,
           .bit_rate = *node.bit_rate,
           .node_id = loop.node_id,
           .heartbeat_period = loop.heartbeat_period}};
}

std::string name_of(std::uint16_t index, std::uint8_t subindex) {
  return subindex == 0 ? fmt::format("{:04X}h", index) : fmt::format("{:04X}h:{:02X}", index, subindex);
}

bool is_of_a_pdo(std::uint16_t index) { return index >= 0x1400 && index < 0x1C00; }

// 16xxh:00 or 1Axxh:00 cannot be written.
bool is_fixed(const DataSheet& sheet, std::uint16_t mapping_index) {
  const SheetEntry* count = sheet.find(mapping_index, 0);
  return count && !count->writable;
}

// What a sheet says against the set-up, judged a piece at a time; the first objection stands.
class Judge {
 public:
  explicit Judge(const DataSheet& sheet) : sheet_{sheet} {}

  std::optional<std::string> said() const { return said_; }

  void profile() {
    if (const auto type = sheet_.value(object::device_type, 0); type && (*type & 0xFFFF) != profile_402)
      object_to(fmt::format("says that it is of the device profile {}, in 1000h: give the sheet of a CiA 402 drive",
                            *type & 0xFFFF));
    const auto modes = sheet_.value(object::supported_modes, 0);
    if (modes && (*modes & cia402::supports_cyclic_torque) == 0)
      object_to("has no cyclic synchronous torque mode, bit 9 of 6502h: take another drive, or firmware that has it");
  }

  void step(const cia402::SetupStep& step) {
    if (step.optional || is_of_a_pdo(step.index)) return;
    const bool written = step.kind == cia402::SetupStep::Kind::write;
    const SheetEntry* entry = needed(step.index, step.subindex, "the drive is not set up without");
    if (!entry) return;
    if (!(written ? entry->writable : entry->readable))
      return object_to(fmt::format("lets {} not be {}, which sets the drive up: correct it, or take another drive",
                                   name_of(step.index, step.subindex), written ? "written" : "read"));
    if (!written) return;
    size(step.index, step.subindex, *entry, step.size);
    const bool is_signed = entry->type >= 2 && entry->type <= 4;
    const int spare = 32 - 8 * step.size;
    const std::int64_t value =
        is_signed ? static_cast<std::int32_t>(step.value << spare) >> spare : std::int64_t{step.value};
    if ((entry->least && value < *entry->least) || (entry->most && value > *entry->most))
      object_to(fmt::format("lets {} not be {}, to which it is set: correct the limits there, or take another drive",
                            name_of(step.index, step.subindex), value));
  }

  void pdo(const PdoMapping& pdo) {
    needed(pdo.parameter_index, 1, "there is no such PDO without");
    type(pdo);
    if (is_fixed(sheet_, pdo.mapping_index)) return fixed(pdo);
    needed(pdo.mapping_index, 0, "there is no such PDO without");
    for (std::uint8_t i = 1; i <= pdo.count; ++i) needed(pdo.mapping_index, i, "too few objects can be mapped without");
    for (const canopen::MappedObject& mapped : pdo.mapped()) {
      const SheetEntry* entry = needed(mapped.index, mapped.subindex, "every period exchanges");
      if (!entry) continue;
      if (!entry->mappable)
        object_to(fmt::format("lets {} not be mapped into a PDO, which every period exchanges: take another drive",
                              name_of(mapped.index, mapped.subindex)));
      size(mapped.index, mapped.subindex, *entry, mapped.bits / 8);
    }
  }

  // What stands in both must be one thing.
  void same(const std::string& key, double told, double sheet, const std::string& where, double share) {
    if (std::abs(told - sheet) <= share * std::abs(sheet)) return;
    object_to(fmt::format("has {:g} for {}, in {}, where the file has {:g}: correct the one or the other", sheet, key,
                          where, told));
  }

  void bit_rate(std::uint32_t bits_per_second) {
    if (!sheet_.has_bit_rate(bits_per_second))
      object_to(fmt::format("does not have {} kbit/s, which [bus] bit_rate asks for: choose one that it has",
                            bits_per_second / 1000));
    if (const auto set = sheet_.bit_rate(); set && *set != bits_per_second)
      object_to(
          fmt::format("has the drive set to {} kbit/s, and [bus] bit_rate is {} kbit/s: change the one or the other",
                      *set / 1000, bits_per_second / 1000));
  }

 private:
  void object_to(std::string what) {
    if (!said_) said_ = std::move(what);
  }

  const SheetEntry* needed(std::uint16_t index, std::uint8_t subindex, const char* why) {
    const SheetEntry* entry = sheet_.find(index, subindex);
    if (!entry)
      object_to(fmt::format("{} {}: {} it; take another drive, or the sheet of its newest firmware",
                            sheet_.only_lists(index) ? "lists and does not describe" : "has no",
                            name_of(index, subindex), why));
    return entry;
  }

  void size(std::uint16_t index, std::uint8_t subindex, const SheetEntry& entry, unsigned bytes) {
    if (entry.bytes() != 0 && entry.bytes() != bytes)
      object_to(fmt::format("has {} bytes for {}, which has {} in the profile: correct its DataType", entry.bytes(),
                            name_of(index, subindex), bytes));
  }

  void type(const PdoMapping& pdo) {
    const SheetEntry* entry = needed(pdo.parameter_index, 2, "a PDO that follows SYNC is not set up without");
    if (entry && !entry->writable && entry->value != pdo.transmission_type)
      object_to(fmt::format("has a fixed {}, whose PDO does not follow every SYNC: take another drive",
                            name_of(pdo.parameter_index, 2)));
  }

  void fixed(const PdoMapping& pdo) {
    const auto objects = pdo.mapped();
    bool fits = sheet_.value(pdo.mapping_index, 0) == objects.size();
    for (std::size_t i = 0; i < objects.size(); ++i)
      fits = fits && sheet_.value(pdo.mapping_index, static_cast<std::uint8_t>(i + 1)) == objects[i].entry();
    if (!fits)
      object_to(
          fmt::format("has a fixed {} that carries something other than what a torque-controlled axis exchanges: take "
                      "another drive",
                      name_of(pdo.mapping_index, 0)));
  }

  const DataSheet& sheet_;
  std::optional<std::string> said_;
};

}  // namespace

std::optional<std::string> what_is_lacking(const Node& node, const Axis& axis) {
  const Drive& drive = *axis.drive;
  const DataSheet& sheet = *drive.data_sheet;
  Judge judge{sheet};
  judge.profile();
  judge.bit_rate(*node.bit_rate);
  const cia402::SetupPlan plan = plan_of(node, axis);
  for (const cia402::SetupStep& step : plan.steps()) judge.step(step);
  judge.pdo(cia402::command_pdo(drive.node_id));
  judge.pdo(cia402::feedback_pdo(drive.node_id));
  // As the drive's own set-up compares it.
  if (const auto rated = sheet.value(object::rated_torque, 0); rated && *rated != 0)
    judge.same("rated_torque_Nm", 1e-3 * drive.rated_torque_mNm, 1e-3 * *rated, "6076h", 0.01);
  if (const auto id = sheet.node_id()) judge.same("node_id", drive.node_id, *id, "[DeviceComissioning]", 0);
  return judge.said();
}

std::vector<std::uint16_t> objects_done_without(const Node& node, const Axis& axis) {
  std::vector<std::uint16_t> missing;
  const cia402::SetupPlan plan = plan_of(node, axis);
  for (const cia402::SetupStep& step : plan.steps()) {
    const bool there = axis.drive->data_sheet->find(step.index, step.subindex) != nullptr;
    if (step.optional && !is_of_a_pdo(step.index) && !there && std::ranges::find(missing, step.index) == missing.end())
      missing.push_back(step.index);
  }
  return missing;
}

bool has_fixed_mapping(const DataSheet& sheet) {
  return is_fixed(sheet, object::rpdo1_mapping) || is_fixed(sheet, object::tpdo1_mapping);
}

}  // namespace breakaway::config
