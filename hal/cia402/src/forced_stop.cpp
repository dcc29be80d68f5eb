#include "breakaway/cia402/forced_stop.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "breakaway/canopen/bytes.hpp"
#include "breakaway/cia402/objects.hpp"
#include "breakaway/cia402/patience.hpp"
#include "breakaway/cia402/state.hpp"

namespace breakaway::cia402 {
namespace {

// A statusword of zeros, which says "Not ready to switch on", is no proof: so does an answer that was lost in a
// gateway.
bool is_proof(const canopen::SdoClient& sdo) noexcept {
  return sdo.data().size() >= sizeof(std::uint16_t) &&
         shows_no_force(canopen::load_little_endian<std::uint16_t>(sdo.data()));
}

}  // namespace

void ForcedStop::begin(canopen::SdoClient& sdo, hal::Duration patience, hal::Time now) noexcept {
  *this = {};
  since_ = now;
  patience_ = patience;
  sdo.set_timeout(patience_);
}

hal::Duration ForcedStop::time_of(Means means) const noexcept {
  switch (means) {
    case Means::controlword:
      return controlword_time;
    case Means::pre_operational:
      return pre_operational_time;
    case Means::reset:
      break;
  }
  return reset_time_;
}

bool ForcedStop::update(canopen::SdoClient& sdo, hal::Time now) noexcept {
  const canopen::SdoResult result = sdo.poll(now);
  if (result != canopen::SdoResult::busy) {
    const bool done = result == canopen::SdoResult::done;
    const Transfer finished = std::exchange(transfer_, Transfer::none);
    if (finished == Transfer::read_statusword && done && is_proof(sdo)) return true;
    // A drive that refuses the controlword is asked for its state all the same.
    start(sdo, finished == Transfer::write_controlword ? Transfer::read_statusword : Transfer::write_controlword);
  }
  if (now - since_ > time_of(means_)) escalate(sdo, now);
  return false;
}

// Each means has the controlword written at once, also where the answer to the last one is still awaited.
void ForcedStop::escalate(canopen::SdoClient& sdo, hal::Time now) noexcept {
  since_ = now;
  sdo.cancel();
  transfer_ = Transfer::none;
  switch (means_) {
    case Means::controlword:
      means_ = Means::pre_operational;
      command_ = canopen::NmtCommand::enter_pre_operational;
      return;
    case Means::pre_operational:
      means_ = Means::reset;
      command_ = canopen::NmtCommand::reset_node;
      return;
    case Means::reset:
      means_ = Means::controlword;
      patience_ = grown(patience_);
      reset_time_ = std::max<hal::Duration>(reset_time, 3 * patience_);
      sdo.set_timeout(patience_);
      return;
  }
}

void ForcedStop::start(canopen::SdoClient& sdo, Transfer transfer) noexcept {
  constexpr std::array<std::uint8_t, 2> disable_voltage{};
  const canopen::SdoStart started = transfer == Transfer::read_statusword
                                        ? sdo.start_read(object::statusword, 0)
                                        : sdo.start_write(object::controlword, 0, disable_voltage);
  if (started == canopen::SdoStart::started) transfer_ = transfer;
}

std::optional<canopen::NmtCommand> ForcedStop::take_command() noexcept { return std::exchange(command_, std::nullopt); }

}  // namespace breakaway::cia402
