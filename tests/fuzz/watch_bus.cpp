// Whatever is said on the bus, the listener makes finite samples of it, and what the page's commander says is a command
// for an axis of its node whose target is within the limits of the file or where the axis was heard to stand.
#include <fuzzer/FuzzedDataProvider.h>

#include <breakaway/canopen/bytes.hpp>
#include <breakaway/config/read_node.hpp>
#include <breakaway/watch/bus_listener.hpp>
#include <breakaway/watch/commander.hpp>
#include <cmath>

#include "require.hpp"

namespace {

using namespace breakaway;
using fuzz::require;
using hal::CanFrame;
using watch::Action;

CanFrame any_frame(FuzzedDataProvider& input, const config::Node& node) {
  CanFrame frame{.id = 0, .size = 8, .remote = false, .data = {}};
  canopen::store_little_endian(frame.data, input.ConsumeIntegral<std::uint64_t>());
  const auto drive = node.axes[input.ConsumeIntegralInRange<std::size_t>(0, node.axes.size() - 1)].drive->node_id;
  switch (input.ConsumeIntegralInRange(0, 4)) {
    case 0:
      frame.id = canopen::tpdo_cob_id(1, drive);
      break;
    case 1:
      frame.id = canopen::rpdo_cob_id(1, drive);
      break;
    case 2:
      frame.id = canopen::tpdo_cob_id(1, node.loop->node_id);
      break;
    case 3:
      frame.id = canopen::rpdo_cob_id(1, node.loop->node_id);
      break;
    default:
      frame.id = input.ConsumeIntegral<std::uint16_t>();
      frame.size = input.ConsumeIntegral<std::uint8_t>();
      frame.remote = input.ConsumeBool();
  }
  return frame;
}

void check(const CanFrame& frame, const config::Node& node) {
  const auto command = firmware::decode_command(frame, node.loop->node_id);
  require(command && command->axis < node.axes.size() && !command->reference);
  require(!command->reset_fault || !command->enable);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t count) {
  static const config::Node node = config::read_node(BREAKAWAY_SOURCE_DIR "/sim/scenarios/two_axes.toml");
  FuzzedDataProvider input(bytes, count);
  watch::BusListener listener{node};
  watch::Commander commander{node, listener};
  hal::Time now{};
  while (input.remaining_bytes() > 0) {
    now += std::chrono::milliseconds{input.ConsumeIntegralInRange(0, 200)};
    if (const auto sample = listener.on_frame({any_frame(input, node), now}))
      require(std::isfinite(sample->position_m));
    if (input.ConsumeBool()) {
      const watch::Command command{
          .axis = input.ConsumeIntegralInRange<std::size_t>(0, 3),
          .action = input.PickValueInArray({Action::enable, Action::stop, Action::target, Action::reset}),
          .target_m = input.ConsumeFloatingPoint<double>()};
      const std::string why_not = commander.obey(command, now);
      require(why_not.empty() || command.axis >= node.axes.size() || why_not.find('\n') == std::string::npos);
    }
    for (const CanFrame& frame : commander.due(now)) check(frame, node);
  }
  for (const CanFrame& frame : commander.farewell()) {
    check(frame, node);
    require(!firmware::decode_command(frame, node.loop->node_id)->enable);
  }
  return 0;
}
