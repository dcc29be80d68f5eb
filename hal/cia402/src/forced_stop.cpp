#include "breakaway/cia402/forced_stop.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <utility>

#include "breakaway/canopen/bytes.hpp"
#include "breakaway/cia402/objects.hpp"
#include "breakaway/cia402/patience.hpp"
#include "breakaway/cia402/state.hpp"

namespace breakaway::cia402 {
namespace {

// A statusword of zeros, which says "Not ready to switch on", is no proof: so does an answer that was lost in a
// gateway.
bool read_no_force(const canopen::SdoClient& sdo) noexcept {
  return sdo.data().size() >= sizeof(std::uint16_t) &&
         shows_no_force(canopen::load_little_endian<std::uint16_t>(sdo.data()));
}

bool read_no_torque(const canopen::SdoClient& sdo) noexcept {
  return sdo.data().size() >= sizeof(std::int16_t) &&
         std::abs(canopen::load_little_endian<std::int16_t>(sdo.data())) <= ForcedStop::most_idle_torque;
}

}  // namespace

void ForcedStop::begin(canopen::SdoClient& sdo, hal::Duration patience, hal::Time now) noexcept {
  *this = {};
  since_ = last_ = now;
  patience_ = patience;
  sdo.set_timeout(patience_);
}

// The time between is not that of the means.
void ForcedStop::resume(canopen::SdoClient& sdo, hal::Time now) noexcept {
  since_ += now - last_;
  last_ = now;
  transfer_ = Transfer::none;
  if (means_ == Means::reset) escalate(sdo, now);
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
  if (sdo.request_waits())
    since_ += now - last_;
  else if (updates_ < least_updates)
    ++updates_;
  last_ = now;
  const canopen::SdoResult result = sdo.poll(now);
  if (result != canopen::SdoResult::busy) {
    const Transfer next = after(sdo, std::exchange(transfer_, Transfer::none), result, now);
    if (next == Transfer::write_controlword && quiet_) return true;
    start(sdo, next);
  }
  // A state without force is on its way to a proof.
  const bool had_time = updates_ == least_updates && now - since_ > time_of(means_);
  if (had_time && transfer_ != Transfer::read_torque) escalate(sdo, now);
  return false;
}

// A drive that has no 6077h to be read is believed for its state, and one that does not know it is asked once.
bool ForcedStop::shows_no_torque(const canopen::SdoClient& sdo, canopen::SdoResult result, hal::Time now) noexcept {
  if (result == canopen::SdoResult::done) return read_no_torque(sdo);
  if (!is_refused(sdo, result, now)) return false;
  if (sdo.abort_code() == canopen::SdoAbort::no_such_object) reads_torque_ = false;
  return true;
}

bool ForcedStop::is_refused(const canopen::SdoClient& sdo, canopen::SdoResult result, hal::Time now) noexcept {
  if (result != canopen::SdoResult::aborted) return false;
  if (!may_pass(sdo.abort_code())) return true;
  if (!refused_since_) refused_since_ = now;
  return now - *refused_since_ > refusal_time;
}

// A drive that refuses the controlword is asked for its state all the same.
ForcedStop::Transfer ForcedStop::after(const canopen::SdoClient& sdo, Transfer finished, canopen::SdoResult result,
                                       hal::Time now) noexcept {
  if (finished == Transfer::write_controlword) return Transfer::read_statusword;
  if (finished == Transfer::read_torque) {
    quiet_ = shows_no_torque(sdo, result, now);
    return Transfer::write_controlword;
  }
  quiet_ = finished == Transfer::read_statusword && result == canopen::SdoResult::done && read_no_force(sdo);
  return quiet_ && reads_torque_ ? Transfer::read_torque : Transfer::write_controlword;
}

// Each means has the controlword written at once, also where the answer to the last one is still awaited.
void ForcedStop::escalate(canopen::SdoClient& sdo, hal::Time now) noexcept {
  since_ = now;
  updates_ = 0;
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
      reset_time_ = std::min<hal::Duration>(2 * reset_time_, longest_reset_time);
      sdo.set_timeout(patience_);
      return;
  }
}

void ForcedStop::start(canopen::SdoClient& sdo, Transfer transfer) noexcept {
  constexpr std::array<std::uint8_t, 2> disable_voltage{};
  const canopen::SdoStart started =
      transfer == Transfer::write_controlword
          ? sdo.start_write(object::controlword, 0, disable_voltage)
          : sdo.start_read(transfer == Transfer::read_torque ? object::torque_actual : object::statusword, 0);
  if (started == canopen::SdoStart::started) transfer_ = transfer;
}

std::optional<canopen::NmtCommand> ForcedStop::take_command() noexcept { return std::exchange(command_, std::nullopt); }

}  // namespace breakaway::cia402
