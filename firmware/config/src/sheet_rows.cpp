#include "sheet_rows.hpp"

#include <fmt/format.h>

#include <limits>
#include <memory>

#include "breakaway/cia402/objects.hpp"
#include "breakaway/input/input_error.hpp"

namespace breakaway::config {
namespace {

struct StandIn {
  std::string_view key;
  std::uint16_t index;
  std::string_view expects;  // empty: what neither has keeps its usual value
};

template <class Integer>
void take(const Section& section, const Drive& drive, const StandIn& what, Integer& to) {
  if (section.has(what.key)) return;
  const auto value = drive.data_sheet ? drive.data_sheet->value(what.index, 0) : std::nullopt;
  if (value && *value > 0 && *value <= std::numeric_limits<Integer>::max()) {
    to = static_cast<Integer>(*value);
    return;
  }
  if (what.expects.empty()) return;
  const std::string nor =
      drive.data_sheet ? fmt::format(", and {} has no value for it in {:04X}h", drive.data_sheet->name(), what.index)
                       : std::string{};
  section.fail(what.key, fmt::format("is missing{}; give it {}", nor, what.expects));
}

// Whoever reads the message wrote the name of the sheet, and not the sheet.
std::shared_ptr<const DataSheet> read_sheet(const Section& section, const std::string& path) {
  try {
    return std::make_shared<const DataSheet>(DataSheet::read(section.folder() / path));
  } catch (const InputError& error) {
    section.fail("eds", fmt::format("names {}", error.what()));
  }
}

}  // namespace

Key sheet_row(Drive& drive) {
  return optional("eds", {.expects = "the path of the drive's EDS or DCF file, from the folder of this one",
                          .take =
                              [&](const Entry& entry) {
                                const auto path = entry.node.value_exact<std::string>();
                                if (!path || path->empty() || path == "-") return false;
                                drive.data_sheet = read_sheet(entry.parent, *path);
                                return true;
                              },
                          .form = {.type = Form::Type::text, .pattern = "^([^-]|-.)"},
                          .usual = {}});
}

void take_from_sheet(const Section& section, Drive& drive) {
  namespace object = cia402::object;
  take(section, drive, {"rated_torque_Nm", object::rated_torque, "a number in [0.001, 4e+06] N m"},
       drive.rated_torque_mNm);
  take(section, drive, {"max_torque_per_mille", object::max_torque, "an integer in [1, 32767]"},
       drive.max_torque_per_mille);
  take(section, drive, {"rated_current_A", object::rated_current, ""}, drive.rated_current_mA);
  if (drive.data_sheet && drive.data_sheet->node_id() && !section.has("node_id"))
    drive.node_id = *drive.data_sheet->node_id();
}

}  // namespace breakaway::config
